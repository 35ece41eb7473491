#include "services/pose_filter/initialisation.h"

#include <gtest/gtest.h>

#include <set>

#include "services/detector/hsv_detector.h"
#include "tests/support/test_scene.h"

namespace coach {
namespace {

const double kDegree = std::numbers::pi / 180;

TEST(FindClusters, TableAndPartsApart) {
  const Task task =
      TestTask({TestType("l", LMesh(), true, 2), TestType("brick", BoxMesh({0.09, 0.03, 0.03}), false, 1)});
  const std::vector<Pose> truth{OnTable(-0.15, 0, 0.3), OnTable(0.15, 0.05, 1.2), OnTable(0, -0.12, 2)};
  const TestPicture picture = DrawScene(task, truth, 1);
  const InitialisationOptions options;
  const SceneClusters found = FindClusters(picture.depth, 0.001, picture.camera, 5, options);
  ASSERT_TRUE(found.table.has_value());
  const Vector3 normal = TestTable().linear().col(2);
  EXPECT_LT(std::acos(found.table->n.dot(normal)), 0.5 * kDegree);
  EXPECT_NEAR(found.table->Height(TestTable().translation()), 0, 0.002);
  std::set<int> of_parts;
  for (const Pose& pose : truth) {
    std::vector<int> votes(static_cast<size_t>(found.num_clusters));
    for (size_t i = 0; i < found.points.size(); ++i) {
      if (found.cluster[i] >= 0 && (found.points[i] - pose.translation()).norm() < 0.03) {
        ++votes[static_cast<size_t>(found.cluster[i])];
      }
    }
    of_parts.insert(static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin()));
  }
  EXPECT_EQ(of_parts.size(), 3u) << "each part is a cluster of its own";

  const SceneClusters again = FindClusters(picture.depth, 0.001, picture.camera, 5, options);
  EXPECT_EQ(again.cluster, found.cluster);
  EXPECT_EQ(again.table->n, found.table->n);
  EXPECT_EQ(again.table->d, found.table->d);
}

TEST(FindClusters, NothingToSee) {
  EXPECT_TRUE(FindClusters({}, 0.001, TestCamera(), 1, {}).points.empty());
  const cv::Mat blind(480, 640, CV_16UC1, cv::Scalar(0));
  const SceneClusters found = FindClusters(blind, 0.001, TestCamera(), 1, {});
  EXPECT_FALSE(found.table.has_value());
  EXPECT_EQ(found.num_clusters, 0);
}

TEST(FitPose, FindsTheParts) {
  const Task task = TestTask({TestType("l", LMesh(), true, 1)});
  HsvDetector detector(task);
  const RenderMesh mesh(task.types[0].mesh);
  const ObservationModel model({}, OcclusionForm::kPaper);
  int right = 0;
  const int starts = 8;
  for (int k = 0; k < starts; ++k) {
    const Pose truth = OnTable(0.05 * (k - 4), 0.03 * (k % 3), 0.8 * k);
    const TestPicture picture = DrawScene(task, {truth}, static_cast<uint64_t>(k));
    const Detections detections = detector.Detect(picture.colour, picture.depth, 0.001);
    ASSERT_EQ(detections.regions.size(), 1u);
    DepthEvidence evidence;
    model.Prepare(picture.depth, 0.001, SampledGrid(picture.camera, 4), evidence);
    const InitialisationOptions options;
    const SceneClusters clusters = FindClusters(picture.depth, 0.001, picture.camera, 1, options);
    const auto points = PointsOfRegion(clusters, detections, detections.regions[0], options);
    ASSERT_GT(points.size(), 100u);
    Random random(static_cast<uint64_t>(k)), same(static_cast<uint64_t>(k));
    const auto fit = FitPose(task.types[0].mesh, mesh, points, model, evidence, random, options);
    ASSERT_TRUE(fit.has_value());
    const Vector6 error = Difference(truth, fit->X_CP);
    right += error.head<3>().norm() < 0.01 && error.tail<3>().norm() < 12 * kDegree;
    const auto again = FitPose(task.types[0].mesh, mesh, points, model, evidence, same, options);
    EXPECT_TRUE(again->X_CP.matrix() == fit->X_CP.matrix()) << "repeatable to the bit";
  }
  EXPECT_GE(right, starts - 1) << "random rotations may miss";
}

TEST(FitPose, NothingThere) {
  const TriangleMesh mesh = BoxMesh({0.1, 0.03, 0.03});
  const ObservationModel model({}, OcclusionForm::kPaper);
  DepthEvidence evidence;
  model.Prepare(cv::Mat(480, 640, CV_16UC1, cv::Scalar(1500)), 0.001, SampledGrid(TestCamera(), 4), evidence);
  Random random(1);
  EXPECT_FALSE(FitPose(mesh, RenderMesh(mesh), {}, model, evidence, random, {}).has_value());
  // Points in the air where the image shows only the far background.
  const std::vector<Vector3> ghosts(50, Vector3(0, 0, 0.7));
  EXPECT_FALSE(FitPose(mesh, RenderMesh(mesh), ghosts, model, evidence, random, {}).has_value());
}

}  // namespace
}  // namespace coach
