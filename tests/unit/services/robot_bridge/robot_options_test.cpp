#include "services/robot_bridge/robot_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <sstream>

namespace coach {
namespace {

using testing::HasSubstr;

RobotOptions Read(const std::string& yaml) {
  return ReadRobotOptions(YamlNode::Parse(yaml, "station.yaml").At("robot"));
}

std::string ErrorOf(const std::string& yaml) {
  try {
    Read(yaml);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

TEST(RobotOptionsTest, MissingPartIsAllDefaults) {
  const RobotOptions options = Read("robot: {}\n");
  EXPECT_EQ(options.back_end, "virtual");
  // As the camera the robot faces the child: its front is +y of the table.
  EXPECT_LT((options.conductor.X_TR.linear().col(0) - Vector3(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT(options.conductor.X_TR.translation().y(), -0.4);
}

TEST(RobotOptionsTest, EveryKey) {
  const RobotOptions options = Read(
      "robot:\n  back_end: nao\n  volume: 0.4\n  position: [0.1, 0.4, 0.2]\n  roll_pitch_yaw: [0, 0, 180]\n"
      "  speed: 0.2\n  child_distance: 0.6\n  hand_clearance: 0.2\n  heartbeat_timeout: 20\n"
      "  virtual: {host: 0.0.0.0, port: 9000, token: abcdefghijkl, max_pages: 3}\n"
      "  nao: {url: 'tcps://10.0.0.5:9503', user: nao, token: secret, call_timeout: 3, largest_volume: 0.5}\n");
  EXPECT_EQ(options.back_end, "nao");
  EXPECT_LT((options.conductor.X_TR * Vector3(1, 0, 0) - Vector3(-0.9, 0.4, 0.2)).norm(), 1e-9);
  EXPECT_EQ(options.virtual_robot.port, 9000);
  EXPECT_EQ(options.nao.url, "tcps://10.0.0.5:9503");
  EXPECT_EQ(options.conductor.heartbeat_timeout_s, 20);
}

TEST(RobotOptionsTest, SeatDegreesAreReadBack) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-170, 170), steep(-85, 85);
  for (int k = 0; k < 100; ++k) {
    const Vector3 degrees(any(random), steep(random), any(random));
    std::ostringstream yaml;
    yaml << "robot:\n  roll_pitch_yaw: [" << degrees.x() << ", " << degrees.y() << ", " << degrees.z() << "]\n";
    EXPECT_LT((SeatDegrees(Read(yaml.str()).conductor.X_TR) - degrees).norm(), 1e-3);
  }
}

TEST(RobotOptionsTest, MistakesNameThePlaceAndWhatWasExpected) {
  EXPECT_THAT(ErrorOf("robot:\n  back_end: pepper\n"), HasSubstr("station.yaml:2"));
  EXPECT_THAT(ErrorOf("robot: {speed: 0.9}\n"), HasSubstr("speed"));
  EXPECT_THAT(ErrorOf("robot: {colour: red}\n"), HasSubstr("colour"));
  EXPECT_THAT(ErrorOf("robot: {position: [1, 2]}\n"), HasSubstr("three numbers"));
  EXPECT_THAT(ErrorOf("robot: {nao: {url: 'nao.local'}}\n"), HasSubstr("tcp://"));
  EXPECT_THAT(ErrorOf("robot: {virtual: {host: 0.0.0.0}}\n"), HasSubstr("token"));
}

}  // namespace
}  // namespace coach
