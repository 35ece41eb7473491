#include "tools/operator/camera_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

#include "services/pose_filter/table_plane.h"

namespace coach {
namespace {

constexpr uint64_t kSeed = 1;

void MeasureLight(const cv::Mat& colour, CameraCheck& check) {
  std::array<int, 256> histogram{};
  int burnt = 0, pixels = 0;
  for (int y = 0; y < colour.rows; y += 2) {
    const auto* row = colour.ptr<cv::Vec3b>(y);
    for (int x = 0; x < colour.cols; x += 2) {
      const auto& [blue, green, red] = row[x].val;
      ++histogram[std::max({blue, green, red})];
      burnt += std::min({blue, green, red}) > 250;
      ++pixels;
    }
  }
  int below = 0, level = 0;
  while (level < 255 && (below += histogram[static_cast<size_t>(level)]) * 2 < pixels) ++level;
  check.brightness = level;
  check.burnt_share = static_cast<double>(burnt) / pixels;
}

void MeasureTable(const Frame& frame, CameraCheck& check) {
  Observation observation;
  observation.camera = frame.camera;
  observation.depth = frame.depth.ptr<uint16_t>();
  observation.metres_per_unit = frame.metres_per_unit;
  const auto fit = FindTable(observation, kSeed);
  if (!fit) return;
  check.table = fit->plane;
  check.table_share = static_cast<double>(fit->inliers) / fit->samples;
  check.residual = fit->residual;
  check.tilt = std::acos(std::clamp(-fit->plane.n.z(), -1.0, 1.0));
  check.distance = fit->plane.n.z() < -0.05 ? -fit->plane.d / fit->plane.n.z() : INFINITY;
}

}  // namespace

CameraCheck CheckCamera(const Frame& frame, const CameraLimits& limits) {
  CameraCheck check;
  const auto demand = [&](bool good, const char* problem) {
    if (!good) check.problems.emplace_back(problem);
  };
  const bool picture = frame.colour.type() == CV_8UC3 && !frame.colour.empty();
  const bool depth = frame.depth.type() == CV_16UC1 && !frame.depth.empty() && frame.depth.isContinuous() &&
                     frame.depth.cols == frame.camera.width && frame.depth.rows == frame.camera.height;
  demand(picture, "no_picture");
  if (picture) MeasureLight(frame.colour, check);
  if (depth) check.depth_share = cv::countNonZero(frame.depth) / static_cast<double>(frame.depth.total());
  demand(check.depth_share >= limits.least_depth, "no_depth");
  if (picture) {
    demand(check.brightness >= limits.darkest, "dark");
    demand(check.brightness <= limits.brightest && check.burnt_share <= limits.burnt_share, "bright");
  }
  if (!depth) return check;
  MeasureTable(frame, check);
  demand(check.table.has_value(), "no_table");
  if (!check.table) return check;
  demand(check.residual <= limits.largest_residual, "uneven");
  demand(check.distance >= limits.nearest, "near");
  demand(check.distance <= limits.farthest, "far");
  demand(check.tilt <= limits.steepest, "flat");
  return check;
}

}  // namespace coach
