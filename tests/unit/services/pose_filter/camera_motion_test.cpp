#include "services/pose_filter/camera_motion.h"

#include <gtest/gtest.h>

#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

/// Boxes of the room on the table; none of them is a part, so none has a colour class. Everything is printed with waves
/// of 3 to 5 cm, as furniture has grain.
class CameraMotionTest : public ::testing::Test {
 protected:
  DrawnObservation Draw(const Pose& X_CT, uint64_t seed, int left = 0, int right = 0, double occluder = 0.4) const {
    std::vector<Pose> X_CP;
    for (const Pose& X_TP : boxes_) X_CP.push_back(X_CT * X_TP);
    DrawnObservation drawn(task_, DrawScene(task_, X_CP, seed, 1, left, right, occluder, X_CT), X_CT);
    drawn.class_map.clear();
    const TestPicture exact = DrawScene(task_, X_CP, seed, 0, left, right, occluder, X_CT);
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        if (x >= left && x < right) continue;
        const Vector3 p =
            X_CT.inverse() * TestCamera().BackProject(Eigen::Vector2d(x, y), 1e-3 * exact.depth.at<uint16_t>(y, x));
        const double wave = std::sin(130 * p.x() + 90 * p.z()) + std::sin(150 * p.y() - 110 * p.z() + 60 * p.x());
        for (int c = 0; c < 3; ++c) {
          uint8_t& value = drawn.picture.colour.at<cv::Vec3b>(y, x)[c];
          value = static_cast<uint8_t>(std::clamp(value + 35 * wave, 0.0, 255.0));
        }
      }
    }
    return drawn;
  }
  void Start(CameraMotion& motion) const {
    const DrawnObservation first = Draw(TestTable(), 0);
    const auto table = FindTable(first.View(), 1);
    ASSERT_TRUE(table);
    motion.Start(first.View(), *table);
  }
  /// Where the camera is by the truth, in the table frame found in the first frame.
  static Pose Truth(const Pose& X_TC_first, const Pose& X_CT) { return X_TC_first * TestTable() * X_CT.inverse(); }

  Task task_ = TestTask(
      {TestType("box", BoxMesh({0.16, 0.12, 0.12}), true, 2), TestType("tall", BoxMesh({0.10, 0.08, 0.18}), false, 2)});
  std::vector<Pose> boxes_ = {
      MakePose(ExpRotation({0, 0, 0.4}), {-0.2, 0.05, 0.06}), MakePose(ExpRotation({0, 0, -0.5}), {0.2, 0.1, 0.06}),
      MakePose(ExpRotation({0, 0, 0.9}), {0.02, 0.2, 0.09}), MakePose(ExpRotation({0, 0, 0.1}), {0.1, -0.12, 0.09})};
  OwnerMap none_ = NoOwners(TestCamera());
};

TEST_F(CameraMotionTest, FollowsAMovingCamera) {
  CameraMotion motion;
  Start(motion);
  const Pose first = motion.X_TC();
  for (int k = 1; k <= 12; ++k) {
    Vector6 xi;
    xi << 0.004 * k, -0.002 * k, 0.003 * k, 0.3 * kDegree * k, 0.2 * kDegree * k, -0.4 * kDegree * k;
    const Pose X_CT = Perturb(TestTable(), xi);
    motion.Step(Draw(X_CT, static_cast<uint64_t>(k)).View(), none_);
    const Pose truth = Truth(first, X_CT);
    EXPECT_LT(PositionError(motion.X_TC(), truth), 0.001) << k;
    EXPECT_LT(AngleError(motion.X_TC(), truth), 0.1 * kDegree) << k;
    EXPECT_TRUE(motion.table_seen());
    EXPECT_TRUE(motion.covariance().allFinite());
  }
}

// Four boxes hold what the bare table leaves open: some 300 readings of 2 to 4 mm, on each side, 0.2 mm and, over the
// half metre between them, 0.03 degrees. Five of each.
TEST_F(CameraMotionTest, DepthAloneFollowsToo) {
  CameraMotion motion;
  Start(motion);
  const Pose first = motion.X_TC();
  for (int k = 1; k <= 6; ++k) {
    Vector6 xi;
    xi << 0.004 * k, -0.002 * k, 0.003 * k, 0.3 * kDegree * k, 0.2 * kDegree * k, -0.4 * kDegree * k;
    DrawnObservation drawn = Draw(Perturb(TestTable(), xi), static_cast<uint64_t>(k));
    drawn.picture.colour.release();
    motion.Step(drawn.View(), none_);
    const Pose truth = Truth(first, Perturb(TestTable(), xi));
    EXPECT_LT(PositionError(motion.X_TC(), truth), 0.0012) << k;
    EXPECT_LT(AngleError(motion.X_TC(), truth), 0.15 * kDegree) << k;
    // The table itself is held by thousands of readings.
    EXPECT_NEAR(motion.X_TC().translation().z(), truth.translation().z(), 0.001);
  }
}

