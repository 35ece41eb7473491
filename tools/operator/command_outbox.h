// Operator's commands on their way: each is repeated until the services concerned have echoed its id.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "common/assembly/robot_act.h"

namespace coach {

/// Thread safe. Times are us since 1970 of this host.
class CommandOutbox {
 public:
  struct Options {
    int64_t repeat_us = 200'000;           ///< between two sendings of one command
    int64_t give_up_us = 6'000'000;        ///< a command nobody echoes is dropped after that ...
    int64_t give_up_stop_us = 60'000'000;  ///< ... and a stop after that
    int64_t same_click_us = 300'000;       ///< the same command again within this time is the same click
    size_t max_pending = 32;               ///< more are refused
  };
  CommandOutbox(const Options& options, std::string station);

  /// Takes a command. @return its id (grows for ever, also over restarts); the id of the earlier one for the same
  /// click; 0 if too many are pending.
  int64_t Post(OperatorKind kind, const std::string& argument, int64_t now);

  /// A service says which command it saw last.
  void Echo(const std::string& service, int64_t last_operator_command);

  /// Those to be published now.
  std::vector<OperatorCommand> Due(int64_t now);

  enum class Fate { kPending, kDone, kUnanswered };
  struct Entry {
    OperatorCommand command;
    Fate fate = Fate::kPending;
    std::vector<std::string> waiting_for;  ///< services that have not echoed yet
    int64_t last_sent = 0;
  };
  /// The last 16, oldest first.
  std::vector<Entry> Recent() const;

 private:
  const Options options_;
  const std::string station_;
  mutable std::mutex mutex_;
  int64_t last_id_ = 0;
  std::vector<Entry> entries_;
};

/// The services that a command is meant for.
std::vector<std::string> Concerned(OperatorKind kind);

}  // namespace coach
