#include "tools/task/learned_poses.h"

#include <algorithm>

namespace coach {
namespace {

Vector3 MedianPosition(const std::vector<Pose>& poses) {
  Vector3 median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& X : poses) values.push_back(X.translation()[axis]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[axis] = *middle;
  }
  return median;
}

/// The nearest nine tenths to the median position.
std::vector<Pose> WithoutOutliers(std::vector<Pose> poses) {
  const Vector3 median = MedianPosition(poses);
  std::stable_sort(poses.begin(), poses.end(), [&](const Pose& a, const Pose& b) {
    return (a.translation() - median).norm() < (b.translation() - median).norm();
  });
  poses.resize(std::max<size_t>(1, poses.size() * 9 / 10));
  return poses;
}

}  // namespace

Pose MeanPose(const std::vector<Pose>& all) {
  const auto poses = WithoutOutliers(all);
  Vector3 p = Vector3::Zero();
  Matrix3 R = Matrix3::Zero();
  for (const auto& X : poses) {
    p += X.translation();
    R += X.linear();
  }
  const auto n = static_cast<double>(poses.size());
  return MakePose(R / n, p / n);
}

void LearnedPoses::Add(const PartPoses& poses) {
  if (!recent_.empty() && poses.utime < recent_.back().utime) recent_.clear();
  recent_.push_back(poses);
  while (recent_.front().utime < poses.utime - options_.window_us) recent_.pop_front();
}

LearnedPoses::Result LearnedPoses::Mean(const Task& task) const {
  Result result;
  for (size_t k = 0; k < task.parts.size(); ++k) {
    std::vector<Pose> seen;
    const SymmetryGroup& symmetries = task.TypeOf(static_cast<int>(k)).symmetries;
    for (const auto& poses : recent_) {
      if (k >= poses.parts.size() || poses.parts[k].status != PartStatus::kTracked) continue;
      const Pose& X = poses.parts[k].X_TP;
      seen.push_back(seen.empty() ? X : NearestEquivalent(symmetries, X, seen.front()));
    }
    const std::string& name = task.parts[k].name;
    if (static_cast<int>(seen.size()) < options_.least_frames) {
      result.problems.push_back({"unseen", name});
      continue;
    }
    const Vector3 median = MedianPosition(seen);
    if ((WithoutOutliers(seen).back().translation() - median).norm() > options_.still) {
      result.problems.push_back({"moved", name});
      continue;
    }
    result.X_TP.push_back(MeanPose(seen));
  }
  return result;
}

TaskDraft DraftOfTable(const std::string& name, const Task& task, const std::vector<Pose>& X_TP) {
  TaskDraft draft;
  draft.name = name;
  for (const auto& type : task.types)
    draft.types.push_back({type.name, type.count, type.colour, type.mesh, type.symmetries, type.hsv});
  for (size_t k = 0; k < task.parts.size(); ++k)
    draft.parts.push_back({task.parts[k].name, task.parts[k].type, X_TP.at(k)});
  return draft;
}

}  // namespace coach
