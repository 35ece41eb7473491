// What a recording holds, channel by channel.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/bus/channels.h"
#include "tools/log/log_file.h"

namespace coach {

struct ChannelSummary {
  int64_t events = 0;
  int64_t bytes = 0;
  int64_t first = 0, last = 0;  ///< us, of the logger
  int64_t undecodable = 0;      ///< of a channel of ours; others are not looked into
  int64_t missing = 0;          ///< gaps in the frames' sequence numbers
  bool known = false;           ///< a channel of ours
  std::vector<float> ages_ms;   ///< from a frame's capture (received_utime) to the recording; sorted; empty if unknown
  /// Age that so many percent are younger than, ms; 0 if unknown.
  double AgePercentile(double percent) const;
  double rate() const {
    return last > first ? 1e6 * static_cast<double>(events - 1) / static_cast<double>(last - first) : 0;
  }
};

struct LogSummary {
  std::map<std::string, ChannelSummary> channels;  ///< by name with the station's prefix
  std::map<std::string, service_health_t> health;  ///< each service's last word, by station/service
  int64_t events = 0, bytes = 0;
  double seconds = 0;    ///< from the first event to the last
  bool complete = true;  ///< false: the file is cut off or damaged after what was counted
};

LogSummary Summarise(LogReader& reader);

/// Why a recording is not what it should be: it is empty, damaged, holds what can't be decoded, or a channel of
/// `required` (without the station's prefix) has no event. Empty if all is well.
std::vector<std::string> ProblemsOf(const LogSummary& summary, const std::vector<std::string>& required);

}  // namespace coach
