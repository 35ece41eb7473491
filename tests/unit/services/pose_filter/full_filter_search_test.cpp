// Parts that colour alone does not find, and parts that were joined and are taken apart.
#include <gtest/gtest.h>

#include "services/pose_filter/full_filter.h"
#include "tests/support/drawn_session.h"

namespace coach {
namespace {

Task OneL() { return TestTask({TestType("l", LMesh(), true, 1)}); }

/// Recolours the part's pixels in stripes of 8 px, of which `kept` of 4 keep their colour.
TestPicture Faded(TestPicture picture, int kept) {
  for (int y = 0; y < picture.colour.rows; ++y) {
    for (int x = 0; x < picture.colour.cols; ++x) {
      cv::Vec3b& c = picture.colour.at<cv::Vec3b>(y, x);
      if (c == kTestBlue && (x + y) / 8 % 4 >= kept) c = kTestTable;
    }
  }
  return picture;
}

TEST(FindOnTable, APartWhoseClassShowsOnHalfOfItIsFoundByDepth) {
  const Task task = OneL();
  const Pose truth = OnTable(0.05, -0.03, 0.7);
  DrawnSession session(task);
  PartPoses out;
  for (uint64_t k = 0; k < 10; ++k) out = session.Step(Faded(DrawScene(task, {truth}, k), 2));
  ASSERT_EQ(out.parts[0].status, PartStatus::kTracked);
  EXPECT_LT(PositionError(InCamera(out, 0), truth), 0.005);
  EXPECT_LT(AngleError(InCamera(out, 0), truth), 6 * kDegree);
}

TEST(FindOnTable, AThingWithoutThePartsColourIsNotThePart) {
  const Task task = OneL();
  DrawnSession session(task);
  for (uint64_t k = 0; k < 10; ++k) {
    const PartPoses out = session.Step(Faded(DrawScene(task, {OnTable(0.05, -0.03, 0.7)}, k), 0));
    EXPECT_EQ(out.parts[0].status, PartStatus::kAbsent) << k;
  }
}

/// A long and a short brick, end against side.
Task Joined() {
  Task task = TestTask({TestType("l", LMesh(), true, 1), TestType("brick", BoxMesh({0.09, 0.03, 0.03}), false, 1)});
  task.types[1].symmetries = BoxSymmetries();
  task.slots = {{"a", 0}, {"b", 1}};
  task.connections.resize(1);
  task.connections[0].name = "c";
  task.connections[0].slot_b = 1;
  task.connections[0].X_AB = MakePose(ExpRotation({0, 0, std::numbers::pi / 2}), {0.075, 0.02, 0});
  return task;
}

TEST(DropEmptyLinks, APartTakenAwayFromItsPartnerIsFollowed) {
  const Task task = Joined();
  FullFilter filter(task, {}, 1);
  const Pose l = OnTable(-0.05, 0, 0.2);
  ConnectionBelief belief;
  int64_t utime = 1000000;
  const auto step = [&](const Pose& brick, uint64_t seed) {
    const TestPicture picture = DrawScene(task, {l, brick}, seed);
    Detections detections;
    utime += 33333;
    detections.utime = utime;
    detections.width = 640, detections.height = 480;
    detections.num_classes = task.NumColourClasses();
    detections.class_map = DrawnClassMap(task, picture);
    FilterInput input;
    input.utime = utime;
    input.camera = picture.camera;
    input.depth = picture.depth;
    input.colour = picture.colour;
    input.detections = &detections;
    belief.utime = utime - 33333;
    belief.connections = {{0, 0, 1, 0.99}};  // whatever happens, the reasoner still believes in the joint
    input.belief = &belief;
    return filter.Step(input);
  };
  const Pose joined = l * task.connections[0].X_AB;
  PartPoses out;
  for (uint64_t k = 0; k < 15; ++k) out = step(joined, k);
  ASSERT_EQ(out.parts[1].status, PartStatus::kTracked);
  EXPECT_LT(PositionError(InCamera(out, 1), joined), 0.003);
  // Taken away at 30 cm/s to 15 cm from its place.
  for (int k = 1; k <= 15; ++k) {
    Pose brick = joined;
    brick.translation() += 0.01 * k * TestTable().linear().col(0);
    out = step(brick, 100 + static_cast<uint64_t>(k));
    if (k >= 5) {
      EXPECT_LT(PositionError(InCamera(out, 1), brick), 0.008) << k;
    }
    if (k == 15) {
      EXPECT_EQ(out.parts[1].status, PartStatus::kTracked);
      EXPECT_LT(PositionError(InCamera(out, 1), brick), 0.004);
    }
  }
  EXPECT_LT(PositionError(InCamera(out, 0), l), 0.003) << "its partner stays";
}

// A sleeve of the part's colour moves in where the part was taken away. Inside of it colour and depth fit anywhere, but
// there is no outline.
TEST(Recover, ALargeThingOfThePartsColourIsNotThePart) {
  const Task task = OneL();
  Task drawn = TestTask({task.types[0], TestType("sleeve", BoxMesh({0.30, 0.25, 0.03}), true, 1)});
  const Pose away = OnTable(0, 9, 0), before = OnTable(0.05, -0.03, 0.7), after = OnTable(-0.2, 0.15, 0.2);
  const Pose sleeve = OnTable(0.08, -0.03, 0.1);
  DrawnSession session(task);
  PartPoses out;
  uint64_t seed = 0;
  for (int k = 0; k < 15; ++k) out = session.Step(DrawScene(drawn, {before, away}, seed++));
  ASSERT_EQ(out.parts[0].status, PartStatus::kTracked);
  int mistaken = 0;
  for (int k = 0; k < 30; ++k) {
    out = session.Step(DrawScene(drawn, {away, sleeve}, seed++));
    mistaken += out.parts[0].status == PartStatus::kTracked;
  }
  EXPECT_LE(mistaken, 3) << "of 30 frames";
  int right = 0;
  for (int k = 0; k < 12; ++k) {
    out = session.Step(DrawScene(drawn, {after, sleeve}, seed++));
    right += out.parts[0].status == PartStatus::kTracked && PositionError(InCamera(out, 0), after) < 0.005;
  }
  EXPECT_GE(right, 6) << "0.2 s are enough";
}

TEST(ShareOfClass, CountsPixels) {
  std::vector<uint8_t> classes(16, 0);
  classes[0] = 1, classes[1] = 3, classes[2] = 2;
  Observation o;
  o.camera.width = o.camera.height = 4;
  o.class_map = classes.data();
  const std::vector<Eigen::Vector2i> row{{0, 0}, {1, 0}, {2, 0}, {3, 0}};
  EXPECT_EQ(ShareOfClass(row, o, 1), 0.5);
  EXPECT_EQ(ShareOfClass(row, o, 2), 0.5);
  EXPECT_EQ(ShareOfClass(row, o, 4), 0);
  EXPECT_EQ(ShareOfClass({}, o, 1), 0);
  o.class_map = nullptr;
  EXPECT_EQ(ShareOfClass(row, o, 1), 0) << "without colours nothing is of a class";
}

TEST(SampleStep, GivesSomeHundredSamplesHoweverNearThePartIs) {
  for (const Vector3& size : {Vector3(0.03, 0.03, 0.03), Vector3(0.12, 0.03, 0.03), Vector3(0.3, 0.2, 0.05)}) {
    const PartModel model = MakePartModel(TestType("box", BoxMesh(size), true, 1));
    int last = 1000;
    for (const double z : {0.3, 0.5, 0.8, 1.2, 2.0}) {
      const Pose X_CP = MakePose(Matrix3::Identity(), {0, 0, z});
      const int step = SampleStep(model, TestCamera(), X_CP, OwnerMap::kStep);
      EXPECT_EQ(step % OwnerMap::kStep, 0);
      EXPECT_GE(step, OwnerMap::kStep);
      EXPECT_LE(step, last) << "farther off, finer";
      last = step;
      DepthTile tile;
      RenderTile(model, TestCamera(), X_CP, step, 0, tile);
      // A step rounded down by nearly one unit gives at most four times the samples; the image cuts large ones.
      EXPECT_LE(tile.covered, 4 * 700) << size.transpose() << " at " << z;
      if (step > OwnerMap::kStep && z > 0.4) {
        EXPECT_GE(tile.covered, 400) << size.transpose() << " at " << z;
      }
    }
  }
}

}  // namespace
}  // namespace coach
