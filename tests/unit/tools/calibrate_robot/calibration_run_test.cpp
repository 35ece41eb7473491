#include "tools/calibrate_robot/calibration_run.h"

#include <gtest/gtest.h>

#include "services/robot_bridge/kinematics.h"
#include "services/robot_bridge/log_back_end.h"

namespace coach {
namespace {

constexpr int64_t kTick = 33000;  // us

/// Goes where it is sent, at once.
class ObedientRobot : public LogBackEnd {
 public:
  ObedientRobot() : LogBackEnd([](const std::string&) {}) {}
  void Move(const JointPath& path) override { angles = path.points.back().angles; }
  std::optional<JointAngles> MeasuredAngles() const override { return angles; }
  JointAngles angles = RestAngles();
};

/// Runs it with a tracker that sees the part where the arm holds it; `hidden` poses are not seen.
CalibrationRun RunThrough(ObedientRobot& robot, const Pose& X_TR, size_t hidden) {
  CalibrationRun run(robot, Arm::kRight, 1, [](const std::string&) {});
  const auto poses = CalibrationPoses(Arm::kRight);
  int64_t now = 1000000;
  for (int i = 0; i < 10000 && !run.finished(); ++i, now += kTick) {
    PartPoses seen;
    seen.parts.resize(2);
    seen.parts[1].confidence = 0.9;
    seen.parts[1].X_TP = X_TR * HandPose(Arm::kRight, robot.angles);
    const bool visible = hidden >= poses.size() || robot.angles != poses[hidden];
    seen.parts[1].status = visible ? PartStatus::kTracked : PartStatus::kLost;
    run.See(seen);
    run.Step(now);
  }
  return run;
}

TEST(CalibrationRunTest, FindsTheSeatFromEightPosesAndTakesTheArmDown) {
  const Pose X_TR = MakePose(ExpRotation(Vector3(0.02, -0.03, -1.5)), Vector3(0.05, 0.45, 0.1));
  ObedientRobot robot;
  const CalibrationRun run = RunThrough(robot, X_TR, 99);
  ASSERT_TRUE(run.finished());
  EXPECT_EQ(run.samples().size(), 8u);
  EXPECT_EQ(robot.angles, RestAngles());
  const CalibrationResult result = CalibrateRobot(run.samples());
  ASSERT_TRUE(result.success) << result.problem;
  EXPECT_LT((result.X_TR.translation() - X_TR.translation()).norm(), 1e-4);
}

TEST(CalibrationRunTest, PoseInWhichThePartIsHiddenIsLeftOut) {
  ObedientRobot robot;
  const CalibrationRun run = RunThrough(robot, Pose::Identity(), 3);
  ASSERT_TRUE(run.finished());
  EXPECT_EQ(run.samples().size(), 7u);
}

}  // namespace
}  // namespace coach
