#include "services/pose_filter/part_model.h"

#include <gtest/gtest.h>

#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

PartModel BoxModel(const Vector3& size, const std::vector<Matrix3>& symmetries = {}) {
  PartType type = TestType("box", BoxMesh(size), true, 1);
  type.symmetries = MakeSymmetryGroup(symmetries, {});
  return MakePartModel(type);
}

TEST(PartModel, ABoxHasTwelveEdgesAndItsHalfLengths) {
  const PartModel model = BoxModel({0.12, 0.05, 0.03});
  EXPECT_EQ(model.edges.size(), 12u) << "no diagonal of a face";
  for (const ModelEdge& e : model.edges) {
    EXPECT_NE(e.face_1, e.face_2) << "a closed mesh has no boundary";
    EXPECT_LT(std::abs(model.normals[static_cast<size_t>(e.face_1)].dot(model.normals[static_cast<size_t>(e.face_2)])),
              1e-9);
  }
  EXPECT_NEAR(model.principal_half.x(), 0.06, 0.002);
  EXPECT_NEAR(model.principal_half.y(), 0.025, 0.002);
  EXPECT_NEAR(model.principal_half.z(), 0.015, 0.002);
  EXPECT_NEAR(model.principal_axes.determinant(), 1, 1e-9);
  EXPECT_NEAR(std::abs(model.principal_axes(0, 0)), 1, 0.01);
}

// Turns of a box onto itself: the identity and three half turns; with a square section eight; a cube's twenty-four. All
// but the identity and what is declared a symmetry are near symmetries.
TEST(PartModel, NearSymmetriesOfBoxes) {
  const Matrix3 half_z = ExpRotation({0, 0, std::numbers::pi});
  EXPECT_EQ(BoxModel({0.12, 0.05, 0.03}).near_symmetries.size(), 3u);
  EXPECT_EQ(BoxModel({0.12, 0.05, 0.03}, {half_z}).near_symmetries.size(), 1u);
  EXPECT_EQ(BoxModel({0.12, 0.03, 0.03}).near_symmetries.size(), 7u);
  EXPECT_EQ(BoxModel({0.05, 0.05, 0.05}).near_symmetries.size(), 23u);
  for (const PartModel& model : {BoxModel({0.12, 0.05, 0.03}), BoxModel({0.12, 0.03, 0.03})}) {
    for (const Pose& X : model.near_symmetries) {
      EXPECT_GT(RotationError(model.symmetries, X.linear(), Matrix3::Identity()), 0.2);
      EXPECT_NEAR(X.linear().determinant(), 1, 1e-9);
      // The box covers itself: corners come back within a few degrees of sampling error of the axes.
      const Vector3 half = (model.extent.high - model.extent.low) / 2;
      for (const Vector3& v : model.mesh.vertices) {
        const Vector3 turned = (X * v).cwiseAbs();
        EXPECT_LT((turned - half).cwiseAbs().maxCoeff(), 0.1 * half.norm());
      }
    }
  }
}

TEST(PartModel, RestingRotationsLieOnThreePointsOrMore) {
  for (const bool concave : {false, true}) {
    const PartModel model = concave ? MakePartModel(TestType("l", LMesh(), true, 1)) : BoxModel({0.12, 0.05, 0.03});
    ASSERT_GE(model.resting.size(), 16u);
    int on_largest = 0;
    for (const Matrix3& R : model.resting) {
      double lowest = 1e9;
      for (const Vector3& v : model.mesh.vertices) lowest = std::min(lowest, (R * v).z());
      std::vector<Vector3> touching;
      for (const Vector3& v : model.mesh.vertices) {
        if ((R * v).z() < lowest + 1e-6) touching.push_back(R * v);
      }
      ASSERT_GE(touching.size(), 3u);
      double area = 0;
      for (const Vector3& a : touching) {
        for (const Vector3& b : touching) area = std::max(area, (a - touching[0]).cross(b - touching[0]).norm());
      }
      EXPECT_GT(area, 1e-4) << "it rests on a face, not on an edge";
      on_largest += !concave && std::abs(R.row(2).z()) > 0.999;
    }
    EXPECT_EQ(on_largest, concave ? 0 : 32) << "16 turns on either of the large faces";
  }
}

TEST(PartModel, EveryRotationIsNearOneOfTheCover) {
  std::mt19937_64 generator(2);
  const SymmetryGroup half_turn = MakeSymmetryGroup({ExpRotation({0, std::numbers::pi, 0})}, {});
  const SymmetryGroup round = MakeSymmetryGroup({}, {Vector3::UnitZ()});
  for (const double step : {0.5, 0.8}) {
    for (const SymmetryGroup& group : {SymmetryGroup(), half_turn, round}) {
      const std::vector<Matrix3> cover = CoverOfRotations(step, group);
      double worst = 0;
      for (int k = 0; k < 2000; ++k) {
        const Matrix3 R = RandomRotation(generator);
        double nearest = 10;
        for (const Matrix3& S : cover) nearest = std::min(nearest, RotationError(group, R, S));
        worst = std::max(worst, nearest);
      }
      EXPECT_LT(worst, 1.05 * step) << cover.size();
      EXPECT_LT(static_cast<double>(cover.size()), 8 * std::numbers::pi * std::numbers::pi / std::pow(step, 3));
    }
  }
  // Half of the rotations are equivalent to the other half.
  EXPECT_LT(CoverOfRotations(0.5, half_turn).size(), 0.75 * static_cast<double>(CoverOfRotations(0.5, {}).size()));
}

TEST(PartModel, DecimationKeepsTheShape) {
  const double ring = 0.05, tube = 0.02;
  const PartModel model = MakePartModel(TestType("torus", TorusMesh(ring, tube, 100, 50), true, 1));
  EXPECT_LE(model.mesh.triangles.size(), 1500u);
  EXPECT_GE(model.mesh.triangles.size(), 1000u);
  int inwards = 0;
  for (const SurfacePoint& s : model.surface) {
    const double d = std::hypot(std::hypot(s.p.x(), s.p.y()) - ring, s.p.z()) - tube;
    EXPECT_LT(std::abs(d), 0.001);
    const Vector3 middle = ring * Vector3(s.p.x(), s.p.y(), 0).normalized();
    inwards += s.n.dot((s.p - middle).normalized()) < 0.8;
  }
  EXPECT_LE(inwards, 6) << "decimation may turn a triangle over, not more";
  EXPECT_EQ(model.surface.size(), 1200u);
}

}  // namespace
}  // namespace coach
