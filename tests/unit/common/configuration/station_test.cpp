#include "common/configuration/station.h"

#include <gmock/gmock.h>

namespace coach {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string ErrorOf(const std::string& yaml) {
  try {
    ParseStation(yaml, "/etc/coach/A/station.yaml");
  } catch (const ConfigurationError& e) {
    return e.what();
  }
  return "";
}

TEST(Station, EverythingHasADefault) {
  const Station station = ParseStation("{}", "/etc/coach/A/station.yaml");
  EXPECT_EQ(StationNameProblem(station.name), "");
  EXPECT_THAT(station.table_url, AllOf(HasSubstr("udpm://239.255.76.67:7667"), HasSubstr("ttl=0")));
  EXPECT_THAT(station.robot_url, AllOf(HasSubstr(":7668"), HasSubstr("ttl=0")));
  EXPECT_TRUE(station.task.empty());
  EXPECT_TRUE(station.state_folder.empty());
  EXPECT_NO_THROW(station.Section("camera").RejectUnknownKeys());
}

TEST(Station, PathsStartAtTheFile) {
  const Station station = ParseStation(
      "station: TABLE.1\ntask: tasks/a.yaml\nstate_folder: /var/lib/coach/A\nbus: {table: "
      "'udpm://239.1.1.1:7000?ttl=0', key_file: key}\n"
      "robot: {back_end: log}\n",
      "/etc/coach/A/station.yaml");
  EXPECT_EQ(station.name, "TABLE.1");
  EXPECT_EQ(station.task, "/etc/coach/A/tasks/a.yaml");
  EXPECT_EQ(station.state_folder, "/var/lib/coach/A");
  EXPECT_EQ(station.key_file, "/etc/coach/A/key");
  EXPECT_EQ(station.table_url, "udpm://239.1.1.1:7000?ttl=0");
  EXPECT_EQ(station.Section("robot").Get<std::string>("back_end"), "log");
}

TEST(Station, EveryServiceHasItsSection) {
  for (const char* section : {"camera", "detector", "pose_filter", "guidance", "robot", "page", "log"}) {
    EXPECT_EQ(ErrorOf(std::string(section) + ": {}\n"), "");
    EXPECT_THAT(ErrorOf(std::string(section) + ": 3\n"), HasSubstr(section));
  }
}

TEST(Station, MistakesNameFileLineAndKey) {
  EXPECT_THAT(ErrorOf("station: A\ncamra: {}\n"), AllOf(HasSubstr("station.yaml:2"), HasSubstr("camra")));
  EXPECT_THAT(ErrorOf("bus: {tabel: x}\n"), HasSubstr("tabel"));
  EXPECT_THAT(ErrorOf("bus: {table: 239.255.76.67}\n"), AllOf(HasSubstr("station.yaml:1"), HasSubstr("udpm://")));
  EXPECT_THAT(ErrorOf("station: 'a/b'\n"), HasSubstr("1 to 32 characters"));
  EXPECT_THAT(ErrorOf("station: [\n"), HasSubstr("station.yaml"));
  EXPECT_THROW(ReadStation("/nowhere/station.yaml"), ConfigurationError);
}

TEST(Station, WhatLeavesTheHostIsSigned) {
  EXPECT_THAT(ErrorOf("bus: {robot: 'udpm://239.1.1.1:7000?ttl=1'}\n"),
              AllOf(HasSubstr("ttl=1"), HasSubstr("key_file")));
  EXPECT_EQ(ErrorOf("bus: {robot: 'udpm://239.1.1.1:7000?ttl=1', key_file: key}\n"), "");
  EXPECT_EQ(ErrorOf("bus: {robot: 'udpm://239.1.1.1:7000?ttl=0'}\n"), "");
  EXPECT_EQ(ErrorOf("bus: {robot: 'udpm://239.1.1.1:7000'}\n"), "");
}

TEST(Station, AnEmptyFileIsAStationOfDefaults) {
  for (const char* text : {"", "\n", "# nothing yet\n"}) {
    const Station station = ParseStation(text, "station.yaml");
    EXPECT_EQ(station.name, DefaultStation().name);
    EXPECT_TRUE(station.task.empty());
    EXPECT_FALSE(station.Section("robot").Has("volume"));
  }
}

}  // namespace
}  // namespace coach
