#include "services/robot_bridge/robot_bridge_service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "common/bus/command_signature.h"
#include "common/bus/messages.h"

namespace coach {
namespace {

constexpr int64_t kStatusPeriod = 500000;   // us
constexpr int64_t kRepeatFor = 20000000;    // us, how long a change is repeated
constexpr size_t kMostRepeated = 16;        // changes
constexpr int64_t kSessionFresh = 5000000;  // us, how long ASSEMBLY_STATE's session is believed
constexpr int64_t kRetirement = 3000000;    // us

}  // namespace

int64_t SteadyMicroseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

RobotBridgeService::RobotBridgeService(Node& node, Conductor& conductor, BackEnd& back_end, std::string key)
    : node_(node), conductor_(conductor), back_end_(back_end), key_(std::move(key)) {
  Subscribe();
}

void RobotBridgeService::Subscribe() {
  node_.Subscribe<robot_command_t>([this](const robot_command_t& message) { HandleCommand(message); });
  node_.Subscribe<table_scene_t>([this](const table_scene_t& message) {
    if (message.station == node_.station()) conductor_.SetScene(FromMessage(message), SteadyMicroseconds());
  });
  node_.Subscribe<assembly_state_t>([this](const assembly_state_t& message) { HandleState(message); });
  node_.OnOperatorCommand([this](const OperatorCommand& command) { HandleOperator(command); });
}

bool RobotBridgeService::OfThisSession(int64_t session) const {
  const bool known = session_seen_ != 0 && SteadyMicroseconds() - session_seen_ < kSessionFresh;
  return !known || session == session_;
}

void RobotBridgeService::Reject(const robot_command_t& message, const std::string& reason) {
  spdlog::warn("command {} refused: {}", message.id, reason);
  PublishStatus({message.session, message.id, ActState::kFailed, reason, false});
}

void RobotBridgeService::HandleCommand(const robot_command_t& message) {
  if (message.station != node_.station()) return;
  node_.Received();
  if (!OfThisSession(message.session)) {
    node_.Dropped();
    return;
  }
  if (!key_.empty() && !SignatureFits(message, key_)) {
    node_.Dropped();
    spdlog::warn("command {} dropped: its signature is not of this station's key", message.id);
    return;
  }
  const int64_t now = SteadyMicroseconds();
  conductor_.Heartbeat(now);
  try {
    conductor_.Offer(FromMessage(message), now);
  } catch (const std::invalid_argument& error) {
    Reject(message, error.what());
  }
  PublishChanges();
  node_.Answered(0);
}

void RobotBridgeService::HandleState(const assembly_state_t& message) {
  const int64_t now = SteadyMicroseconds();
  conductor_.Heartbeat(now);
  session_ = message.session;
  session_seen_ = now;
}

void RobotBridgeService::HandleOperator(const OperatorCommand& command) {
  if (command.kind == OperatorKind::kStop) {
    conductor_.Stop(SteadyMicroseconds());
    PublishChanges();
  } else if (command.kind == OperatorKind::kVolume) {
    char* end = nullptr;
    const double percent = std::strtod(command.argument.c_str(), &end);
    if (end != command.argument.c_str() && percent >= 0 && percent <= 100) conductor_.SetVolume(percent / 100);
  }
}

void RobotBridgeService::PublishChanges() {
  const int64_t now = SteadyMicroseconds();
  for (const ActChange& change : conductor_.TakeChanges()) {
    if (!change.repeated) {
      spdlog::info("command {}: {}{}{}", change.id, ToString(change.state), change.reason.empty() ? "" : ": ",
                   change.reason);
      std::erase_if(recent_, [&](const Outcome& outcome) {
        return outcome.change.id == change.id && outcome.change.session == change.session;
      });
      recent_.push_back({change, now + kRepeatFor});
      if (recent_.size() > kMostRepeated) recent_.pop_front();
    }
    PublishStatus(change);
  }
}

void RobotBridgeService::PublishStatus(const ActChange& change) {
  const BackEndState state = back_end_.State();
  RobotStatus status;
  status.utime = node_.Now();
  status.station = node_.station();
  status.session = change.session;
  status.command_id = change.id;
  status.state = change.state;
  status.reason = change.reason;
  status.speaking = conductor_.speaking();
  status.connected = state.connected;
  status.back_end = back_end_.name();
  status.language = conductor_.language();
  status.battery = state.battery;
  status.point_clamped = conductor_.body().point_clamped();
  status.gaze_clamped = conductor_.body().gaze_clamped();
  status.help_requests = conductor_.help_requests();
  node_.Publish(ToMessage(status));
}

void RobotBridgeService::SayHealth() {
  const BackEndState state = back_end_.State();
  if (!state.connected) {
    node_.SetState(service_health_t::DEGRADED, "no robot: " + state.detail);
  } else if (conductor_.guidance_lost()) {
    node_.SetState(service_health_t::DEGRADED, "the guidance is silent: the robot rests");
  } else {
    node_.SetState(service_health_t::OK, state.detail);
  }
}

void RobotBridgeService::Step() {
  const int64_t now = SteadyMicroseconds();
  const int64_t help = conductor_.help_requests();
  conductor_.Step(now);
  PublishChanges();
  if (now - last_status_ < kStatusPeriod && help == conductor_.help_requests()) return;
  last_status_ = now;
  SayHealth();
  std::erase_if(recent_, [&](const Outcome& outcome) { return recent_.size() > 1 && outcome.until < now; });
  if (recent_.empty()) PublishStatus({session_, 0, ActState::kNone, "", true});
  for (const Outcome& outcome : recent_) PublishStatus(outcome.change);
}

void RobotBridgeService::Run() {
  node_.Run([this] { Step(); });
  const int64_t begun = SteadyMicroseconds();
  conductor_.Retire(begun);
  while (!conductor_.at_rest() && SteadyMicroseconds() - begun < kRetirement) {
    Step();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace coach
