#include "services/robot_bridge/act_queue.h"

#include <algorithm>

namespace coach {
namespace {

/// What makes a command impossible to carry out; empty: nothing.
std::string ProblemOf(const RobotCommand& command, const ActQueueOptions& options) {
  if (command.text.size() > static_cast<size_t>(options.max_text_bytes)) {
    return "text of " + std::to_string(command.text.size()) + " bytes; at most " +
           std::to_string(options.max_text_bytes) + " can be said";
  }
  if (command.point_target && !command.point_target->allFinite()) return "the point target is not finite";
  if (command.look_target && !command.look_target->allFinite()) return "the look target is not finite";
  return "";
}

}  // namespace

void ActQueue::Record(const RobotCommand& command, ActState state, const std::string& reason) {
  const Key key{command.session, command.id};
  const auto [place, added] = known_.insert_or_assign(key, Known{state, reason});
  if (added) known_order_.push_back(key);
  changes_.push_back({command.session, command.id, state, reason, false});
  Forget();
}

void ActQueue::Forget() {
  while (known_order_.size() > static_cast<size_t>(options_.memory)) {
    const Key oldest = known_order_.front();
    known_order_.pop_front();
    // What still waits or runs (a few) is kept, so that its repeats are recognised.
    if (IsFinal(known_.at(oldest).state)) {
      known_.erase(oldest);
    } else {
      known_order_.push_back(oldest);
    }
  }
}

void ActQueue::AnswerRepeat(const RobotCommand& command, const Known& known, int64_t now) {
  changes_.push_back({command.session, command.id, known.state, known.reason, true});
  // A packet that was held up on its way made the deadline too late: the repeats' own countdown corrects it.
  for (Waiting& waiting : waiting_) {
    if (waiting.command.id != command.id || waiting.command.session != command.session) continue;
    waiting.deadline = std::min(waiting.deadline, now + std::max<int64_t>(command.valid_for_us, 0));
  }
}

void ActQueue::Withdraw(const RobotCommand& by) {
  if (by.replaces_id == 0 || by.replaces_id == by.id) return;
  RobotCommand withdrawn;
  withdrawn.session = by.session;
  withdrawn.id = by.replaces_id;
  const std::string reason = "withdrawn by command " + std::to_string(by.id);
  if (running_ && running_->id == by.replaces_id && running_->session == by.session) {
    interrupt_ = reason;
    return;
  }
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    return waiting.command.id == by.replaces_id && waiting.command.session == by.session;
  });
  const auto known = known_.find({by.session, by.replaces_id});
  // Not seen yet: it is on its way and must not be said when it arrives.
  if (known == known_.end() || !IsFinal(known->second.state)) Record(withdrawn, ActState::kInterrupted, reason);
}

void ActQueue::Enqueue(const RobotCommand& command, int64_t deadline) {
  waiting_.push_back({command, deadline});
  Record(command, ActState::kQueued, "");
  if (waiting_.size() <= static_cast<size_t>(options_.capacity)) return;
  const auto least = std::min_element(waiting_.begin(), waiting_.end(), [](const Waiting& a, const Waiting& b) {
    return a.command.priority < b.command.priority;
  });
  const RobotCommand dropped = least->command;
  waiting_.erase(least);
  Record(dropped, ActState::kFailed, "the queue is full");
}

void ActQueue::Offer(const RobotCommand& command, int64_t now) {
  if (const auto known = known_.find({command.session, command.id}); known != known_.end()) {
    AnswerRepeat(command, Known(known->second), now);
    return;
  }
  if (command.valid_for_us <= 0) {
    Record(command, ActState::kExpired, "out of date when it came");
    return;
  }
  if (const std::string problem = ProblemOf(command, options_); !problem.empty()) {
    Record(command, ActState::kFailed, problem);
    return;
  }
  Withdraw(command);
  switch (command.kind) {
    case ActKind::kStop:
      WithdrawAll("stopped");
      if (running_) interrupt_ = "stopped";
      Record(command, ActState::kDone, "");
      return;
    case ActKind::kPause:
      WithdrawAll("paused");
      Record(command, ActState::kDone, "");
      return;
    case ActKind::kCancel:
      Record(command, ActState::kDone, "");
      return;
    case ActKind::kRest:
    case ActKind::kAct:
      break;
  }
  if (running_ && command.priority >= Priority::kOperator && running_->priority < command.priority) {
    interrupt_ = "overruled by command " + std::to_string(command.id);
  }
  Enqueue(command, now + std::min(command.valid_for_us, options_.longest_validity_us));
}

void ActQueue::Expire(int64_t now) {
  std::vector<RobotCommand> expired;
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    if (waiting.deadline > now) return false;
    expired.push_back(waiting.command);
    return true;
  });
  for (const RobotCommand& command : expired) Record(command, ActState::kExpired, "waited too long");
}

std::optional<RobotCommand> ActQueue::StartNext(int64_t now) {
  Expire(now);
  if (running_ || waiting_.empty()) return std::nullopt;
  const auto next = std::max_element(waiting_.begin(), waiting_.end(), [](const Waiting& a, const Waiting& b) {
    return a.command.priority < b.command.priority;
  });
  running_ = next->command;
  interrupt_.clear();
  waiting_.erase(next);
  Record(*running_, ActState::kStarted, "");
  return running_;
}

void ActQueue::Finish(ActState state, const std::string& reason) {
  if (!running_) return;
  Record(*running_, state, reason);
  running_.reset();
  interrupt_.clear();
}

void ActQueue::WithdrawAll(const std::string& reason) {
  std::deque<Waiting> withdrawn;
  withdrawn.swap(waiting_);
  for (const Waiting& waiting : withdrawn) Record(waiting.command, ActState::kInterrupted, reason);
}

}  // namespace coach
