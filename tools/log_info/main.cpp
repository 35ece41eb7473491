// coach-log-info: what is in a recording, and was everybody well?
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <set>

#include "common/bus/channels.h"
#include "tools/log_diff/recording.h"

namespace coach {
namespace {

struct ChannelSummary {
  int64_t messages = 0, bytes = 0, largest = 0, undecodable = 0, gaps = 0;
  int64_t first = 0, last = 0;  // us, when recorded
  int64_t last_sequence = -1;
};

/// Decodes as M; counts what can't be, and frames that are missing.
template <class M>
bool Decode(std::span<const uint8_t> bytes, ChannelSummary& summary, M& message) {
  const int size = static_cast<int>(bytes.size());
  try {
    if (message.decode(bytes.data(), 0, size) != size) throw std::invalid_argument("");
  } catch (const std::exception&) {
    ++summary.undecodable;
    return false;
  }
  if constexpr (requires { message.sequence; }) {
    if (summary.last_sequence >= 0 && message.sequence > summary.last_sequence)
      summary.gaps += message.sequence - summary.last_sequence - 1;
    summary.last_sequence = message.sequence;
  }
  return true;
}

class Summary {
 public:
  void Add(const std::string& channel, std::span<const uint8_t> bytes, int64_t utime) {
    ChannelSummary& s = channels_[channel];
    const auto size = static_cast<int64_t>(bytes.size());
    if (s.messages++ == 0) s.first = utime;
    s.last = utime;
    s.bytes += size;
    s.largest = std::max(s.largest, size);
    const std::string name = channel.substr(channel.rfind('/') + 1);
    TryAll<color_image_t, depth_image_t, detections_t, part_poses_t, connection_belief_t, assembly_state_t,
           guidance_event_t, task_t, table_scene_t, robot_command_t, robot_status_t, operator_command_t, annotation_t,
           config_t, service_health_t>(name, bytes, s);
  }

  /// @returns false if there is nothing, or something can't be decoded.
  bool Print() const {
    std::printf("%-32s %8s %8s %10s %9s %6s %12s\n", "channel", "messages", "Hz", "kB/s", "largest", "gaps",
                "undecodable");
    int64_t undecodable = 0;
    for (const auto& [channel, s] : channels_) {
      const double seconds = std::max(1e-6, static_cast<double>(s.last - s.first) * 1e-6);
      std::printf("%-32s %8lld %8.2f %10.1f %9lld %6lld %12lld\n", channel.c_str(), static_cast<long long>(s.messages),
                  static_cast<double>(s.messages - 1) / seconds, static_cast<double>(s.bytes) * 1e-3 / seconds,
                  static_cast<long long>(s.largest), static_cast<long long>(s.gaps),
                  static_cast<long long>(s.undecodable));
      undecodable += s.undecodable;
    }
    for (const auto& [name, health] : health_)
      std::printf(
          "%s: received %lld answered %lld dropped %lld, socket drops %lld, bad messages %lld, %.1f Hz, latency p50 "
          "%.1f p99 %.1f ms, work p50 "
          "%.1f p99 %.1f ms, %.0f MB%s%s\n",
          name.c_str(), static_cast<long long>(health.received), static_cast<long long>(health.answered),
          static_cast<long long>(health.dropped), static_cast<long long>(health.socket_drops),
          static_cast<long long>(health.decode_errors), static_cast<double>(health.rate),
          static_cast<double>(health.latency_p50_ms), static_cast<double>(health.latency_p99_ms),
          static_cast<double>(health.work_p50_ms), static_cast<double>(health.work_p99_ms),
          static_cast<double>(health.resident_bytes) * 1e-6, health.message.empty() ? "" : "; ",
          health.message.c_str());
    return !channels_.empty() && undecodable == 0;
  }

 private:
  template <class... Ms>
  void TryAll(const std::string& name, std::span<const uint8_t> bytes, ChannelSummary& s) {
    (Try<Ms>(name, bytes, s), ...);
  }
  template <class M>
  void Try(const std::string& name, std::span<const uint8_t> bytes, ChannelSummary& s) {
    M message;
    if (name != kChannel<M> || !Decode(bytes, s, message)) return;
    if constexpr (std::is_same_v<M, service_health_t>) health_[message.station + "/" + message.service] = message;
  }

  std::map<std::string, ChannelSummary> channels_;
  std::map<std::string, service_health_t> health_;  // the last of each service
};

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: coach-log-info RECORDING.lcm\n"
                 "Prints what each channel holds and each service's last SERVICE_HEALTH. Exit code 1 if the recording "
                 "is empty or holds a "
                 "message that can't be decoded, 2 if it can't be read.\n";
    return 2;
  }
  try {
    coach::Summary summary;
    coach::ForEachMessage(argv[1], [&](const std::string& channel, std::span<const uint8_t> bytes, int64_t utime) {
      summary.Add(channel, bytes, utime);
    });
    return summary.Print() ? 0 : 1;
  } catch (const std::exception& e) {
    std::cerr << "coach-log-info: " << e.what() << '\n';
    return 2;
  }
}
