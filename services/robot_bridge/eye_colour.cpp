#include "services/robot_bridge/eye_colour.h"

#include <array>
#include <cctype>
#include <cstdio>
#include <utility>

namespace coach {
namespace {

constexpr std::array<std::pair<std::string_view, EyeColour>, 15> kColours{{
    {"red", {230, 50, 45}},
    {"orange", {245, 140, 30}},
    {"yellow", {250, 210, 40}},
    {"green", {50, 175, 80}},
    {"blue", {45, 115, 230}},
    {"purple", {140, 80, 210}},
    {"violet", {140, 80, 210}},
    {"pink", {245, 130, 180}},
    {"brown", {160, 100, 60}},
    {"white", {255, 255, 255}},
    {"grey", {150, 155, 165}},
    {"gray", {150, 155, 165}},
    {"black", {70, 75, 85}},
    {"cyan", {40, 190, 210}},
    {"turquoise", {40, 190, 180}},
}};

}  // namespace

std::optional<EyeColour> EyeColourOf(std::string_view word) {
  std::optional<EyeColour> found;
  std::string part;
  const auto look_up = [&] {
    for (const auto& [name, colour] : kColours) {
      if (part == name) found = colour;
    }
    part.clear();
  };
  for (const char c : word) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      part += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else {
      look_up();
    }
  }
  look_up();
  return found;
}

std::string HexOf(const EyeColour& colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.red, colour.green, colour.blue);
  return text;
}

}  // namespace coach
