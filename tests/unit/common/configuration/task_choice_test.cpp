#include "common/configuration/task_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace coach
