#include "services/assembly_reasoner/assembly_reasoner_service.h"

#include <spdlog/spdlog.h>

#include <chrono>

#include "common/bus/command_signature.h"
#include "common/bus/messages.h"
#include "common/configuration/yaml_reader.h"
#include "services/assembly_reasoner/lesson_file.h"

namespace coach {
namespace {

constexpr int64_t kStatePeriod = 500000;  // us
constexpr int64_t kTaskPeriod = 1000000;  // us
constexpr int64_t kScenePeriod = 100000;  // us
constexpr size_t kMostPending = 8;        // commands

int64_t SteadyNow() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Whether what is published on change has changed.
bool Differs(const AssemblyState& a, const AssemblyState& b) {
  if (a.phase != b.phase || a.idle_level != b.idle_level || a.step != b.step || a.made != b.made || a.task != b.task ||
      a.session != b.session || a.connections.size() != b.connections.size())
    return true;
  for (size_t i = 0; i < a.connections.size(); ++i) {
    const ConnectionState &x = a.connections[i], &y = b.connections[i];
    if (x.state != y.state || x.connection != y.connection || x.part_a != y.part_a || x.part_b != y.part_b) return true;
  }
  const int64_t last_a = a.events.empty() ? 0 : a.events.back().id, last_b = b.events.empty() ? 0 : b.events.back().id;
  return last_a != last_b;
}

}  // namespace

AssemblyReasonerService::AssemblyReasonerService(Node& node, Lesson& lesson, const ReasonerServiceOptions& options)
    : node_(node), lesson_(lesson), options_(options) {
  if (!options_.robot_url.empty()) robot_ = &node_.Join(options_.robot_url);
  if (!options_.event_log.empty()) log_.open(options_.event_log, std::ios::app);
  if (!options_.event_log.empty() && !log_)
    throw ConfigurationError(options_.event_log.string() + ": can't be written");
  Restore();
  Subscribe();
}

void AssemblyReasonerService::Restore() {
  if (options_.state_file.empty()) return;
  const auto text = ReadText(options_.state_file);
  if (!text) return;
  try {
    lesson_.Restore(LessonMemoryFromJson(*text));
    spdlog::info("the lesson of session {} goes on", lesson_.session());
  } catch (const std::invalid_argument& error) {
    spdlog::warn("{}: {}: a new lesson begins", options_.state_file.string(), error.what());
  }
}

void AssemblyReasonerService::Subscribe() {
  node_.SubscribeNewest<part_poses_t>([this](const part_poses_t& message) { HandlePoses(FromMessage(message)); });
  node_.OnOperatorCommand([this](const OperatorCommand& command) { HandleOperator(command); });
  if (robot_ == nullptr) {
    node_.Subscribe<robot_status_t>([this](const robot_status_t& message) { HandleStatus(message); });
    return;
  }
  robot_->Subscribe<robot_status_t>([this](const robot_status_t& message) {
    HandleStatus(message);
    node_.Publish(message);
  });
  robot_->Subscribe<service_health_t>([this](const service_health_t& message) {
    if (message.service != node_.service()) node_.Publish(message);
  });
}

void AssemblyReasonerService::HandlePoses(PartPoses poses) {
  node_.Received();
  const int64_t utime = poses.utime;
  poses.utime = clock_.ToLesson(utime);
  LessonOutput out = lesson_.Step(poses);
  poses.utime = out.belief.utime = utime;
  if (!out.accepted) {
    node_.Dropped();
    if (++refused_ == 1 || refused_ % 100 == 0)
      spdlog::warn("PART_POSES refused ({} so far): {}", refused_, out.refused);
    return;
  }
  node_.Publish(ToMessage(out.belief));
  Deliver(out);
  SendScene(poses);
  node_.Answered(poses.received_utime);
}

void AssemblyReasonerService::HandleOperator(const OperatorCommand& command) {
  if (command.kind == OperatorKind::kStop && robot_ != nullptr) robot_->Publish(ToMessage(command));
  Deliver(lesson_.Handle(command));
}

void AssemblyReasonerService::HandleStatus(const robot_status_t& message) {
  if (message.station != node_.station()) return;
  const RobotStatus status = FromMessage(message);
  lesson_.Handle(status);
  if (status.state == ActState::kNone) return;
  std::erase_if(pending_, [&](const Pending& p) {
    return p.command.id == status.command_id && p.command.session == status.session;
  });
}

/// Events, commands and, if it has changed, the state.
void AssemblyReasonerService::Deliver(const LessonOutput& out) {
  for (const GuidanceEvent& event : out.events) {
    node_.Publish(ToMessage(event));
    if (log_.is_open()) log_ << ToJsonLine(event) << '\n';
    if (event.kind != "act") spdlog::info("{} {}: {}", event.kind, event.subject, event.reason);
  }
  if (log_.is_open() && !out.events.empty()) log_.flush();
  const int64_t now = SteadyNow();
  for (const RobotCommand& command : out.commands) {
    pending_.push_back({command, now, 0});
    if (pending_.size() > kMostPending) pending_.pop_front();
    Send(pending_.back(), now);
  }
  if (out.state.task != state_.task) last_task_ = 0;  // the tracker is to follow at once
  const bool changed = Differs(out.state, state_);
  state_ = out.state;
  if (!changed) return;
  last_state_ = now;
  node_.Publish(ToMessage(state_));
  if (robot_ != nullptr) robot_->Publish(ToMessage(state_));
  Remember();
}

/// One sending of a command, with what is left of its validity and a fresh signature.
void AssemblyReasonerService::Send(Pending& pending, int64_t now) {
  pending.last = now;
  RobotCommand command = pending.command;
  if (!node_.lockstep()) {
    command.sent_utime = node_.Now();
    command.valid_for_us -= now - pending.first;
  }
  robot_command_t message = ToMessage(command);
  if (!options_.key.empty()) Sign(message, options_.key);
  node_.Publish(message);
  if (robot_ != nullptr) robot_->Publish(message);
}

void AssemblyReasonerService::SendScene(const PartPoses& poses) {
  if (last_scene_ != 0 && poses.utime - last_scene_ < kScenePeriod && poses.utime > last_scene_) return;
  last_scene_ = poses.utime;
  TableScene scene;
  scene.utime = poses.utime;
  scene.station = node_.station();
  for (size_t i = 0; i < poses.parts.size(); ++i)
    scene.parts.push_back({static_cast<int>(i), poses.parts[i].X_TP, poses.parts[i].status});
  scene.foreign = poses.foreign;
  const table_scene_t message = ToMessage(scene);
  node_.Publish(message);
  if (robot_ != nullptr) robot_->Publish(message);
}

/// What goes by the clock: commands that wait for an answer, the state twice a second, the task's names once.
void AssemblyReasonerService::Repeat() {
  if (node_.lockstep()) return;
  const int64_t now = SteadyNow();
  std::erase_if(pending_, [&](const Pending& p) { return now - p.first >= p.command.valid_for_us; });
  for (Pending& p : pending_) {
    if (static_cast<double>(now - p.last) * 1e-6 >= options_.repeat_period) Send(p, now);
  }
  if (now - last_state_ >= kStatePeriod) {
    last_state_ = now;
    state_.session = lesson_.session();
    if (state_.task.empty()) state_.task = lesson_.task().name;
    node_.Publish(ToMessage(state_));
    if (robot_ != nullptr) robot_->Publish(ToMessage(state_));
  }
  if (now - last_task_ >= kTaskPeriod) {
    last_task_ = now;
    node_.Publish(ToMessage(lesson_.task()));
  }
}

void AssemblyReasonerService::Remember() {
  if (options_.state_file.empty() || node_.lockstep()) return;
  try {
    WriteAtomically(options_.state_file, ToJson(lesson_.Save()));
  } catch (const std::exception& error) {
    spdlog::error("the lesson's state: {}", error.what());
  }
}

void AssemblyReasonerService::Run() {
  node_.SetState(service_health_t::OK, "");
  node_.Run([this] { Repeat(); });
  Remember();
}

}  // namespace coach
