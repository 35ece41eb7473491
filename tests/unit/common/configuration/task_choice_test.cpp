#include "common/configuration/task_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace coach {
namespace {

Station WithTasks() {
  Station station = DefaultStation();
  station.task = std::filesystem::path(COACH_SOURCE_DIR) / "deploy/tasks/square.yaml";
  return station;
}

TEST(TaskChoice, OffersTheFilesBesideTheStationsTask) {
  EXPECT_THAT(TaskNames(WithTasks()), testing::IsSupersetOf({"rectangle_long_medium", "square"}));
  EXPECT_EQ(TaskFileNamed(WithTasks(), "rectangle_long_short").filename(), "rectangle_long_short.yaml");
}

TEST(TaskChoice, WhatIsNotThereIsOneClearError) {
  for (const char* name : {"castle", "", "../tasks/square", "square.yaml", "/etc/passwd"}) {
    EXPECT_THROW(TaskFileNamed(WithTasks(), name), ConfigurationError) << name;
  }
  EXPECT_TRUE(TaskNames(DefaultStation()).empty());
  EXPECT_THROW(TaskFileNamed(DefaultStation(), "square"), ConfigurationError);
}

TEST(TaskChoice, TasksMadeAtTheTableAreOfferedToo) {
  namespace fs = std::filesystem;
  Station station = WithTasks();
  station.state_folder = fs::temp_directory_path() / ("coach_choice_" + std::to_string(getpid()));
  fs::create_directories(OwnTaskFolder(station));
  for (const char* name : {"castle", "square"}) std::ofstream(OwnTaskFolder(station) / (std::string(name) + ".yaml"));
  EXPECT_THAT(TaskNames(station), testing::IsSupersetOf({"castle", "square", "two_bricks"}));
  EXPECT_EQ(TaskFileNamed(station, "castle"), OwnTaskFolder(station) / "castle.yaml");
  EXPECT_EQ(TaskFileNamed(station, "square"), station.task) << "the first folder's";
  fs::remove_all(station.state_folder);
}

}  // namespace
}  // namespace coach
