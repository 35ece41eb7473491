#include "tools/log_diff/recording.h"

#include <lcm/eventlog.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>

namespace coach {
namespace {

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string Compare(const std::string& channel, const std::vector<std::vector<uint8_t>>& a,
                    const std::vector<std::vector<uint8_t>>& b) {
  const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (in_a == a.end() && in_b == b.end()) return "";
  const std::string where = channel + ": message " + std::to_string(in_a - a.begin());
  if (in_a == a.end() || in_b == b.end())
    return where + " is missing in one (" + std::to_string(a.size()) + " messages against " + std::to_string(b.size()) +
           ")";
  const auto byte = std::mismatch(in_a->begin(), in_a->end(), in_b->begin(), in_b->end()).first - in_a->begin();
  return where + " differs from byte " + std::to_string(byte) + " on (" + std::to_string(in_a->size()) +
         " bytes against " + std::to_string(in_b->size()) + ")";
}

}  // namespace

void ForEachMessage(const std::filesystem::path& file,
                    const std::function<void(const std::string& channel, std::span<const uint8_t> bytes,
                                             int64_t logged_utime)>& visit) {
  const std::unique_ptr<lcm_eventlog_t, void (*)(lcm_eventlog_t*)> log(lcm_eventlog_create(file.c_str(), "r"),
                                                                       lcm_eventlog_destroy);
  if (!log) throw std::runtime_error(file.string() + ": can't be opened");
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log.get())) {
    const std::unique_ptr<lcm_eventlog_event_t, void (*)(lcm_eventlog_event_t*)> owner(event, lcm_eventlog_free_event);
    visit(std::string(event->channel, static_cast<size_t>(event->channellen)),
          {static_cast<const uint8_t*>(event->data), static_cast<size_t>(event->datalen)}, event->timestamp);
  }
}

Recording ReadRecording(const std::filesystem::path& file) {
  Recording recording;
  ForEachMessage(file, [&](const std::string& channel, std::span<const uint8_t> bytes, int64_t) {
    recording[channel].emplace_back(bytes.begin(), bytes.end());
  });
  return recording;
}

std::vector<std::string> Differences(const Recording& a, const Recording& b) {
  std::set<std::string> channels;
  for (const Recording* recording : {&a, &b})
    for (const auto& [channel, messages] : *recording) channels.insert(channel);
  std::vector<std::string> differences;
  const auto messages = [](const Recording& recording, const std::string& channel) {
    const auto found = recording.find(channel);
    return found == recording.end() ? std::vector<std::vector<uint8_t>>() : found->second;
  };
  for (const std::string& channel : channels) {
    if (EndsWith(channel, "SERVICE_HEALTH")) continue;
    if (std::string line = Compare(channel, messages(a, channel), messages(b, channel)); !line.empty())
      differences.push_back(std::move(line));
  }
  return differences;
}

}  // namespace coach
