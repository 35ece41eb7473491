// The robot bridge on the robot bus: commands in, statuses out.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/node.h"
#include "services/robot_bridge/conductor.h"

namespace coach {

/// Carries messages between the robot bus and a Conductor. Takes in what is of its station, and of the session that
/// ASSEMBLY_STATE names; commands of another session are dropped and counted.
class RobotBridgeService {
 public:
  /// @param key of the robot bus, empty: commands carry no signature
  RobotBridgeService(Node& node, Conductor& conductor, BackEnd& back_end, std::string key);

  /// Runs until the node is asked to stop, then takes the robot's arms down (3 s at most).
  void Run();

 private:
  struct Outcome {
    ActChange change;
    int64_t until = 0;  // us, steady clock: repeated at 2 Hz until then
  };

  void Subscribe();
  void HandleCommand(const robot_command_t& message);
  void HandleState(const assembly_state_t& message);
  void HandleOperator(const OperatorCommand& command);
  void Reject(const robot_command_t& message, const std::string& reason);
  bool OfThisSession(int64_t session) const;
  void Step();
  void PublishChanges();
  void PublishStatus(const ActChange& change);
  void SayHealth();

  Node& node_;
  Conductor& conductor_;
  BackEnd& back_end_;
  std::string key_;
  int64_t session_ = 0, session_seen_ = 0;
  std::deque<Outcome> recent_;  // the last changes, oldest first
  int64_t last_status_ = 0;
};

/// us of the steady clock.
int64_t SteadyMicroseconds();

}  // namespace coach
