#include "services/pose_filter/rigid_body.h"

#include <gtest/gtest.h>

#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

/// A blue L and a green brick beside its long arm, 4 cm and a quarter turn away from it.
class RigidBodyTest : public ::testing::Test {
 protected:
  RigidBodyTest()
      : task_(TestTask({TestType("l", LMesh(), true, 1), TestType("brick", BoxMesh({0.09, 0.03, 0.03}), false, 1)})) {
    for (const PartType& type : task_.types) {
      models_.push_back(MakePartModel(type));
      points_.push_back(MakePointSet(models_.back(), 80));
    }
  }

  RigidMember Member(size_t type, const Pose& X_GP) const {
    return {&models_[type], &points_[type], static_cast<int>(type), static_cast<uint8_t>(1 << type), X_GP};
  }
  RigidBody Both() const { return {Member(0, Pose::Identity()), Member(1, kX_LB)}; }
  DrawnObservation Draw(const RigidBody& body, const Pose& X_CG) const {
    std::vector<Pose> poses(2, OnTable(0, 9, 0));
    for (const RigidMember& m : body) poses[static_cast<size_t>(m.part)] = X_CG * m.X_GP;
    return DrawnObservation(task_, DrawScene(task_, poses, 1));
  }

  const Pose kX_LB = MakePose(ExpRotation({0, 0, std::numbers::pi / 2}), {0.075, 0.02, 0});
  Task task_;
  std::vector<PartModel> models_;
  std::vector<PointSet> points_;
  RefinementScratch scratch_;
};

TEST_F(RigidBodyTest, AStepIsThatOfItsMembersMovedWithTheBody) {
  const RigidBody body = Both();
  const Pose truth = OnTable(-0.03, 0.02, 0.4);
  const DrawnObservation drawn = Draw(body, truth);
  const OwnerMap owners = NoOwners(drawn.picture.camera);
  Vector6 off;
  off << 0.002, -0.001, 0.002, 0.02, -0.01, 0.03;
  const Pose start = Perturb(truth, off);
  RefinementOptions options;
  options.iterations = 1;
  options.longest_step = 10;
  PoseEquations sum;
  double reach = 0;
  for (const RigidMember& m : body) {
    // How the member's pose follows the body's, by moving the body.
    Matrix6 A;
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 6; ++axis) {
      const Vector6 xi = kStep * Vector6::Unit(axis);
      A.col(axis) = Difference(Perturb(start, -xi) * m.X_GP, Perturb(start, xi) * m.X_GP) / (2 * kStep);
    }
    const Pose X_CP = start * m.X_GP;
    ASSERT_TRUE(FindEvidence(*m.model, drawn.View(), X_CP, options, scratch_));
    const PoseEquations e = Linearise(*m.model, drawn.View(), owners, m.part, m.class_bit, X_CP, 1,
                                      options.outline_bias, options, scratch_);
    EXPECT_GT(e.depth_used, 20);
    sum.information += A.transpose() * e.information * A;
    sum.gradient += A.transpose() * e.gradient;
    reach = std::max(reach, m.X_GP.translation().norm() + m.model->extent.diameter / 2);
  }
  const Vector6 expected = RefinementStep(sum, Vector6::Zero(), reach, options);
  EXPECT_GT(StepLength(expected, reach), 0.002);
  const Vector6 step = Difference(start, RefineBody(body, drawn.View(), owners, start, options, scratch_));
  EXPECT_LT((step - expected).norm(), 1e-5 * expected.norm());
}

TEST_F(RigidBodyTest, RefinementConverges) {
  for (const bool one : {false, true}) {
    const RigidBody body = one ? RigidBody{Member(0, Pose::Identity())} : Both();
    const Pose truth = OnTable(0.02, -0.03, 1.1);
    const DrawnObservation drawn = Draw(body, truth);
    Vector6 off;
    off << 0.004, 0.003, -0.003, 0.04, -0.04, 0.05;
    const Pose found =
        RefineBody(body, drawn.View(), NoOwners(drawn.picture.camera), Perturb(truth, off), {}, scratch_);
    EXPECT_LT(PositionError(found, truth), 0.0025) << one;
    EXPECT_LT(AngleError(found, truth), 2.5 * kDegree) << one;
  }
}

TEST_F(RigidBodyTest, WhatJumpedTenCentimetresAndThirtyDegreesIsFound) {
  for (const bool one : {false, true}) {
    const RigidBody body = one ? RigidBody{Member(0, Pose::Identity())} : Both();
    const Vector3 normal = TestTable().linear().col(2);
    for (const double way : {0.0, 2.1, 4.2}) {
      const Pose before = OnTable(0.02, -0.02, 0.3);
      const Pose after =
          OnTable(0.02 + 0.1 * std::cos(way), -0.02 + 0.1 * std::sin(way), 0.3 + (way > 3 ? -30 : 30) * kDegree);
      const DrawnObservation drawn = Draw(body, after);
      const auto found =
          SearchBody(body, drawn.View(), NoOwners(drawn.picture.camera), before, normal, 1.0 / 15, {}, scratch_);
      ASSERT_TRUE(found) << "one part: " << one << ", way " << way;
      EXPECT_LT(PositionError(*found, after), 0.003) << "one part: " << one << ", way " << way;
      EXPECT_LT(AngleError(*found, after), 3 * kDegree) << "one part: " << one << ", way " << way;
    }
  }
}

TEST_F(RigidBodyTest, NothingIsFoundWhereNothingIs) {
  const RigidBody body = Both();
  const DrawnObservation empty = Draw({}, Pose::Identity());
  const OwnerMap owners = NoOwners(empty.picture.camera);
  const Pose before = OnTable(0, 0, 0.3);
  const Vector3 normal = TestTable().linear().col(2);
  EXPECT_FALSE(SearchBody(body, empty.View(), owners, before, normal, 1.0 / 15, {}, scratch_));
  // Farther than a hand could take it.
  const DrawnObservation far = Draw(body, OnTable(0.3, 0.1, 0.3));
  EXPECT_FALSE(SearchBody(body, far.View(), owners, OnTable(-0.2, 0, 0.3), normal, 1.0 / 30, {}, scratch_));
}

}  // namespace
}  // namespace coach
