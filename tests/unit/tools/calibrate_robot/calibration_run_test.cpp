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
  void Freeze() override { ++frozen; }
  BackEndState State() const override { return {connected, connected ? "" : "away", -1}; }
  JointAngles angles = RestAngles();
  int frozen = 0;
  bool connected = true;
};

/// Runs it with a tracker that sees the part where the arm holds it; `hidden` poses are not seen.
CalibrationRun RunThrough(ObedientRobot& robot, const Pose& X_TR, size_t hidden) {
  CalibrationRun run(robot, Arm::kRight, 1);
  const auto poses = CalibrationPoses(Arm::kRight);
  int64_t now = 1000000;
  for (int i = 0; i < 10000 && !run.over(); ++i, now += kTick) {
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
  ASSERT_EQ(run.state(), CalibrationRun::State::kDone) << run.problem();
  EXPECT_EQ(run.samples().size(), 8u);
  EXPECT_EQ(robot.angles, RestAngles());
  EXPECT_LT((run.result().X_TR.translation() - X_TR.translation()).norm(), 1e-4);
}

TEST(CalibrationRunTest, PoseInWhichThePartIsHiddenIsLeftOut) {
  ObedientRobot robot;
  const CalibrationRun run = RunThrough(robot, Pose::Identity(), 3);
  ASSERT_EQ(run.state(), CalibrationRun::State::kDone);
  EXPECT_EQ(run.samples().size(), 7u);
  ASSERT_EQ(run.reports().size(), 8u);
  EXPECT_FALSE(run.reports()[3].used);
  EXPECT_TRUE(run.reports()[4].used);
}

TEST(CalibrationRunTest, PartThatIsNeverSeenGivesNoSeat) {
  ObedientRobot robot;
  CalibrationRun run(robot, Arm::kRight, 7);
  for (int64_t now = 1; now < 300000000 && !run.over(); now += kTick) run.Step(now);
  EXPECT_EQ(run.state(), CalibrationRun::State::kFailed);
  EXPECT_EQ(run.problem(), "only 0 samples, at least 6 are needed");
  EXPECT_EQ(robot.angles, RestAngles());
}

TEST(CalibrationRunTest, StopLeavesTheArmWhereItIs) {
  ObedientRobot robot;
  CalibrationRun run(robot, Arm::kRight, 1);
  for (int64_t now = 1; now < 2000000; now += kTick) run.Step(now);
  const JointAngles before = robot.angles;
  EXPECT_NE(before, RestAngles());
  run.Stop();
  for (int64_t now = 2000000; now < 20000000; now += kTick) run.Step(now);
  EXPECT_EQ(run.state(), CalibrationRun::State::kFailed);
  EXPECT_EQ(robot.angles, before);
  EXPECT_EQ(robot.frozen, 1);
}

TEST(CalibrationRunTest, RobotThatDoesNotAnswerIsGivenUpAfterAMinute) {
  ObedientRobot robot;
  robot.connected = false;
  CalibrationRun run(robot, Arm::kRight, 1);
  run.Step(1000000);
  EXPECT_EQ(run.state(), CalibrationRun::State::kConnecting);
  EXPECT_EQ(run.problem(), "away");
  run.Step(62000000);
  EXPECT_EQ(run.state(), CalibrationRun::State::kFailed);
  EXPECT_EQ(run.problem(), "no robot: away");
}

}  // namespace
}  // namespace coach
