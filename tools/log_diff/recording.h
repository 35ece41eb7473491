// Recordings of the bus (LCM logs) as sequences of payloads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace coach {

/// Calls `visit` for every message in order. @param logged_utime us since 1970, when it was recorded
/// @throws std::runtime_error naming the file if it can't be opened.
void ForEachMessage(
    const std::filesystem::path& file,
    const std::function<void(const std::string& channel, std::span<const uint8_t> bytes, int64_t logged_utime)>& visit);

/// Payloads of every channel, in order.
using Recording = std::map<std::string, std::vector<std::vector<uint8_t>>>;
Recording ReadRecording(const std::filesystem::path& file);

/// How two recordings differ: one line a channel, empty if they are identical. Identical means the same sequence of
/// payloads on every channel but SERVICE_HEALTH (of any station); when they were recorded does not count.
std::vector<std::string> Differences(const Recording& a, const Recording& b);

}  // namespace coach
