#include "services/pose_filter/connection_constraint.h"

#include <gtest/gtest.h>

#include "tests/support/test_meshes.h"

namespace coach {
namespace {

Pose At(double x, double y, double z, double angle = 0) { return MakePose(ExpRotation({0, 0, angle}), {x, y, z}); }

/// A frame of two long and two medium bricks; the long one is symmetric about y.
Task Frame() {
  Task task;
  task.types.resize(2);
  task.types[0].symmetries = MakeSymmetryGroup({ExpRotation({0, M_PI, 0})}, {});
  task.parts = {{"long_1", 0}, {"long_2", 0}, {"medium_1", 1}, {"medium_2", 1}};
  task.slots = {{"left", 0}, {"front", 1}, {"right", 0}, {"back", 1}};
  Connection c;
  c.slot_a = 0;
  c.slot_b = 1;
  c.X_AB = At(0.075, 0.045, 0, M_PI / 2);
  task.connections = {c};
  return task;
}

TEST(FindLinks, ProbabilityIsThePapers) {
  const Task task = Frame();
  const Pose A = At(0.1, 0.2, 0.9, 0.4);
  for (const auto& [error, expected] : {std::pair{0.0, 1.0}, {0.039, 1.0}, {0.06, 0.5}, {0.081, 0.0}}) {
    std::vector<Pose> poses(4, At(5, 5, 5));
    poses[0] = A;
    poses[2] = A * At(0.075, 0.045, 0) * At(error, 0, 0, M_PI / 2);
    const auto links = FindLinks(task, poses, {true, false, true, false});
    if (expected == 0) {
      EXPECT_TRUE(links.empty());
      continue;
    }
    ASSERT_EQ(links.size(), 1u);
    EXPECT_EQ(links[0].part_a, 0);
    EXPECT_EQ(links[0].part_b, 2);
    EXPECT_NEAR(links[0].probability, expected, 1e-9);
    EXPECT_TRUE(links[0].X_AB.isApprox(task.connections[0].X_AB, 1e-9));
  }
}

TEST(FindLinks, TakesTheNearestSymmetricPose) {
  const Task task = Frame();
  const Pose flip(Eigen::AngleAxisd(M_PI, Vector3::UnitY()));
  std::vector<Pose> poses(4, At(5, 5, 5));
  poses[1] = flip;  // as At(0, 0, 0), seen with the symmetric orientation
  poses[3] = task.connections[0].X_AB * At(0.005, 0, 0, 0.05);
  const auto links = FindLinks(task, poses, {false, true, false, true});
  ASSERT_EQ(links.size(), 1u);
  EXPECT_TRUE(links[0].X_AB.isApprox(flip.inverse() * task.connections[0].X_AB, 1e-9));
}

TEST(FindLinks, BeliefWithNonsenseIsIgnored) {
  const Task task = Frame();
  const std::vector<Pose> poses(4, At(0, 0, 1));
  ConnectionBelief belief;
  belief.connections = {{0, 0, 2, 0.8}, {7, 0, 2, 1}, {-5, 0, 2, 1},          {0, -1, 2, 1},
                        {0, 0, 99, 1},  {0, 1, 1, 1}, {0, 1, 3, std::nan("")}};
  const auto links = FindLinks(task, poses, {true, true, true, true}, belief);
  ASSERT_EQ(links.size(), 1u);
  EXPECT_EQ(links[0].probability, 0.8);
}

TEST(RigidBodies, RingIsOneBody) {
  std::vector<RigidLink> links{
      {0, 2, At(1, 0, 0), 1}, {2, 3, At(0, 1, 0), 0.9}, {1, 3, At(0, 0, 1), 0.8}, {0, 1, At(9, 9, 9), 0.7}};
  const RigidBodies whole(5, links, 4), pair(5, links, 1), none(5, links, 0);
  EXPECT_TRUE(whole.Leads(0) && whole.Leads(4));
  EXPECT_FALSE(whole.Leads(1) || whole.Leads(2) || whole.Leads(3));
  EXPECT_EQ(whole.FollowersOf(0).size(), 3u);
  EXPECT_TRUE(whole.FollowersOf(4).empty());
  EXPECT_EQ(pair.FollowersOf(0).size(), 1u);
  EXPECT_TRUE(pair.Leads(1) && pair.Leads(3));
  for (int p = 0; p < 5; ++p) EXPECT_TRUE(none.Leads(p));
  // Placing followers in order keeps every link that was used.
  std::vector<Pose> pose(5, Pose::Identity());
  const RigidBodies three(5, links, 3);
  for (const auto& f : three.FollowersOf(0)) pose[f.part] = pose[f.leader] * f.X_LF;
  EXPECT_TRUE((pose[0].inverse() * pose[2]).isApprox(links[0].X_AB));
  EXPECT_TRUE((pose[2].inverse() * pose[3]).isApprox(links[1].X_AB));
  EXPECT_TRUE((pose[1].inverse() * pose[3]).isApprox(links[2].X_AB));
}

TEST(NumEnforced, EachLinkOnItsShareCapped) {
  const std::vector<RigidLink> links{{0, 1, {}, 1}, {1, 2, {}, 0.5}, {2, 3, {}, 0.1}};
  const int n = 1000;
  int enforced[3] = {};
  for (int i = 0; i < n; ++i) {
    const size_t count = NumEnforced(links, (i + 0.5) / n);
    for (size_t l = 0; l < count; ++l) ++enforced[l];
  }
  EXPECT_EQ(enforced[0], 600);
  EXPECT_EQ(enforced[1], 500);
  EXPECT_EQ(enforced[2], 100);
}

}  // namespace
}  // namespace coach