TEST_F(CameraMotionTest, AJoltOfTwoCentimetres) {
  CameraMotion motion;
  Start(motion);
  Vector6 xi;
  xi << 0.015, -0.01, 0.008, 1 * kDegree, -1 * kDegree, 1 * kDegree;
  const Pose X_CT = Perturb(TestTable(), xi), truth = Truth(motion.X_TC(), X_CT);
  for (int k = 1; k <= 3; ++k) {
    DrawnObservation drawn = Draw(X_CT, static_cast<uint64_t>(k));
    // By depth: half a wave of the print is 2 cm, and brightness knows no more than that.
    drawn.picture.colour.release();
    motion.Step(drawn.View(), none_);
  }
  EXPECT_LT(PositionError(motion.X_TC(), truth), 0.0012);
  EXPECT_LT(AngleError(motion.X_TC(), truth), 0.15 * kDegree);
}

// Dark speckles all over: nearly every mark of strong gradient is darker than what a moved camera shows in its place.
TEST_F(CameraMotionTest, AJoltOverASpeckledTableIsNoticed) {
  const auto speckled = [&](const Pose& X_CT, uint64_t seed) {
    DrawnObservation drawn = Draw(X_CT, seed);
    std::vector<Pose> X_CP;
    for (const Pose& X_TP : boxes_) X_CP.push_back(X_CT * X_TP);
    const cv::Mat exact = DrawScene(task_, X_CP, seed, 0, 0, 0, 0.4, X_CT).depth;
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        const Vector3 p =
            X_CT.inverse() * TestCamera().BackProject(Eigen::Vector2d(x, y), 1e-3 * exact.at<uint16_t>(y, x));
        const auto cell = static_cast<uint32_t>(static_cast<int>(std::floor(p.x() / 0.004))) * 73856093u ^
                          static_cast<uint32_t>(static_cast<int>(std::floor(p.y() / 0.004))) * 19349663u;
        const uint8_t grey = cell * 2654435761u >> 29 == 0 ? 130 : 150;
        drawn.picture.colour.at<cv::Vec3b>(y, x) = {grey, grey, grey};
      }
    }
    return drawn;
  };
  CameraMotion motion;
  const DrawnObservation first = speckled(TestTable(), 0);
  const auto table = FindTable(first.View(), 1);
  ASSERT_TRUE(table);
  motion.Start(first.View(), *table);
  Vector6 xi;
  xi << 0.015, -0.01, 0.008, 1 * kDegree, -1 * kDegree, 1 * kDegree;
  const Pose X_CT = Perturb(TestTable(), xi), truth = Truth(motion.X_TC(), X_CT);
  motion.Step(speckled(X_CT, 1).View(), none_);
  EXPECT_GT(motion.step().translation().norm(), 0.005);
  // Along the table brightness alone tells, and one speckle looks like the next; its height and tilt are known.
  EXPECT_LT(std::abs(motion.X_TC().translation().z() - truth.translation().z()), 0.001);
}

TEST_F(CameraMotionTest, AStillCameraStaysStillExactly) {
  CameraMotion motion;
  Start(motion);
  const Pose first = motion.X_TC();
  for (int k = 1; k <= 10; ++k) {
    // Something wide passes in front.
    const int left = 60 * k - 100;
    motion.Step(Draw(TestTable(), static_cast<uint64_t>(k), std::max(0, left), std::max(0, left + 180), 0.45).View(),
                none_);
    EXPECT_TRUE(motion.X_TC().matrix() == first.matrix()) << k;
    EXPECT_TRUE(motion.step().matrix() == Pose::Identity().matrix()) << k;
  }
}

TEST_F(CameraMotionTest, WithoutDepthThePoseStaysAndDoubtGrows) {
  CameraMotion motion;
  Start(motion);
  const Pose first = motion.X_TC();
  Vector6 xi;
  xi << 0.02, 0, 0, 0, 0, 0;
  double doubt = motion.covariance().trace();
  for (int k = 1; k <= 3; ++k) {
    DrawnObservation blind = Draw(Perturb(TestTable(), xi), 1);
    if (k == 1) {
      blind.picture.depth.release();
    } else {
      blind.picture.depth.setTo(0);
      blind.picture.colour.release();
    }
    motion.Step(blind.View(), none_);
    EXPECT_TRUE(motion.X_TC().matrix() == first.matrix());
    EXPECT_FALSE(motion.table_seen());
    EXPECT_GT(motion.covariance().trace(), doubt);
    doubt = motion.covariance().trace();
  }
  // Seen again, it is where it is.
  DrawnObservation again = Draw(Perturb(TestTable(), xi), 2);
  again.picture.colour.release();
  motion.Step(again.View(), none_);
  EXPECT_LT(PositionError(motion.X_TC(), Truth(first, Perturb(TestTable(), xi))), 0.0012);
}

}  // namespace
}  // namespace coach
