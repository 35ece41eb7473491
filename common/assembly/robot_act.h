// What the robot is told and what it tells back. Plain data: the messages robot_command_t, robot_status_t,
// table_scene_t and operator_command_t without the bus.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "common/geometry/pose.h"

namespace coach {

enum class ActKind { kAct = 0, kStop = 1, kRest = 2, kPause = 3, kCancel = 4 };
enum class ActOrder { kTogether = 0, kLookThenSay = 1 };
enum class Priority { kReminder = 0, kExplanatory = 1, kCongratulatory = 2, kCorrective = 3, kOperator = 4, kStop = 5 };

/// One whole act. See lcmtypes/robot_command_t.lcm for the meaning of each field.
struct RobotCommand {
  int64_t id = 0;
  std::string station;
  int64_t session = 0;
  ActKind kind = ActKind::kAct;
  Priority priority = Priority::kExplanatory;
  std::string text;  ///< UTF-8, at most 400 bytes
  std::string phrase_key;
  int wording = 0;
  std::string language = "en";
  std::optional<Vector3> point_target;  ///< m, table frame
  std::optional<Vector3> look_target;   ///< m, table frame
  std::string eye_colour;
  ActOrder order = ActOrder::kTogether;
  int64_t replaces_id = 0;
  int64_t sent_utime = 0;    ///< us since 1970, sender's clock
  int64_t valid_for_us = 0;  ///< us left at sent_utime
  std::array<uint8_t, 16> hmac{};
};

enum class ActState { kNone = 0, kQueued = 1, kStarted = 2, kDone = 3, kInterrupted = 4, kExpired = 5, kFailed = 6 };
const char* ToString(ActState state);

struct RobotStatus {
  int64_t utime = 0;  ///< us since 1970, robot host's clock
  std::string station;
  int64_t session = 0;
  int64_t command_id = 0;
  ActState state = ActState::kNone;
  std::string reason;
  bool speaking = false;
  bool connected = false;
  std::string back_end;
  std::string language;
  double battery = -1;  ///< 0..1; -1 unknown
  bool point_clamped = false, gaze_clamped = false;
  int64_t help_requests = 0;
};

/// What the robot's side needs to draw the table and to avoid hands.
struct TableScene {
  struct TablePart {
    int part = 0;
    Pose X_TP = Pose::Identity();
    PartStatus status = PartStatus::kAbsent;
  };
  int64_t utime = 0;
  std::string station;
  std::vector<TablePart> parts;
  std::vector<ForeignBlob> foreign;
};

enum class OperatorKind {
  kChooseTask = 0,
  kLanguage = 1,
  kStart = 2,
  kPause = 3,
  kResume = 4,
  kSkip = 5,
  kMarkDone = 6,
  kMarkUndone = 7,
  kRepeat = 8,
  kSay = 9,
  kVolume = 10,
  kResetTracker = 11,
  kStop = 12,
  kHelp = 13,
};

struct OperatorCommand {
  int64_t id = 0;
  std::string station;
  int64_t utime = 0;
  OperatorKind kind = OperatorKind::kStart;
  std::string argument;
};

}  // namespace coach
