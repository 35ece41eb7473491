// Text made safe to speak.
#pragma once

#include <string>
#include <string_view>

namespace coach {

/// Valid UTF-8 without what a speech engine takes for orders: `\` and `^` (NAO's tags), `<` and `>` (SSML), control
/// characters (they become one space); bytes that are no UTF-8 vanish. Spaces at both ends are cut.
std::string CleanText(std::string_view text);

/// How long the text takes to say, about, s: 14 characters a second and half a second around.
double SpeakingTime(std::string_view utf8);

}  // namespace coach
