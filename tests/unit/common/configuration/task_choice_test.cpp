#include "common/configuration/task_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

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

TEST(TaskChoice, TheChoiceIsRememberedAndABrokenMemoryIsNoHarm) {
  Station station = WithTasks();
  EXPECT_EQ(RememberedTask(station), station.task) << "without a state folder";
  RememberTask(station, "rectangle_long_short");
  station.state_folder = std::filesystem::temp_directory_path() / ("task_choice_test" + std::to_string(getpid()));
  std::filesystem::create_directories(station.state_folder);
  EXPECT_EQ(RememberedTask(station), station.task);
  RememberTask(station, "rectangle_long_short");
  EXPECT_EQ(RememberedTask(station).filename(), "rectangle_long_short.yaml");
  RememberTask(station, "../gone");
  EXPECT_EQ(RememberedTask(station), station.task);
  std::filesystem::remove_all(station.state_folder);
}

}  // namespace
}  // namespace coach
