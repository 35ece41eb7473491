#include "tools/log/log_summary.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "common/bus/channels.h"
#include "common/bus/decode_message.h"

namespace coach {
namespace {

/// What one message says of itself; nothing if it can't be decoded.
struct Decoded {
  int64_t sequence = -1;       ///< -1: has none
  int64_t received_utime = 0;  ///< us since 1970, capture of the frame; 0 unknown
  std::optional<service_health_t> health;
};
using Decoder = std::function<std::optional<Decoded>(std::span<const uint8_t>)>;

template <class M>
std::optional<Decoded> Decode(std::span<const uint8_t> bytes) try {
  const M message = DecodeMessage<M>(bytes);
  Decoded decoded;
  if constexpr (requires { message.sequence; }) decoded.sequence = message.sequence;
  if constexpr (requires { message.received_utime; }) decoded.received_utime = message.received_utime;
  if constexpr (std::is_same_v<M, service_health_t>) decoded.health = message;
  return decoded;
} catch (const std::exception&) {
  return std::nullopt;
}

template <class... M>
std::map<std::string, Decoder> DecodersOf() {
  return {{kChannel<M>, Decode<M>}...};
}

const std::map<std::string, Decoder>& Decoders() {
  static const auto decoders =
      DecodersOf<color_image_t, depth_image_t, detections_t, part_poses_t, connection_belief_t, assembly_state_t,
                 guidance_event_t, task_t, table_scene_t, robot_command_t, robot_status_t, operator_command_t,
                 annotation_t, service_health_t, config_t>();
  return decoders;
}

std::string WithoutStation(const std::string& channel) { return channel.substr(channel.find('/') + 1); }

}  // namespace

double ChannelSummary::AgePercentile(double percent) const {
  if (ages_ms.empty()) return 0;
  return ages_ms[static_cast<size_t>(percent / 100 * static_cast<double>(ages_ms.size() - 1) + 0.5)];
}

LogSummary Summarise(LogReader& reader) {
  LogSummary summary;
  std::map<std::string, int64_t> sequences;
  int64_t first = 0, last = 0;
  while (const auto event = reader.Next()) {
    ChannelSummary& channel = summary.channels[event->channel];
    if (channel.events == 0) channel.first = event->utime;
    if (summary.events == 0) first = event->utime;
    last = channel.last = event->utime;
    ++channel.events;
    ++summary.events;
    channel.bytes += static_cast<int64_t>(event->bytes.size());
    summary.bytes += static_cast<int64_t>(event->bytes.size());
    const auto decoder = Decoders().find(WithoutStation(event->channel));
    channel.known = decoder != Decoders().end();
    if (!channel.known) continue;
    const auto decoded = decoder->second(event->bytes);
    if (!decoded) {
      ++channel.undecodable;
      continue;
    }
    if (decoded->received_utime > 0)
      channel.ages_ms.push_back(static_cast<float>(event->utime - decoded->received_utime) / 1000);
    if (decoded->health) summary.health[decoded->health->station + "/" + decoded->health->service] = *decoded->health;
    if (decoded->sequence >= 0) {
      const auto [previous, fresh] = sequences.try_emplace(event->channel, decoded->sequence);
      // A smaller number is a camera service that was started again.
      if (!fresh && decoded->sequence > previous->second) channel.missing += decoded->sequence - previous->second - 1;
      previous->second = decoded->sequence;
    }
  }
  for (auto& [name, channel] : summary.channels) std::sort(channel.ages_ms.begin(), channel.ages_ms.end());
  summary.seconds = static_cast<double>(last - first) / 1e6;
  summary.complete = reader.complete();
  return summary;
}

std::vector<std::string> ProblemsOf(const LogSummary& summary, const std::vector<std::string>& required) {
  std::vector<std::string> problems;
  if (summary.events == 0) problems.push_back("the recording is empty");
  if (!summary.complete) problems.push_back("the file is cut off or damaged after its last event");
  for (const auto& [name, channel] : summary.channels) {
    if (channel.undecodable > 0) {
      problems.push_back(name + ": " + std::to_string(channel.undecodable) + " messages can't be decoded");
    }
  }
  for (const auto& name : required) {
    const bool found = std::any_of(summary.channels.begin(), summary.channels.end(),
                                   [&](const auto& entry) { return WithoutStation(entry.first) == name; });
    if (!found) problems.push_back(name + ": nothing was recorded");
  }
  return problems;
}

}  // namespace coach
