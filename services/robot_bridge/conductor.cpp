#include "services/robot_bridge/conductor.h"

#include "services/robot_bridge/speech_text.h"

namespace coach {
namespace {

int64_t Microseconds(double seconds) { return static_cast<int64_t>(seconds * 1e6); }

}  // namespace

Conductor::Conductor(const ConductorOptions& options, BackEnd& back_end)
    : options_(options), back_end_(back_end), queue_(options.queue), body_(options.gesture, options.X_TR, back_end) {}

void Conductor::Offer(const RobotCommand& command, int64_t now) {
  if (retiring_) return;
  queue_.Offer(command, now);
  if (command.kind == ActKind::kStop && (queue_.running() == nullptr || queue_.interrupt() == "stopped")) {
    HaltNow("stopped", now);
  } else if (!queue_.interrupt().empty()) {
    back_end_.Silence();
    End(ActState::kInterrupted, queue_.interrupt(), now);
  }
}

void Conductor::Stop(int64_t now) {
  queue_.WithdrawAll("stopped by the operator");
  HaltNow("stopped by the operator", now);
}

void Conductor::HaltNow(const std::string& reason, int64_t now) {
  back_end_.Silence();
  body_.Freeze(now);
  body_.ClearWish();
  rest_wanted_ = false;
  if (queue_.running() != nullptr) {
    queue_.Finish(ActState::kInterrupted, reason);
    speech_ = Speech::kNone;
    ended_ = now;
    back_end_.ShowTarget(std::nullopt);
  }
}

void Conductor::SetScene(const TableScene& scene, int64_t now) {
  body_.SeeHands(scene.foreign, now);
  back_end_.ShowScene(scene);
}

void Conductor::Heartbeat(int64_t now) {
  heartbeat_ = now;
  guidance_lost_ = false;
}

void Conductor::Retire(int64_t now) {
  if (retiring_) return;
  retiring_ = true;
  queue_.WithdrawAll("the robot bridge ends");
  if (queue_.running() != nullptr) {
    back_end_.Silence();
    End(ActState::kInterrupted, "the robot bridge ends", now);
  }
  rest_wanted_ = true;
}

void Conductor::HandleEvents(int64_t now) {
  for (const BackEndEvent& event : back_end_.Poll(now)) {
    if (event.kind == BackEndEvent::Kind::kHelpTouched) {
      ++help_requests_;
      continue;
    }
    const RobotCommand* running = queue_.running();
    if (running == nullptr || running->id != event.id || speech_ != Speech::kRunning) continue;
    if (event.kind == BackEndEvent::Kind::kSpeechDone) {
      speech_ = Speech::kDone;
    } else {
      End(ActState::kFailed, event.reason, now);
    }
  }
}

void Conductor::Begin(const RobotCommand& command, int64_t now) {
  begun_ = now;
  held_since_ = 0;
  body_.ClearWish();
  if (resting_) back_end_.Wake();
  resting_ = false;
  rest_wanted_ = command.kind == ActKind::kRest || guidance_lost_;
  text_ = CleanText(command.text);
  speech_ = text_.empty() ? Speech::kNone : Speech::kPending;
  if (command.kind == ActKind::kRest) return;
  if (const auto colour = EyeColourOf(command.eye_colour)) back_end_.SetEyes(*colour);
  if (command.look_target) {
    body_.LookAt(*command.look_target, now);
    straight_ = false;
  } else if (!straight_) {
    body_.LookStraight(now);
    straight_ = true;
  }
  if (command.point_target) {
    body_.PointAt(*command.point_target, now);
    back_end_.ShowTarget(command.point_target);
  } else {
    body_.LowerArms();
  }
  if (command.order == ActOrder::kTogether) StartSpeech(now);
}

void Conductor::StartSpeech(int64_t now) {
  if (speech_ != Speech::kPending) return;
  const RobotCommand& command = *queue_.running();
  speech_ = Speech::kRunning;
  speech_limit_ = now + Microseconds(4 + 3 * SpeakingTime(text_));
  if (!command.language.empty()) language_ = command.language;
  back_end_.Say({command.id, text_, language_, command.phrase_key, command.wording});
}

bool Conductor::GestureDone(int64_t now) const {
  switch (body_.pointing()) {
    case Pointing::kWaiting:
    case Pointing::kRaising:
      return false;
    case Pointing::kHolding:
      return held_since_ != 0 && now - held_since_ >= Microseconds(options_.shortest_point_s);
    case Pointing::kNone:
    case Pointing::kGivenUp:
    case Pointing::kUnreachable:
      return !body_.head_moving();
  }
  return true;
}

std::string Conductor::Remarks() const {
  if (body_.pointing() == Pointing::kGivenUp) return "not pointed: a hand was in the way or hands could not be seen";
  if (body_.pointing() == Pointing::kUnreachable) return "not pointed: the target is behind the robot or out of reach";
  return "";
}

void Conductor::StepAct(int64_t now) {
  const RobotCommand& command = *queue_.running();
  if (command.kind == ActKind::kRest) {
    if (resting_) End(ActState::kDone, "", now);
    return;
  }
  const bool looked = !body_.head_moving() || now - begun_ > Microseconds(options_.look_first_s);
  if (speech_ == Speech::kPending && looked) StartSpeech(now);
  if (body_.pointing() == Pointing::kHolding && held_since_ == 0) held_since_ = now;
  if (speech_ == Speech::kRunning && now > speech_limit_) {
    back_end_.Silence();
    End(ActState::kFailed, "the robot did not finish the sentence", now);
    return;
  }
  const bool said = speech_ == Speech::kNone || speech_ == Speech::kDone;
  if (said && GestureDone(now)) End(ActState::kDone, Remarks(), now);
}

void Conductor::End(ActState state, const std::string& reason, int64_t now) {
  const bool rests = queue_.running() != nullptr && queue_.running()->kind == ActKind::kRest;
  queue_.Finish(state, std::string(reason));
  speech_ = Speech::kNone;
  ended_ = now;
  if (rests && state != ActState::kDone) rest_wanted_ = false;
  body_.LowerArms();
  back_end_.ShowTarget(std::nullopt);
}

void Conductor::StepIdle(int64_t now) {
  const RobotCommand* running = queue_.running();
  if (rest_wanted_ && !resting_ && (running == nullptr || running->kind == ActKind::kRest)) {
    body_.LowerArms();
    if (!straight_) body_.LookStraight(now);
    straight_ = true;
    if (body_.arms_down() && !body_.head_moving()) {
      back_end_.Rest();
      resting_ = true;
      rest_wanted_ = false;
    }
    return;
  }
  const bool idle = running == nullptr && now - ended_ > Microseconds(options_.straight_after_s);
  if (idle && !straight_) {
    body_.LookStraight(now);
    straight_ = true;
  }
}

void Conductor::WatchGuidance(int64_t now) {
  if (!heartbeat_ || guidance_lost_) return;
  if (now - *heartbeat_ <= Microseconds(options_.heartbeat_timeout_s)) return;
  guidance_lost_ = true;
  queue_.WithdrawAll("the guidance is silent");
  rest_wanted_ = true;
}

void Conductor::Step(int64_t now) {
  HandleEvents(now);
  const bool connected = back_end_.State().connected;
  if (!connected) {
    if (queue_.running() != nullptr) End(ActState::kFailed, "the connection to the robot was lost", now);
    if (connected_) body_.Forget();
    connected_ = false;
    if (retiring_) resting_ = true;
    queue_.Expire(now);
    return;
  }
  connected_ = true;
  body_.Step(now);
  WatchGuidance(now);
  if (queue_.running() != nullptr) StepAct(now);
  queue_.Expire(now);
  if (!retiring_ && queue_.running() == nullptr) {
    if (const auto command = queue_.StartNext(now)) Begin(*command, now);
  }
  StepIdle(now);
}

}  // namespace coach
