// Changes single settings of a station file and leaves the rest of its text, comments too, as it is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coach {

struct Setting {
  std::vector<std::string> path;  ///< one or two keys: {"task"}, {"robot", "volume"}
  std::string value;              ///< YAML on one line, e.g. [0, 0.5, 0.08]
};

/// The text with these settings. Only their lines change; new ones go to the end of their section. A text that can't be
/// changed line by line (flow style, anchors) is written anew, without its comments.
/// @throws ConfigurationError if the text or a value is no YAML.
std::string WithSettings(const std::string& text, const std::vector<Setting>& settings);

/// The five versions before the present one are kept as FILE.1 (the newest) to FILE.5.
constexpr int kKeptVersions = 5;

/// Replaces a file in one step: after a crash or a full disk there is the old or the new one, never a half. The file's
/// rights stay. A file that has this text already is left alone.
/// @throws std::runtime_error naming the file and why it can't be written.
void ReplaceFile(const std::filesystem::path& file, const std::string& text);

}  // namespace coach
