// Numbers as text, the same in every locale, and back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace coach {

/// With so many digits behind the point; empty for what is not a number. Never "-0".
std::string Fixed(double value, int digits);
/// The whole text is a finite number in decimal notation, blanks around it aside.
std::optional<double> ParseNumber(std::string_view text);
/// 754.2 s -> "12:34"; with tenths "12:34.2".
std::string Clock(double seconds, bool tenths = false);
/// UTC of a time since 1970 as "2026-11-22 05:42"; empty for times before 2001, which are no dates but counted from a
/// recording's start.
std::string Date(int64_t utime);

}  // namespace coach
