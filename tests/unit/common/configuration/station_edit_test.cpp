#include "common/configuration/station_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "common/configuration/station.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string Read(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(StationEdit, AnEmptyFileBecomesAStation) {
  const std::string text = WithSettings(
      "",
      {{{"task"}, "\"/tasks/square.yaml\""}, {{"robot", "volume"}, "0.5"}, {{"robot", "position"}, "[0, 0.5, 0.1]"}});
  EXPECT_EQ(text, "task: \"/tasks/square.yaml\"\n\nrobot:\n  volume: 0.5\n  position: [0, 0.5, 0.1]\n");
}

TEST(StationEdit, TheShippedFileKeepsEveryOtherLineAndItsComments) {
  const std::string shipped = Read(fs::path(COACH_SOURCE_DIR) / "deploy/station.yaml");
  const std::string text = WithSettings(shipped, {{{"robot", "volume"}, "0.25"}, {{"task"}, "/tmp/t.yaml"}});
  EXPECT_THAT(text, HasSubstr("  volume: 0.25                   # 0..1\n"));
  EXPECT_THAT(text, HasSubstr("task: /tmp/t.yaml   # the page offers every task of this folder\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), std::count(shipped.begin(), shipped.end(), '\n'));
  EXPECT_EQ(WithSettings(text, {{{"robot", "volume"}, "0.6"}}).find("volume: 0.6"), text.find("volume: 0.25"));
  const Station station = ParseStation(text, "station.yaml");
  EXPECT_DOUBLE_EQ(station.Section("robot").Get<double>("volume"), 0.25);
  EXPECT_EQ(station.task, "/tmp/t.yaml");
}

TEST(StationEdit, AValueOfManyLinesIsReplacedWhole) {
  const std::string text =
      "detector:\n    colours:   # of this room\n      blue:\n        low: [1, 2, 3]\n        high: [4, 5, 6]\n\n    "
      "opening: 1\nrobot: {volume: 0.3}\n";
  EXPECT_EQ(WithSettings(text, {{{"detector", "colours"}, "{}"}}),
            "detector:\n    colours: {}\n\n    opening: 1\nrobot: {volume: 0.3}\n");
}

TEST(StationEdit, WhatCannotBeChangedLineByLineIsWrittenAnew) {
  for (const char* text : {"robot: {volume: 0.3, back_end: log}", "robot:\n  { volume: 0.3,\n    back_end: log }\n",
                           "{robot: {volume: 0.3, back_end: log}}", "'robot': {\"volume\": 0.3, back_end: log}\n"}) {
    const Station station = ParseStation(WithSettings(text, {{{"robot", "volume"}, "0.7"}}), "s.yaml");
    EXPECT_DOUBLE_EQ(station.Section("robot").Get<double>("volume"), 0.7) << text;
    EXPECT_EQ(station.Section("robot").Get<std::string>("back_end"), "log") << text;
  }
}

TEST(StationEdit, AHashInQuotesIsNoComment) {
  EXPECT_EQ(WithSettings("task: \"a #1\" # best\n", {{{"task"}, "b"}}), "task: b # best\n");
}

TEST(StationEdit, NoYamlIsAnError) {
  EXPECT_THROW(WithSettings("a: [1\n", {{{"task"}, "b"}}), ConfigurationError);
  EXPECT_THROW(WithSettings("", {{{"task"}, "[1"}}), ConfigurationError);
}

class ReplaceFileTest : public testing::Test {
 protected:
  ReplaceFileTest() { fs::create_directories(folder_); }
  ~ReplaceFileTest() override { fs::remove_all(folder_); }
  const fs::path folder_ = fs::temp_directory_path() / ("coach_replace_" + std::to_string(getpid()));
  const fs::path file_ = folder_ / "station.yaml";
};

TEST_F(ReplaceFileTest, KeepsTheOldOnes) {
  for (int k = 0; k < 8; ++k) ReplaceFile(file_, "version " + std::to_string(k));
  EXPECT_EQ(Read(file_), "version 7");
  EXPECT_EQ(Read(folder_ / "station.yaml.1"), "version 6");
  EXPECT_EQ(Read(folder_ / "station.yaml.5"), "version 2");
  EXPECT_FALSE(fs::exists(folder_ / "station.yaml.6"));
  EXPECT_FALSE(fs::exists(folder_ / "station.yaml.new"));
  ReplaceFile(file_, "version 7");
  EXPECT_EQ(Read(folder_ / "station.yaml.1"), "version 6") << "the same text is no new version";
}

TEST_F(ReplaceFileTest, KeepsItsRights) {
  ReplaceFile(file_, "a");
  fs::permissions(file_, fs::perms::owner_read | fs::perms::owner_write);
  ReplaceFile(file_, "b");
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(ReplaceFileTest, ADiskThatRefusesLeavesTheOldFile) {
  ReplaceFile(file_, "a");
  fs::create_directory(folder_ / "station.yaml.new");  // in the way
  EXPECT_THROW(ReplaceFile(file_, "b"), std::runtime_error);
  EXPECT_EQ(Read(file_), "a");
  EXPECT_THROW(ReplaceFile(folder_ / "missing" / "station.yaml", "b"), std::runtime_error);
}

}  // namespace
}  // namespace coach
