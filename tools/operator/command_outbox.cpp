#include "tools/operator/command_outbox.h"

#include <algorithm>

namespace coach {
namespace {

constexpr size_t kRemembered = 16;

}  // namespace

std::vector<std::string> Concerned(OperatorKind kind) {
  switch (kind) {
    case OperatorKind::kChooseTask:
      return {"detector", "pose-filter", "assembly-reasoner"};
    case OperatorKind::kResetTracker:
      return {"pose-filter"};
    case OperatorKind::kVolume:
      return {"robot-bridge"};
    case OperatorKind::kStop:
      return {"assembly-reasoner", "robot-bridge"};
    default:
      return {"assembly-reasoner"};
  }
}

CommandOutbox::CommandOutbox(const Options& options, std::string station)
    : options_(options), station_(std::move(station)) {}

int64_t CommandOutbox::Post(OperatorKind kind, const std::string& argument, int64_t now) {
  const std::lock_guard lock(mutex_);
  const auto same = std::find_if(entries_.rbegin(), entries_.rend(), [&](const Entry& entry) {
    return entry.command.kind == kind && entry.command.argument == argument &&
           now - entry.command.utime < options_.same_click_us;
  });
  if (same != entries_.rend()) return same->command.id;
  const auto pending =
      std::count_if(entries_.begin(), entries_.end(), [](const Entry& entry) { return entry.fate == Fate::kPending; });
  if (static_cast<size_t>(pending) >= options_.max_pending && kind != OperatorKind::kStop) return 0;
  last_id_ = std::max(now, last_id_ + 1);
  Entry entry;
  entry.command = {last_id_, station_, now, kind, argument};
  entry.waiting_for = Concerned(kind);
  entries_.push_back(std::move(entry));
  return last_id_;
}

void CommandOutbox::Echo(const std::string& service, int64_t last_operator_command) {
  const std::lock_guard lock(mutex_);
  for (auto& entry : entries_) {
    if (entry.fate != Fate::kPending || entry.command.id > last_operator_command) continue;
    std::erase(entry.waiting_for, service);
    if (entry.waiting_for.empty()) entry.fate = Fate::kDone;
  }
}

std::vector<OperatorCommand> CommandOutbox::Due(int64_t now) {
  const std::lock_guard lock(mutex_);
  std::vector<OperatorCommand> due;
  for (auto& entry : entries_) {
    if (entry.fate != Fate::kPending) continue;
    const bool stop = entry.command.kind == OperatorKind::kStop;
    const int64_t patience = stop ? options_.give_up_stop_us : options_.give_up_us;
    if (now - entry.command.utime > patience) {
      entry.fate = Fate::kUnanswered;
    } else if (now - entry.last_sent >= options_.repeat_us) {
      entry.last_sent = now;
      due.push_back(entry.command);
    }
  }
  while (entries_.size() > kRemembered && entries_.front().fate != Fate::kPending) entries_.erase(entries_.begin());
  return due;
}

std::vector<CommandOutbox::Entry> CommandOutbox::Recent() const {
  const std::lock_guard lock(mutex_);
  const size_t first = entries_.size() > kRemembered ? entries_.size() - kRemembered : 0;
  return {entries_.begin() + static_cast<long>(first), entries_.end()};
}

}  // namespace coach
