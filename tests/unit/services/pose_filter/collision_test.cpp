#include "services/pose_filter/collision.h"

#include <fcl/fcl.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/test_meshes.h"

namespace coach {
namespace {

using FclModel = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<FclModel> MakeModel(const TriangleMesh& mesh) {
  auto model = std::make_shared<FclModel>();
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  model->beginModel();
  model->addSubModel(mesh.vertices, triangles);
  model->endModel();
  return model;
}

bool FclCollide(const std::shared_ptr<FclModel>& a, const Pose& X_A, const std::shared_ptr<FclModel>& b,
                const Pose& X_B) {
  const fcl::CollisionObjectd object_a(a, X_A), object_b(b, X_B);
  fcl::CollisionResultd result;
  return fcl::collide(&object_a, &object_b, fcl::CollisionRequestd(), result) > 0;
}

Pose RandomPose(std::mt19937_64& generator, double spread) {
  std::normal_distribution<double> n;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(n(generator), n(generator), n(generator), n(generator)).normalized().matrix();
  pose.translation() << spread * n(generator), spread * n(generator), spread * n(generator);
  return pose;
}

// FCL tests triangles exactly. What overlaps by 4 mm in solids must be found; what FCL keeps apart must not.
TEST(Collision, AgreesWithFclOnBoxes) {
  const Vector3 size(0.12, 0.03, 0.03), shrink = Vector3::Constant(0.004);
  const CollisionShape shape(BoxMesh(size));
  const auto whole = MakeModel(BoxMesh(size)), core = MakeModel(BoxMesh(size - 2 * shrink));
  std::mt19937_64 generator(1);
  int apart = 0, overlapping = 0;
  for (int k = 0; k < 3000; ++k) {
    const Pose A = RandomPose(generator, 0.02), B = RandomPose(generator, 0.02);
    const bool ours = Overlap(shape, A, shape, B, 0.002);
    if (!FclCollide(whole, A, whole, B)) {
      EXPECT_FALSE(ours);
      ++apart;
    } else if (FclCollide(core, A, core, B)) {
      EXPECT_TRUE(ours);
      ++overlapping;
    }
  }
  EXPECT_GT(apart, 200);
  EXPECT_GT(overlapping, 200);
}

TEST(Collision, ConcavePartsPassThroughEachOthersHoles) {
  const CollisionShape ring(TorusMesh(0.05, 0.01, 60, 24)), stick(BoxMesh({0.02, 0.02, 0.2}));
  Pose through = Pose::Identity();
  EXPECT_FALSE(Overlap(ring, Pose::Identity(), stick, through, 0.002));
  through.translation().x() = 0.04;
  EXPECT_TRUE(Overlap(ring, Pose::Identity(), stick, through, 0.002));
}

TEST(Collision, OneInsideTheOther) {
  const CollisionShape large(BoxMesh({0.2, 0.2, 0.2})), small(BoxMesh({0.02, 0.02, 0.02}));
  EXPECT_TRUE(Overlap(large, Pose::Identity(), small, Pose::Identity(), 0.002));
  EXPECT_TRUE(Overlap(small, Pose::Identity(), large, Pose::Identity(), 0.002));
}

TEST(Collision, AllowedOverlap) {
  const CollisionShape box(BoxMesh({0.1, 0.04, 0.04}));
  for (const double overlap : {-0.001, 0.001, 0.0025, 0.004}) {
    Pose beside = Pose::Identity();
    beside.translation().y() = 0.04 - overlap;
    EXPECT_EQ(Overlap(box, Pose::Identity(), box, beside, 0.002), overlap > 0.002) << overlap;
    EXPECT_EQ(Overlap(box, Pose::Identity(), box, beside, 0.003), overlap > 0.003) << overlap;
  }
}

}  // namespace
}  // namespace coach
