// The lesson's memory as JSON text and as a file that is either the old or the new one, whatever happens.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "services/assembly_reasoner/lesson.h"

namespace coach {

std::string ToJson(const LessonMemory& memory);
/// @throws std::invalid_argument saying what is wrong
LessonMemory LessonMemoryFromJson(const std::string& text);

/// One line a decision, without a line break: {"id":..,"utime":..,"kind":..,...}.
std::string ToJsonLine(const GuidanceEvent& event);

/// Writes beside the file, flushes to the disk, renames. @throws std::runtime_error naming the file
void WriteAtomically(const std::filesystem::path& file, const std::string& text);
/// Nothing if there is no such file.
std::optional<std::string> ReadText(const std::filesystem::path& file);

}  // namespace coach
