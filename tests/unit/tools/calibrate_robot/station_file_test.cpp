#include "tools/calibrate_robot/station_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "common/configuration/station.h"

namespace coach {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Pose Seat() { return MakePose(ExpRotation(Vector3(0.02, -0.03, -1.4)), Vector3(0.1, 0.45, -0.05)); }

TEST(StationFile, OnlyTheRobotsPlaceChanges) {
  const std::string before =
      "station: A   # a table\nrobot:   # the one\n    # sits there\n    back_end: nao\n    position: [1, 1, 1]   # "
      "guessed\n"
      "    nao: {url: \"tcp://nao:9559\"}\n    roll_pitch_yaw: [0, 0, 0]\n\npage:\n  port: 80\n";
  const std::string after = WithRobotPose(before, Seat(), "a.yaml");
  EXPECT_THAT(after,
              StartsWith("station: A   # a table\nrobot:   # the one\n    position: [0.1000, 0.4500, -0.0500]\n"));
  EXPECT_THAT(
      after,
      HasSubstr("    # sits there\n    back_end: nao\n    nao: {url: \"tcp://nao:9559\"}\n\npage:\n  port: 80\n"));
  EXPECT_THAT(after, Not(HasSubstr("guessed")));
  EXPECT_EQ(WithRobotPose(after, Seat(), "a.yaml"), after);
}

TEST(StationFile, ASectionIsMadeWhereThereIsNone) {
  EXPECT_THAT(WithRobotPose("", Seat(), "a.yaml"), StartsWith("robot:\n  position: [0.1"));
  EXPECT_THAT(WithRobotPose("station: A", Seat(), "a.yaml"), StartsWith("station: A\nrobot:\n  position"));
  EXPECT_THAT(WithRobotPose("robot:\nstation: A\n", Seat(), "a.yaml"), HasSubstr("]\nstation: A\n"));
}

TEST(StationFile, WhatCantBeEditedIsRefusedByPlace) {
  try {
    WithRobotPose("station: A\nrobot: {back_end: log}\n", Seat(), "a.yaml");
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), StartsWith("a.yaml:2: robot:"));
  }
  EXPECT_THROW(WithRobotPose("robot:\n  misspelt: 1\n", Seat(), "a.yaml"), ConfigurationError);
}

TEST(StationFile, TheOldFileIsKeptEachTime) {
  const auto folder = std::filesystem::temp_directory_path() / ("coach_station_file_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const auto file = folder / "station.yaml";
  std::ofstream(file) << "station: A\n";
  EXPECT_EQ(WriteRobotPose(file, Seat()), folder / "station.yaml.old");
  EXPECT_EQ(WriteRobotPose(file, Pose::Identity()), folder / "station.yaml.old2");
  std::stringstream oldest;
  oldest << std::ifstream(folder / "station.yaml.old").rdbuf();
  EXPECT_EQ(oldest.str(), "station: A\n");
  EXPECT_NO_THROW(ReadStation(file));
  EXPECT_FALSE(std::filesystem::exists(folder / "station.yaml.new"));
  EXPECT_THROW(WriteRobotPose(folder / "none.yaml", Seat()), std::runtime_error);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace coach
