// Which files make a session.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/report/session.h"

namespace coach {

/// The whole file. @throws std::runtime_error naming it
std::string ReadFile(const std::filesystem::path& file);

struct SessionOptions {
  std::string station;                               ///< empty: the one with most messages
  std::vector<std::filesystem::path> annotations{};  ///< files beside those that are found
  std::string annotator;                             ///< whose events are the truth; empty: who noted most
  double annotation_offset = 0;  ///< s after the session's first frame at which the annotated video begins
};

/// A recording of the bus (*.lcm), an event log (*.jsonl), or a folder with recordings of one session that were split.
/// Annotations are found beside it: NAME.annotations.txt (ELAN), .csv (BORIS), .jsonl (the teacher's page) or .json (a
/// scene's events), NAME without extension; for a folder the file annotations.* inside.
/// @throws std::runtime_error naming a file that can't be read or is neither
Session ReadSession(const std::filesystem::path& path, const SessionOptions& options = {});

}  // namespace coach
