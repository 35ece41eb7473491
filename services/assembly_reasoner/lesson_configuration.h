// The `guidance` section of the station file: tasks, phrases and every constant of the reasoner and the policy.
#pragma once

#include <filesystem>
#include <vector>

#include "common/configuration/yaml_reader.h"
#include "services/assembly_reasoner/lesson.h"

namespace coach {

struct LessonConfiguration {
  LessonOptions options;
  std::vector<std::filesystem::path> tasks;  ///< further task files of the lesson, beside the station's `task`
  std::filesystem::path phrases;             ///< folder of phrase files; empty: the shipped ones
  std::filesystem::path event_log;           ///< JSON lines; empty: events.jsonl in the station's state folder
};

/// @param folder that paths in the section are relative to
/// @throws ConfigurationError
LessonConfiguration ReadLessonConfiguration(const YamlNode& section, const std::filesystem::path& folder);

/// Every *.yaml of a folder, by language. @throws ConfigurationError naming the file, or if there is none
std::map<std::string, PhraseBook> LoadPhraseBooks(const std::filesystem::path& folder);

/// The phrase files that came with this program: ../share/coach/phrases beside it, or deploy/phrases of the source tree
/// it was built in. @throws ConfigurationError if there are none
std::filesystem::path ShippedPhrases();

}  // namespace coach
