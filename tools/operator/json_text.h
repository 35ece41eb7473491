// Numbers and text of the JSON that the pages are sent.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace coach {

/// To one part in `scale`; 0 for what is not finite: JSON has no infinity.
double Rounded(double value, double scale);

/// Bytes that are no UTF-8 (names come from files) are replaced.
std::string Dump(const nlohmann::json& json);

}  // namespace coach
