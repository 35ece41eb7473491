// HTML to PDF by a browser that is installed.
#pragma once

#include <filesystem>

namespace coach {

/// Prints the page with a headless Chromium.
/// @throws std::runtime_error if there is none, it takes over a minute, or it makes no file
void PrintPdf(const std::filesystem::path& html, const std::filesystem::path& pdf);

}  // namespace coach
