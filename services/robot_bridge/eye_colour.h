// Colours of the eyes, by the colour words of task files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace coach {

struct EyeColour {
  uint8_t red = 255, green = 255, blue = 255;
  bool operator==(const EyeColour&) const = default;
};

/// The light for an English colour word ("blue", "dark green", "light-blue": the last known word counts); nothing for
/// an unknown one.
std::optional<EyeColour> EyeColourOf(std::string_view word);

/// "#rrggbb".
std::string HexOf(const EyeColour& colour);

}  // namespace coach
