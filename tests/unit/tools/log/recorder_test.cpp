#include "tools/log/recorder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace coach {
namespace {

class RecorderTest : public testing::Test {
 protected:
  RecorderTest() {
    options_.folder = std::filesystem::temp_directory_path() / ("recorder_test" + std::to_string(getpid()));
    std::filesystem::remove_all(options_.folder);
  }
  ~RecorderTest() override { std::filesystem::remove_all(options_.folder); }

  int Files() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(options_.folder)) count += entry.is_regular_file();
    return count;
  }

  RecorderOptions options_;
};

TEST_F(RecorderTest, NoPictureIsKeptUnlessTheStationFileSaysSo) {
  for (const char* channel : {"T1/COLOR_IMAGE", "T1/DEPTH_IMAGE", "T1/DETECTIONS"}) {
    EXPECT_FALSE(IsKept(channel, false)) << channel;
    EXPECT_TRUE(IsKept(channel, true)) << channel;
  }
  EXPECT_TRUE(IsKept("T1/PART_POSES", false));
  EXPECT_FALSE(ReadRecorderOptions(DefaultStation()).images);
  EXPECT_FALSE(ReadRecorderOptions(ParseStation("station: T1", "/etc/coach/station.yaml")).images);
  EXPECT_TRUE(ReadRecorderOptions(ParseStation("log: {images: true}", "/etc/coach/station.yaml")).images);
  EXPECT_THROW(ReadRecorderOptions(ParseStation("log: {imagse: true}", "/etc/coach/station.yaml")), ConfigurationError);
}

TEST_F(RecorderTest, FilesAreSplitAndTheOldestMakeRoom) {
  options_.split_mb = 1;
  options_.quota_gb = 0.004;
  Recorder recorder(options_);
  const std::vector<uint8_t> bytes(100'000);
  for (int k = 0; k < 100; ++k) recorder.Write(1'700'000'000'000'000 + k * 1'000'000, "T1/PART_POSES", bytes);
  EXPECT_EQ(recorder.events(), 100);
  EXPECT_GE(Files(), 2);
  EXPECT_LE(Files(), 4) << "10 MB were written, 4 may stay";
  EXPECT_TRUE(std::filesystem::exists(recorder.file()));
}

TEST_F(RecorderTest, SomebodyElsesFilesAreLeftAlone) {
  std::filesystem::create_directories(options_.folder);
  std::ofstream(options_.folder / "notes.txt") << std::string(100'000, 'x');
  options_.quota_gb = 0.001;
  options_.split_mb = 1;
  Recorder recorder(options_);
  recorder.Write(1, "T1/PART_POSES", std::vector<uint8_t>(10));
  EXPECT_TRUE(std::filesystem::exists(options_.folder / "notes.txt"));
}

TEST_F(RecorderTest, TwoFilesOfOneSecondHaveTwoNames) {
  Recorder first(options_), second(options_);
  first.Write(1'000'000, "T1/PART_POSES", std::vector<uint8_t>(10));
  second.Write(1'000'000, "T1/PART_POSES", std::vector<uint8_t>(10));
  EXPECT_NE(first.file(), second.file());
}

TEST_F(RecorderTest, AFullDiskLosesMessagesNotTheProgram) {
  Recorder recorder(options_);
  std::filesystem::remove(options_.folder);
  std::filesystem::create_symlink("/nonexistent-folder", options_.folder);
  for (int k = 0; k < 10; ++k) recorder.Write(k, "T1/PART_POSES", std::vector<uint8_t>(10));
  EXPECT_EQ(recorder.refused(), 10);
  EXPECT_TRUE(recorder.disk_refuses());
  std::filesystem::remove(options_.folder);
  std::filesystem::create_directories(options_.folder);
  recorder.Write(20'000'000, "T1/PART_POSES", std::vector<uint8_t>(10));
  EXPECT_FALSE(recorder.disk_refuses()) << "it goes on when there is room again";
  EXPECT_EQ(recorder.events(), 1);
}

}  // namespace
}  // namespace coach
