#include "services/pose_filter/state_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace coach {
namespace {

using nlohmann::json;

Pose PoseFrom(const json& entry) {
  const auto values = entry.get<std::vector<double>>();
  if (values.size() != 12 || !std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
    throw std::invalid_argument("a pose has 12 numbers");
  const Matrix3 R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
  if (std::abs(R.determinant() - 1) > 1e-3) throw std::invalid_argument("no rotation");
  return MakePose(R, Vector3(values[9], values[10], values[11]));
}

json ToJson(const Pose& X) {
  std::vector<double> values;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) values.push_back(X.linear()(r, c));
  for (int r = 0; r < 3; ++r) values.push_back(X.translation()(r));
  return values;
}

}  // namespace

std::optional<FilterState> StateOf(const PartPoses& poses, const std::string& task_sha256) {
  FilterState state{task_sha256, {}};
  const Pose X_CT = poses.X_TC.inverse();
  for (const PartEstimate& part : poses.parts) {
    if (part.status == PartStatus::kAbsent) return std::nullopt;
    state.X_CP.push_back(X_CT * part.X_TP);
  }
  return state;
}

void WriteState(const std::filesystem::path& file, const FilterState& state) {
  json document{{"task", state.task_sha256}, {"X_CP", json::array()}};
  for (const Pose& X : state.X_CP) document["X_CP"].push_back(ToJson(X));
  const std::filesystem::path next = file.string() + ".new";
  std::ofstream out(next);
  out << document.dump(1) << '\n';
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(next, file, error);
  if (!out || error) throw std::runtime_error(file.string() + ": the state can't be written");
}

std::optional<FilterState> ReadState(const std::filesystem::path& file, const std::string& task_sha256,
                                     size_t num_parts) {
  std::ifstream in(file);
  if (!in) return std::nullopt;
  try {
    const json document = json::parse(in);
    FilterState state{document.at("task").get<std::string>(), {}};
    for (const json& entry : document.at("X_CP")) state.X_CP.push_back(PoseFrom(entry));
    if (state.task_sha256 == task_sha256 && state.X_CP.size() == num_parts) return state;
  } catch (const std::exception&) {
  }
  return std::nullopt;
}

}  // namespace coach
