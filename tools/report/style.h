// The page's style sheet.
#pragma once

namespace coach {

extern const char* const kStyleSheet;

}  // namespace coach
