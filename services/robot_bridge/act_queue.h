// Which act is next. Every command gets exactly one final state; repeats of a command are recognised by its id.
//
// Times are of one monotonic clock of this process, handed in (us): a command's validity is counted from when it came
// here, so the clocks of the two hosts need not agree.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/robot_act.h"

namespace coach {

struct ActQueueOptions {
  int capacity = 16;                       ///< acts that wait, at most; beyond, the least important one fails
  int memory = 4096;                       ///< commands whose outcome is remembered, to recognise repeats
  int max_text_bytes = 400;                ///< of a command's text
  int64_t longest_validity_us = 60000000;  ///< us, longer validities are cut
};

/// One change of a command's state, in the order in which they happened.
struct ActChange {
  int64_t session = 0, id = 0;
  ActState state = ActState::kNone;
  std::string reason;
  bool repeated = false;  ///< nothing changed: the answer to a repeat of a command already known
};

inline bool IsFinal(ActState state) { return state >= ActState::kDone; }

class ActQueue {
 public:
  explicit ActQueue(const ActQueueOptions& options = {}) : options_(options) {}

  /// Takes in a command. A running act that it withdraws or overrules (stop; an operator's act; replaces_id) is NOT
  /// ended here: `interrupt()` tells so, and the caller stops the robot and calls Finish().
  void Offer(const RobotCommand& command, int64_t now);

  /// Ends what has waited too long.
  void Expire(int64_t now);

  /// Starts the most important act that waits, the oldest of equals; nothing while one runs.
  std::optional<RobotCommand> StartNext(int64_t now);

  /// Ends the running act. @param state final
  void Finish(ActState state, const std::string& reason);

  /// Ends everything that waits.
  void WithdrawAll(const std::string& reason);

  const RobotCommand* running() const { return running_ ? &*running_ : nullptr; }
  /// Why the running act must end now; empty: it may go on.
  const std::string& interrupt() const { return interrupt_; }
  size_t waiting() const { return waiting_.size(); }

  /// Changes since the last call.
  std::vector<ActChange> TakeChanges() { return std::exchange(changes_, {}); }

 private:
  using Key = std::pair<int64_t, int64_t>;  // session, id
  struct Waiting {
    RobotCommand command;
    int64_t deadline = 0;
  };
  struct Known {
    ActState state = ActState::kNone;
    std::string reason;
  };

  void Record(const RobotCommand& command, ActState state, const std::string& reason);
  void AnswerRepeat(const RobotCommand& command, const Known& known, int64_t now);
  void Withdraw(const RobotCommand& by);
  void Enqueue(const RobotCommand& command, int64_t deadline);
  void Forget();

  ActQueueOptions options_;
  std::deque<Waiting> waiting_;
  std::optional<RobotCommand> running_;
  std::string interrupt_;
  std::map<Key, Known> known_;
  std::deque<Key> known_order_;  // oldest first
  std::vector<ActChange> changes_;
};

}  // namespace coach
