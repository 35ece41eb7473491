// What a report needs to know of one session, from whichever log it was read. Times are the data's, in us; what a log
// says by the clock only is carried over to the data's time.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/assembly/assembly_state.h"
#include "common/assembly/part_poses.h"
#include "common/assembly/robot_act.h"
#include "tools/operator/annotations.h"

namespace coach {

/// The names that indices stand for.
struct TaskNames {
  std::string name, sha256;
  std::vector<std::string> types, parts, connections, mistakes;
  std::vector<int> part_types;
};

/// How well one frame was tracked.
struct TrackedFrame {
  struct Part {
    PartStatus status = PartStatus::kAbsent;
    float visible = 0;  ///< 0..1
  };
  int64_t utime = 0;
  float latency_ms = -1;  ///< from capture to the recording of its poses; -1 unknown
  bool table_found = true;
  int exchanges = 0;  ///< identities of equal parts exchanged in this frame
  std::vector<Part> parts;
};

/// What the robot was told, and what became of it.
struct RobotAct {
  RobotCommand command;
  int64_t sent = 0;
  int64_t started = 0, ended = 0;  ///< 0 never, or not recorded
  ActState state = ActState::kNone;
  std::string reason;
  bool point_clamped = false, gaze_clamped = false;
};

/// One SERVICE_HEALTH.
struct HealthSample {
  int64_t utime = 0;
  std::string service, host, message;
  int pid = 0;
  int state = 0;  ///< service_health_t: 0 starting, 1 ok, 2 degraded, 3 failed
  double latency_p50_ms = 0, latency_p99_ms = 0;
  int64_t received = 0, answered = 0, dropped = 0, socket_drops = 0, decode_errors = 0;
};

struct RobotLink {
  int64_t utime = 0;
  bool connected = false;
  std::string back_end;
};

struct Configuration {
  std::string service, version, sha256, yaml;
};

struct Session {
  std::string name;                   ///< of the file or folder
  std::string station;                ///< empty: unknown
  std::vector<std::string> problems;  ///< of the log: cut off, of another version, ..
  int64_t begin = 0, end = 0;         ///< first and last moment
  bool has_bus = false;               ///< read from the bus, not only from the reasoner's event log
  std::vector<TaskNames> tasks;       ///< in the order of their first appearance
  std::vector<GuidanceEvent> events;  ///< in the order of the log, none twice
  std::vector<AssemblyState> states;  ///< without their events
  std::vector<TrackedFrame> frames;
  std::vector<RobotAct> acts;
  std::vector<RobotLink> links;  ///< changes only
  std::vector<HealthSample> health;
  std::vector<Configuration> configurations;  ///< each once
  std::vector<Annotation> annotations;        ///< in force, by time
};

}  // namespace coach
