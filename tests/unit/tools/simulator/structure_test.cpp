#include "tools/simulator/structure.h"

#include <gmock/gmock.h>

#include "common/assembly/task_file.h"

namespace coach {
namespace {

using testing::ElementsAre;

TEST(StructureTest, RectangleCloses) {
  const Task task = LoadTask(COACH_SOURCE_DIR "/deploy/tasks/rectangle_long_medium.yaml");
  const Structure s = FinishedStructure(task);
  ASSERT_THAT(s.reached, ElementsAre(true, true, true, true));
  EXPECT_THAT(s.part, ElementsAre(0, 2, 1, 3));
  for (const int c : OwnConnections(task)) {
    const Connection& joint = task.connections[static_cast<size_t>(c)];
    const Pose X = s.X_slot[static_cast<size_t>(joint.slot_a)].inverse() * s.X_slot[static_cast<size_t>(joint.slot_b)];
    EXPECT_LT((X.translation() - joint.X_AB.translation()).norm(), 1e-6) << joint.name;
  }
}

TEST(StructureTest, SameJointsShareAClass) {
  const Task task = LoadTask(COACH_SOURCE_DIR "/deploy/tasks/rectangle_long_medium.yaml");
  const auto classes = JointClasses(task);
  ASSERT_EQ(classes.size(), task.connections.size() + task.mistakes.size());
  // All four corners are one joint, named from either side; the mirrored ones are another.
  for (size_t c = 0; c < 4; ++c) EXPECT_EQ(classes[c], "long-medium-0");
  for (size_t c = 4; c < 8; ++c) EXPECT_EQ(classes[c], "long-medium-1");
  for (size_t m = 0; m < task.mistakes.size(); ++m) EXPECT_NE(classes[8 + m], "long-medium-0") << task.mistakes[m].name;
}

TEST(StructureTest, EquivalentsOfAJointOfTwoHalfTurnParts) {
  const SymmetryGroup half = MakeSymmetryGroup({Eigen::Vector3d(-1, 1, -1).asDiagonal().toDenseMatrix()}, {});
  Matrix3 R;
  R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const auto all = Equivalents(half, MakePose(R, {0.075, 0.045, 0}), half);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_NEAR(std::abs(all[2].translation().x()), 0.075, 1e-9);
}

}  // namespace
}  // namespace coach
