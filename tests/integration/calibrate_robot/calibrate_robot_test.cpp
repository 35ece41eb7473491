// coach-calibrate-robot from end to end: a robot that speaks qi takes the poses, a tracker sees the part in its hand
// with noise, and the station file knows in the end where the robot sits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <numbers>

#include "common/configuration/station.h"
#include "drawn_tracker.h"
#include "fake_qi_server.h"
#include "process.h"
#include "services/robot_bridge/robot_options.h"

namespace coach {
namespace {

using testing::HasSubstr;

TEST(CalibrateRobot, WritesWhereTheRobotSitsAndKeepsTheOldFile) {
  const auto folder = std::filesystem::temp_directory_path() / ("coach_calibrate_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const auto file = folder / "station.yaml";
  const FakeQiServer robot;
  std::ofstream(file)
      << "station: CAL   # kept\ntask: " << COACH_SOURCE_DIR
      << "/deploy/tasks/rectangle_long_medium.yaml\nrobot:\n  back_end: nao\n  position: [0, 0, 0]\n  nao: {url: \""
      << robot.url() << "\"}\n";
  const Pose X_TR = MakePose(ExpRotation(Vector3(0.01, 0.03, -1.7)), Vector3(0.06, 0.48, 0.05));
  DrawnTracker tracker(robot, "CAL", X_TR, Vector3(0.02, -0.01, 0.015));
  Process program({Program("coach-calibrate-robot"), "--config", file.string(), "--part", "long_1", "--yes"});
  EXPECT_TRUE(Until(
      120, [&] { usleep(20000), tracker.Send(); }, [&] { return !program.running(); }));
  ASSERT_EQ(program.Wait(1), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("from 8 poses"));
  EXPECT_TRUE(robot.Violations().empty());
  const Station station = ReadStation(file);
  const Pose found = ReadRobotOptions(station.Section("robot")).conductor.X_TR;
  EXPECT_LT((found.translation() - X_TR.translation()).norm(), 0.004);
  const double turned = Eigen::AngleAxisd(found.linear().transpose() * X_TR.linear()).angle();
  EXPECT_LT(turned * 180 / std::numbers::pi, 1.0);
  EXPECT_THAT(station.text, HasSubstr("station: CAL   # kept\n"));
  EXPECT_TRUE(std::filesystem::exists(folder / "station.yaml.1"));
  std::filesystem::remove_all(folder);
}

TEST(CalibrateRobot, APartThatIsNotSeenLeavesTheFileAlone) {
  const auto folder = std::filesystem::temp_directory_path() / ("coach_calibrate_bad_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const auto file = folder / "station.yaml";
  std::ofstream(file) << "station: CAL\ntask: " << COACH_SOURCE_DIR << "/deploy/tasks/square.yaml\n";
  Process unknown({Program("coach-calibrate-robot"), "--config", file.string(), "--part", "gold_1", "--yes"});
  EXPECT_NE(unknown.Wait(20), 0);
  EXPECT_THAT(unknown.output(), HasSubstr("expected one of"));
  EXPECT_FALSE(std::filesystem::exists(folder / "station.yaml.1"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace coach
