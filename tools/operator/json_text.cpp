#include "tools/operator/json_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace coach {

double Rounded(double value, double scale) { return std::isfinite(value) ? std::round(value * scale) / scale : 0; }

std::string Dump(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace coach
