// Plane and clusters against per-pixel labels of real pictures: 0 invalid, 1-9 table, object = label / 10.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "services/pose_filter/initialisation.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

struct Score {
  double table = 0;    ///< share of the table's readings that lie on the plane
  double objects = 0;  ///< share of the objects' readings that don't
  int isolated = 0, isolated_found = 0;
  int touching = 0, touching_found = 0;
};

/// Objects with a neighbour of another label within a few pixels.
std::map<int, bool> Touching(const cv::Mat& labels) {
  std::map<int, bool> touching;
  for (int y = 0; y + 6 < labels.rows; y += 2) {
    for (int x = 0; x + 6 < labels.cols; x += 2) {
      const int object = labels.at<uint8_t>(y, x) / 10;
      if (object == 0) continue;
      touching.try_emplace(object, false);
      for (const int other : {labels.at<uint8_t>(y, x + 6) / 10, labels.at<uint8_t>(y + 6, x) / 10}) {
        if (other != 0 && other != object) touching[object] = touching[other] = true;
      }
    }
  }
  return touching;
}

Score Evaluate(const cv::Mat& depth, const cv::Mat& labels, double metres_per_unit, const CameraModel& camera) {
  Score score;
  const InitialisationOptions options;
  const SceneClusters found = FindClusters(depth, metres_per_unit, camera, 1, options);
  if (!found.table) return score;
  int table = 0, on_plane = 0, objects = 0, off_plane = 0;
  for (int y = 0; y < depth.rows; y += 4) {
    for (int x = 0; x < depth.cols; x += 4) {
      const int label = labels.at<uint8_t>(y, x);
      const double z = depth.at<uint16_t>(y, x) * metres_per_unit;
      if (label == 0 || z == 0) continue;
      const bool flat = std::abs(found.table->Height(camera.BackProject({x, y}, z))) < 0.015;
      ++(label < 10 ? table : objects);
      on_plane += label < 10 && flat;
      off_plane += label >= 10 && !flat;
    }
  }
  score.table = table > 0 ? static_cast<double>(on_plane) / table : 1;
  score.objects = objects > 0 ? static_cast<double>(off_plane) / objects : 1;
  // An object is found if one cluster holds half of its points and is to two thirds its own.
  std::map<int, int> points_of;
  std::map<std::pair<int, int>, int> overlap;
  std::vector<int> size(static_cast<size_t>(found.num_clusters));
  for (size_t i = 0; i < found.points.size(); ++i) {
    const int object = labels.at<uint8_t>(found.pixels[i].y(), found.pixels[i].x()) / 10;
    if (object > 0) ++points_of[object];
    if (found.cluster[i] < 0) continue;
    ++size[static_cast<size_t>(found.cluster[i])];
    ++overlap[{object, found.cluster[i]}];
  }
  const auto touching = Touching(labels);
  for (const auto& [object, points] : points_of) {
    if (points < 100) continue;
    bool matched = false;
    for (int c = 0; c < found.num_clusters; ++c) {
      const int common = overlap.count({object, c}) ? overlap[{object, c}] : 0;
      matched |= 2 * common >= points && 3 * common >= 2 * size[static_cast<size_t>(c)];
    }
    const bool touches = touching.count(object) && touching.at(object);
    ++(touches ? score.touching : score.isolated);
    (touches ? score.touching_found : score.isolated_found) += matched;
  }
  return score;
}

TEST(Tabletop, PlaneAndClustersAgreeWithTheLabels) {
  const fs::path scene = fs::path(COACH_SOURCE_DIR) / "../shared/scenes/real_tabletop";
  if (!fs::exists(scene / "depth")) GTEST_SKIP() << "no recording at " << scene;
  CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 525;
  camera.cx = 319.5;
  camera.cy = 239.5;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(scene / "depth")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Score sum;
  int pictures = 0;
  for (size_t i = 0; i < files.size(); i += 3) {
    const cv::Mat depth = cv::imread(files[i], cv::IMREAD_UNCHANGED);
    const cv::Mat labels = cv::imread(scene / "mask_label" / files[i].filename(), cv::IMREAD_UNCHANGED);
    ASSERT_FALSE(depth.empty() || labels.empty()) << files[i];
    ASSERT_EQ(labels.type(), CV_8UC1);
    const Score s = Evaluate(depth, labels, 0.001, camera);
    sum.table += s.table;
    sum.objects += s.objects;
    sum.isolated += s.isolated;
    sum.isolated_found += s.isolated_found;
    sum.touching += s.touching;
    sum.touching_found += s.touching_found;
    ++pictures;
  }
  sum.table /= pictures;
  sum.objects /= pictures;
  std::cout << pictures << " pictures: table on the plane " << sum.table << ", objects off it " << sum.objects
            << ", isolated objects found " << sum.isolated_found << " of " << sum.isolated << ", touching "
            << sum.touching_found << " of " << sum.touching << '\n';
  EXPECT_GT(sum.table, 0.9);
  EXPECT_GT(sum.objects, 0.85);
  EXPECT_GT(sum.isolated_found, 0.7 * sum.isolated);
}

}  // namespace
}  // namespace coach
