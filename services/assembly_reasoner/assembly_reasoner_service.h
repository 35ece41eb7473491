// The assembly reasoner between its two buses. Table bus: PART_POSES and OPERATOR_COMMAND in; CONNECTION_BELIEF,
// ASSEMBLY_STATE, GUIDANCE_EVENT, TASK, TABLE_SCENE, ROBOT_COMMAND out. Robot bus: ROBOT_STATUS in; ROBOT_COMMAND,
// TABLE_SCENE, ASSEMBLY_STATE and the operator's stop out. ROBOT_STATUS and the robot host's SERVICE_HEALTH are relayed
// to the table bus, so that its log has the whole lesson.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/bus/node.h"
#include "services/assembly_reasoner/lesson.h"
#include "services/assembly_reasoner/lesson_clock.h"

namespace coach {

struct ReasonerServiceOptions {
  std::string robot_url;             ///< empty: there is no robot bus, commands go to the table bus only
  std::string key;                   ///< of the robot bus' commands; empty: no signature
  std::filesystem::path state_file;  ///< empty: nothing survives a restart
  std::filesystem::path event_log;   ///< JSON lines; empty: none
  double repeat_period = 0.2;        ///< s between two sendings of a command that is not acknowledged
};

class AssemblyReasonerService {
 public:
  AssemblyReasonerService(Node& node, Lesson& lesson, const ReasonerServiceOptions& options);
  void Run();

 private:
  struct Pending {
    RobotCommand command;
    int64_t first = 0, last = 0;  ///< us, steady clock
  };

  void Subscribe();
  void Restore();
  void HandlePoses(PartPoses poses);
  void HandleOperator(const OperatorCommand& command);
  void HandleStatus(const robot_status_t& message);
  void Deliver(const LessonOutput& out);
  void Send(Pending& pending, int64_t now);
  void SendScene(const PartPoses& poses);
  void Repeat();
  void Remember();

  Node& node_;
  Lesson& lesson_;
  ReasonerServiceOptions options_;
  Bus* robot_ = nullptr;
  std::deque<Pending> pending_;
  std::ofstream log_;
  LessonClock clock_;
  AssemblyState state_;
  int64_t last_state_ = 0, last_task_ = 0, last_scene_ = 0;  ///< us: state and task by the steady clock, scene by utime
  int64_t refused_ = 0;
};

}  // namespace coach
