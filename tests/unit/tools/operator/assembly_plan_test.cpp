#include "tools/operator/assembly_plan.h"

#include <gtest/gtest.h>

#include "common/assembly/task_file.h"

namespace coach {
namespace {

Task Rectangle() {
  return LoadTask(std::filesystem::path(COACH_SOURCE_DIR) / "deploy/tasks/rectangle_long_medium.yaml");
}

TEST(SlotPoses, EveryConnectionHoldsBetweenItsSlots) {
  const Task task = Rectangle();
  ASSERT_EQ(task.variants.size(), 2u) << "the rectangle and its mirror image";
  for (const auto& variant : task.variants) {
    const auto poses = SlotPoses(task, variant);
    ASSERT_EQ(poses.size(), task.slots.size());
    for (const int index : variant) {
      const auto& connection = task.connections[static_cast<size_t>(index)];
      const Pose& X_FA = poses[static_cast<size_t>(connection.slot_a)];
      const Pose& X_FB = poses[static_cast<size_t>(connection.slot_b)];
      // A ring closes up to the parts' symmetries, so only positions are compared.
      EXPECT_LT(((X_FA * connection.X_AB).translation() - X_FB.translation()).norm(), 1e-3) << connection.name;
    }
  }
}

TEST(PlanOf, ARectangleLiesFlatWithItsLongSideAcross) {
  const Task task = Rectangle();
  const AssemblyPlan plan = PlanOf(task, task.variants[0]);
  EXPECT_NEAR(plan.width, 180, 1) << "mm; the long brick";
  EXPECT_NEAR(plan.height, 120, 1) << "mm; the medium brick";
  ASSERT_EQ(plan.slots.size(), 4u);
  ASSERT_EQ(plan.joints.size(), 4u);
  // The four joints are in the four corners: 15 mm from both edges.
  for (const auto& [connection, p] : plan.joints) {
    EXPECT_NEAR(std::min<double>(p.x(), plan.width - p.x()), 15, 6);
    EXPECT_NEAR(std::min<double>(p.y(), plan.height - p.y()), 15, 6);
  }
  for (const auto& slot : plan.slots) {
    ASSERT_FALSE(slot.outlines.empty());
    for (const auto& p : slot.outlines[0]) {
      EXPECT_GE(p.x(), -1);
      EXPECT_LE(p.x(), plan.width + 1);
      EXPECT_GE(p.y(), -1);
      EXPECT_LE(p.y(), plan.height + 1);
    }
  }
}

TEST(PlanOf, SlotsThatNothingJoinsStandSideBySide) {
  const Task task = Rectangle();
  const auto poses = SlotPoses(task, {});
  for (size_t a = 0; a < poses.size(); ++a) {
    for (size_t b = a + 1; b < poses.size(); ++b) {
      EXPECT_GT((poses[a].translation() - poses[b].translation()).norm(), 0.03);
    }
  }
  EXPECT_EQ(PlanOf(task, {}).slots.size(), 4u);
}

TEST(PlanOf, ATaskThatIsOnlyTrackedHasNoPlan) {
  Task task = Rectangle();
  task.slots.clear();
  EXPECT_TRUE(PlanOf(task, {}).slots.empty());
}

}  // namespace
}  // namespace coach
