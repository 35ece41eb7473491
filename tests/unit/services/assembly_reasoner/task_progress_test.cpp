#include "services/assembly_reasoner/task_progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/assembly/task_file.h"

namespace coach {
namespace {

using testing::ElementsAre;

const std::vector<int> kCorners{0, 1, 2, 3}, kMirrored{4, 5, 6, 7};

class TaskProgress : public testing::Test {
 protected:
  Task task_ = LoadTask(std::string(COACH_SOURCE_DIR) + "/deploy/tasks/rectangle_long_medium.yaml");
};

TEST_F(TaskProgress, AnyAssignmentOfEqualPartsCounts) {
  // Parts 0, 1 are long, 2, 3 medium; the ring may be any way round.
  for (const auto& [l, m] : {std::pair(0, 2), std::pair(1, 2), std::pair(0, 3), std::pair(1, 3)}) {
    const int other_l = 1 - l, other_m = 5 - m;
    const std::vector<MadeJoint> ring{
        {l, m, kCorners}, {other_l, m, kCorners}, {other_l, other_m, kCorners}, {l, other_m, kCorners}};
    for (size_t n = 0; n <= ring.size(); ++n) {
      const std::vector<MadeJoint> made(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(n));
      const Placement placement = Place(task_, made, {}, 0);
      EXPECT_EQ(std::count(placement.connection_of.begin(), placement.connection_of.end(), -1), 0) << l << m << n;
      EXPECT_EQ(ImpliedConnections(task_, placement).size(), n == 3 ? 1u : 0u);
      EXPECT_EQ(NextConnection(task_, placement, {}) >= 0, n < 4);
    }
  }
}

TEST_F(TaskProgress, TheMirroredRectangleIsAcceptedButNotMixed) {
  EXPECT_EQ(Place(task_, {{0, 2, kMirrored}}, {}, 0).variant, 1);
  const Placement mixed = Place(task_, {{0, 2, kCorners}, {1, 3, kMirrored}}, {0, -1}, 0);
  EXPECT_EQ(mixed.variant, 0);
  EXPECT_THAT(mixed.connection_of, ElementsAre(testing::Ge(0), -1));
}

TEST_F(TaskProgress, WhatIsPlacedStaysPlaced) {
  const Placement first = Place(task_, {{0, 2, kCorners}}, {2}, 0);
  EXPECT_THAT(first.connection_of, ElementsAre(2));
  EXPECT_EQ(first.part_in_slot[task_.connections[2].slot_a], 0);
}

TEST_F(TaskProgress, TheNextStepGrowsTheSubAssembly) {
  const Placement placement = Place(task_, {{0, 2, kCorners}}, {2}, 0);  // corner_3 is made: right and back
  EXPECT_EQ(task_.connections[NextConnection(task_, placement, {})].name, "corner_2");
  EXPECT_EQ(task_.connections[NextConnection(task_, Place(task_, {}, {}, 0), {})].name, "corner_1");
  EXPECT_EQ(NextConnection(task_, Place(task_, {}, {}, 0), {0, 1, 2, 3}), -1);
}

TEST_F(TaskProgress, PartsForAStepAreTheOnesAtHand) {
  const Placement placement = Place(task_, {{0, 2, kCorners}}, {0}, 0);
  EXPECT_EQ(PartsFor(task_, placement, 0, {}), std::pair(0, 2));
  EXPECT_EQ(PartsFor(task_, placement, 1, {}), std::pair(2, 1));
  EXPECT_EQ(PartsFor(task_, Place(task_, {}, {}, 0), 0, {true, false, false, false}).first, 1);
}

}  // namespace
}  // namespace coach
