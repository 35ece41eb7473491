#include "services/pose_filter/paper_filter.h"

#include <gtest/gtest.h>

#include "services/detector/hsv_detector.h"
#include "tests/support/test_scene.h"

namespace coach {
namespace {

/// Feeds drawn pictures to a filter.
class Session {
 public:
  Session(const Task& task, const PaperFilterOptions& options, uint64_t seed)
      : task_(task), detector_(task), filter_(task, options, seed) {}

  PartPoses Step(const TestPicture& picture, double dt = 1 / 30.0) {
    utime_ += static_cast<int64_t>(dt * 1e6);
    const Detections detections = detector_.Detect(picture.colour, picture.depth, 0.001);
    FilterInput input;
    input.utime = utime_;
    input.camera = picture.camera;
    input.depth = picture.depth;
    input.colour = picture.colour;
    input.detections = &detections;
    return filter_.Step(input);
  }
  PaperFilter& filter() { return filter_; }
  int64_t utime() const { return utime_; }

 private:
  Task task_;
  HsvDetector detector_;
  PaperFilter filter_;
  int64_t utime_ = 1000;
};

PaperFilterOptions Small() {
  PaperFilterOptions options;
  options.particles = 100;
  return options;
}

Task LAndBrick() {
  return TestTask({TestType("l", LMesh(), true, 1), TestType("brick", BoxMesh({0.09, 0.03, 0.03}), false, 1)});
}

double PositionError(const PartPoses& poses, size_t part, const Pose& X_CP) {
  return ((poses.X_TC.inverse() * poses.parts[part].X_TP).translation() - X_CP.translation()).norm();
}

TEST(PaperFilter, FindsAndFollows) {
  const Task task = LAndBrick();
  Session session(task, Small(), 1);
  PartPoses out;
  Pose l, brick;
  for (int k = 0; k < 30; ++k) {
    l = OnTable(-0.1 + 0.004 * k, 0, 0.3 + 0.01 * k);  // 12 cm/s
    brick = OnTable(0.12, -0.1, 1);
    out = session.Step(DrawScene(task, {l, brick}, static_cast<uint64_t>(k)));
    ASSERT_EQ(out.parts.size(), 2u);
  }
  EXPECT_LT(PositionError(out, 0, l), 0.012);
  EXPECT_LT(PositionError(out, 1, brick), 0.012);
  for (const PartEstimate& part : out.parts) {
    EXPECT_EQ(part.status, PartStatus::kTracked);
    EXPECT_GT(part.visible_fraction, 0.6);
    EXPECT_GT(part.confidence, 0.5);
    EXPECT_TRUE(part.covariance.allFinite());
    EXPECT_GT(Eigen::LLT<Matrix6>(part.covariance + 1e-12 * Matrix6::Identity()).matrixL().toDenseMatrix()(0, 0), 0);
  }
  EXPECT_TRUE(out.table_found);
  // The table frame: parts lie on it.
  EXPECT_NEAR(out.parts[1].X_TP.translation().z(), 0.015, 0.01);
}

TEST(PaperFilter, SameSeedSameBits) {
  const Task task = LAndBrick();
  Session a(task, Small(), 7), b(task, Small(), 7), c(task, Small(), 8);
  bool different = false;
  for (int k = 0; k < 5; ++k) {
    const TestPicture picture =
        DrawScene(task, {OnTable(0.01 * k, 0, 0), OnTable(0.15, 0.1, 1)}, static_cast<uint64_t>(k));
    const PartPoses x = a.Step(picture), y = b.Step(picture), z = c.Step(picture);
    for (size_t p = 0; p < 2; ++p) {
      EXPECT_TRUE(x.parts[p].X_TP.matrix() == y.parts[p].X_TP.matrix());
      different |= !(x.parts[p].X_TP.matrix() == z.parts[p].X_TP.matrix());
    }
  }
  EXPECT_TRUE(different);
  // After a reset the session begins anew.
  a.filter().Reset();
  b.filter().Reset();
  const TestPicture picture = DrawScene(task, {OnTable(0, 0, 0), OnTable(0.15, 0.1, 1)}, 1);
  EXPECT_TRUE(a.Step(picture).parts[0].X_TP.matrix() == b.Step(picture).parts[0].X_TP.matrix());
}

// Each defect of tracking.md's paper mode is there to be measured against: hidden parts are pulled to the camera.
TEST(PaperFilter, StatusTellsHiddenFromLost) {
  const Task task = LAndBrick();
  Session session(task, Small(), 2);
  const std::vector<Pose> truth{OnTable(-0.15, 0, 0.3), OnTable(0.15, -0.05, 1)};
  for (int k = 0; k < 5; ++k) session.Step(DrawScene(task, truth, static_cast<uint64_t>(k)));
  const PartPoses hidden = session.Step(DrawScene(task, truth, 9, 1, 0, 320));
  EXPECT_EQ(hidden.parts[0].status, PartStatus::kOccluded);
  EXPECT_EQ(hidden.parts[1].status, PartStatus::kTracked);
  EXPECT_LT(hidden.parts[0].visible_fraction, 0.15);
}

TEST(PaperFilter, SuggestedPosesMustWinOnTheImage) {
  const Task task = LAndBrick();
  const std::vector<Pose> truth{OnTable(-0.15, 0, 0.3), OnTable(0.15, -0.05, 1)};
  PaperFilterOptions options = Small();
  options.initialisation.candidates = 0;  // nothing is found but what is suggested
  Session session(task, options, 3);
  session.filter().Suggest({truth[0], OnTable(0.3, 0.2, 0)});
  const PartPoses out = session.Step(DrawScene(task, truth, 1));
  EXPECT_LT(PositionError(out, 0, truth[0]), 0.01);
  EXPECT_EQ(out.parts[1].status, PartStatus::kAbsent);
}

TEST(PaperFilter, AbsentPartIsFoundWhenItAppears) {
  const Task task = LAndBrick();
  Session session(task, Small(), 4);
  const Pose l = OnTable(-0.1, 0, 0.3), brick = OnTable(0.12, -0.1, 1);
  for (int k = 0; k < 3; ++k) {
    const PartPoses out = session.Step(DrawScene(task, {l}, static_cast<uint64_t>(k)));
    EXPECT_EQ(out.parts[0].status, PartStatus::kTracked);
    EXPECT_EQ(out.parts[1].status, PartStatus::kAbsent);
  }
  PartPoses out;
  for (int k = 0; k < 20; ++k) out = session.Step(DrawScene(task, {l, brick}, static_cast<uint64_t>(k)));
  EXPECT_EQ(out.parts[1].status, PartStatus::kTracked);
  EXPECT_LT(PositionError(out, 1, brick), 0.012);
}

TEST(PaperFilter, ConnectedPartsMoveAsOne) {
  Task task = LAndBrick();
  task.slots = {{"left", 0}, {"right", 1}};
  const Pose X_AB = MakePose(Matrix3::Identity(), {0.105, 0, 0});
  Connection connection;
  connection.slot_a = 0;
  connection.slot_b = 1;
  connection.X_AB = X_AB;
  task.connections = {connection};
  Session session(task, Small(), 5);
  PartPoses out;
  Pose l;
  for (int k = 0; k < 25; ++k) {
    l = OnTable(-0.1 + 0.003 * k, 0, 0.3);
    if (k == 0) session.filter().Suggest({l, l * X_AB});
    out = session.Step(DrawScene(task, {l, l * X_AB}, static_cast<uint64_t>(k)));
  }
  const Pose X_AB_found = out.parts[0].X_TP.inverse() * out.parts[1].X_TP;
  EXPECT_LT((X_AB_found.translation() - X_AB.translation()).norm(), 0.008);
  EXPECT_LT(PositionError(out, 0, l), 0.012);
}

TEST(PaperFilter, BadInputIsSurvived) {
  const Task task = LAndBrick();
  Session session(task, Small(), 6);
  const std::vector<Pose> truth{OnTable(-0.1, 0, 0.3), OnTable(0.12, -0.1, 1)};
  const TestPicture good = DrawScene(task, truth, 1);
  const auto finite = [](const PartPoses& out) {
    ASSERT_EQ(out.parts.size(), 2u);
    for (const PartEstimate& part : out.parts) {
      EXPECT_TRUE(part.X_TP.matrix().allFinite());
      EXPECT_TRUE(part.covariance.allFinite());
    }
  };
  TestPicture bad = good;
  bad.depth = cv::Mat();  // colour only
  finite(session.Step(bad));
  bad.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(0));  // depth all zero
  finite(session.Step(bad));
  finite(session.Step(good));
  bad = good;
  bad.colour = cv::Mat();  // depth only
  finite(session.Step(bad));
  bad = good;
  bad.depth = cv::Mat(240, 320, CV_16UC1, cv::Scalar(800));  // another size
  finite(session.Step(bad));
  bad = good;
  bad.camera.fx = std::nan("");
  finite(session.Step(bad));
  bad.camera = {};
  finite(session.Step(bad));
  bad = good;
  bad.camera.fx = bad.camera.fy = 300;  // intrinsics that don't match the image
  finite(session.Step(bad));
  finite(session.Step(good, -5));  // time runs backwards
  finite(session.Step(good, 0));
  finite(session.Step(good, 3600));
  FilterInput nothing;
  finite(session.filter().Step(nothing));
  session.filter().Suggest({});
  session.filter().Suggest(std::vector<Pose>(9, Pose(Eigen::Matrix4d::Constant(std::nan("")))));
  finite(session.Step(good));
}

TEST(PaperFilter, DepthOnlyKeepsTracking) {
  const Task task = LAndBrick();
  Session session(task, Small(), 8);
  const std::vector<Pose> truth{OnTable(-0.1, 0, 0.3), OnTable(0.12, -0.1, 1)};
  session.Step(DrawScene(task, truth, 1));
  PartPoses out;
  for (int k = 0; k < 10; ++k) {
    TestPicture picture = DrawScene(task, truth, static_cast<uint64_t>(k));
    picture.colour = cv::Mat();
    out = session.Step(picture);
  }
  EXPECT_LT(PositionError(out, 0, truth[0]), 0.012);
  EXPECT_LT(PositionError(out, 1, truth[1]), 0.012);
}

TEST(PaperFilter, AnyMesh) {
  // Inside out, with a hole, and of thousands of triangles.
  TriangleMesh turned = LMesh(), open = BoxMesh({0.09, 0.03, 0.03}), dense = TorusMesh(0.03, 0.012, 80, 40);
  for (auto& t : turned.triangles) std::swap(t[0], t[1]);
  open.triangles.pop_back();
  const Task task = TestTask(
      {TestType("turned", turned, true, 1), TestType("open", open, false, 1), TestType("dense", dense, false, 1)});
  PaperFilterOptions options = Small();
  options.particles = 20;
  options.initialisation.candidates = 8;
  Session session(task, options, 9);
  const auto out =
      session.Step(DrawScene(task, {OnTable(-0.1, 0, 0.3), OnTable(0.12, -0.1, 1), OnTable(0.1, 0.1, 0)}, 1));
  for (const PartEstimate& part : out.parts) EXPECT_TRUE(part.X_TP.matrix().allFinite());
  PartType none;
  EXPECT_THROW(PaperFilter(TestTask({none}), options, 1), std::invalid_argument);
  EXPECT_NO_THROW(PaperFilter(Task{}, options, 1));
  options.particles = 0;
  EXPECT_THROW(PaperFilter(task, options, 1), std::invalid_argument);
}

}  // namespace
}  // namespace coach
