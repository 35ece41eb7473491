// What went wrong on the way: processes that died, messages lost, parts that were not found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/report/session.h"

namespace coach {

struct Incident {
  enum class Kind { kRestart, kSilence, kTrouble, kDrops, kTracking, kRobot, kGap };
  Kind kind = Kind::kTrouble;
  int64_t utime = 0;   ///< when it began
  double seconds = 0;  ///< how long it lasted; 0 a moment
  std::string what;
};
const char* ToString(Incident::Kind kind);

struct IncidentOptions {
  double silence = 3;  ///< s without a sign of life of a service
  double gap = 1;      ///< s without poses
  double lost = 1;     ///< s that a part is lost, or the table not found
  double robot = 1;    ///< s without connection to the robot
};

/// By time. Drops are counted over the whole session, one incident a service and kind.
std::vector<Incident> Incidents(const Session& session, const IncidentOptions& options = {});

}  // namespace coach
