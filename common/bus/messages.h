// Between the messages of lcmtypes/ and the plain structs of the domain.
//
// ToMessage fills every field and count. FromMessage checks what it reads: numbers must be finite, rotations unit,
// fractions in their range, enumerations known, counts within the bounds below; it throws std::invalid_argument naming
// the field otherwise (in a handler the bus counts that as a malformed message). FromMessage(ToMessage(x)) is x, up to
// single precision where the message has floats.
#pragma once

#include "common/assembly/assembly_state.h"
#include "common/assembly/detections.h"
#include "common/assembly/part_poses.h"
#include "common/assembly/robot_act.h"
#include "common/assembly/task.h"
#include "common/bus/channels.h"

namespace coach {

constexpr int kMaxParts = 64;         ///< of a task
constexpr int kMaxPairs = 1024;       ///< of a PART_POSES
constexpr int kMaxRegions = 1024;     ///< of a DETECTIONS
constexpr int kMaxConnections = 512;  ///< of a task, and of mistakes
constexpr int kMaxForeign = 16;       ///< blobs
constexpr size_t kMaxSpeechBytes = 400;

pose_t ToMessage(const Pose& X);
Pose FromMessage(const pose_t& message);

detections_t ToMessage(const Detections& detections);
Detections FromMessage(const detections_t& message);

part_poses_t ToMessage(const PartPoses& poses);
PartPoses FromMessage(const part_poses_t& message);

connection_belief_t ToMessage(const ConnectionBelief& belief);
ConnectionBelief FromMessage(const connection_belief_t& message);

guidance_event_t ToMessage(const GuidanceEvent& event);
GuidanceEvent FromMessage(const guidance_event_t& message);

assembly_state_t ToMessage(const AssemblyState& state);
AssemblyState FromMessage(const assembly_state_t& message);

/// @throws std::invalid_argument if the text is longer than kMaxSpeechBytes.
robot_command_t ToMessage(const RobotCommand& command);
RobotCommand FromMessage(const robot_command_t& message);

robot_status_t ToMessage(const RobotStatus& status);
RobotStatus FromMessage(const robot_status_t& message);

table_scene_t ToMessage(const TableScene& scene);
TableScene FromMessage(const table_scene_t& message);

operator_command_t ToMessage(const OperatorCommand& command);
OperatorCommand FromMessage(const operator_command_t& message);

/// The names of a task. There is no way back: a task is read from its file.
task_t ToMessage(const Task& task);

}  // namespace coach
