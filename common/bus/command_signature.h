// The signature of commands on a robot bus that leaves the host: HMAC-SHA256 of the whole command with the station's
// key, cut to 16 bytes. It covers sent_utime and valid_for_us, so every repeat is signed anew.
#pragma once

#include <coach/robot_command_t.hpp>
#include <filesystem>
#include <string>

namespace coach {

/// The station's key; empty for an empty path (no signature).
/// @throws ConfigurationError if the file can't be read or holds less than 16 bytes.
std::string ReadKey(const std::filesystem::path& file);

void Sign(robot_command_t& command, const std::string& key);
bool SignatureFits(const robot_command_t& command, const std::string& key);

}  // namespace coach
