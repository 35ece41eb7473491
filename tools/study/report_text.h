// Figures as text in the reports of studies.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coach {

std::string Number(double x, int digits = 2);
/// "80.0 % (4/5, 38 to 96)": with its 95 % interval; "-" if n is 0.
std::string Share(int k, int n);
/// "1.20 (0.90 to 1.80)": median with its 95 % interval; "-" if there are none.
std::string Median(const std::vector<double>& values, int digits = 2);

/// @throws std::runtime_error naming the file if it can't be written.
void WriteText(const std::filesystem::path& file, const std::string& text);

}  // namespace coach
