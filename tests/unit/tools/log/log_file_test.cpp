#include "tools/log/log_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "common/bus/channels.h"
#include "tools/log/log_summary.h"

namespace coach {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class LogFileTest : public testing::Test {
 protected:
  LogFileTest()
      : file_(std::filesystem::temp_directory_path() / ("log_file_test" + std::to_string(getpid()) + ".lcm")) {
    std::filesystem::remove(file_);
  }
  ~LogFileTest() override { std::filesystem::remove(file_); }

  static std::vector<uint8_t> Frame(int64_t sequence) {
    color_image_t message{};
    message.sequence = sequence;
    message.data = {1, 2, 3};
    message.data_size = 3;
    std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    return bytes;
  }
  LogSummary Summary() const {
    LogReader reader(file_);
    return Summarise(reader);
  }

  const std::filesystem::path file_;
};

TEST_F(LogFileTest, WhatIsWrittenIsReadAgain) {
  const std::vector<uint8_t> bytes{0, 255, 7};
  {
    LogWriter writer(file_);
    EXPECT_TRUE(writer.Write(1'000, "T1/X", bytes));
    EXPECT_TRUE(writer.Write(2'000, "T1/Y", {}));
    EXPECT_EQ(writer.events(), 2);
    EXPECT_TRUE(writer.Flush());
    EXPECT_EQ(writer.bytes(), static_cast<int64_t>(std::filesystem::file_size(file_)));
  }
  LogReader reader(file_);
  const auto first = reader.Next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->utime, 1'000);
  EXPECT_EQ(first->channel, "T1/X");
  EXPECT_EQ(first->bytes, bytes);
  EXPECT_EQ(reader.Next()->channel, "T1/Y");
  EXPECT_FALSE(reader.Next());
  EXPECT_TRUE(reader.complete());
}

TEST_F(LogFileTest, NothingIsOverwritten) {
  LogWriter writer(file_);
  EXPECT_THROW(LogWriter{file_}, std::runtime_error);
  EXPECT_THROW(LogReader("/nonexistent.lcm"), std::runtime_error);
}

TEST_F(LogFileTest, ASummaryCountsRatesAndGaps) {
  {
    LogWriter writer(file_);
    for (const int64_t k : {0, 1, 2, 5, 6, 0, 1}) {  // two frames lost, then the camera service starts again
      writer.Write(1'000'000 + 100'000 * static_cast<int64_t>(writer.events()), "T1/COLOR_IMAGE", Frame(k));
    }
    writer.Write(1'700'000, "T1/COLOR_IMAGE", std::vector<uint8_t>{1, 2, 3});
    writer.Write(1'700'000, "OTHER", std::vector<uint8_t>{1});
  }
  const LogSummary summary = Summary();
  const ChannelSummary& frames = summary.channels.at("T1/COLOR_IMAGE");
  EXPECT_EQ(frames.events, 8);
  EXPECT_NEAR(frames.rate(), 10, 1e-9);
  EXPECT_EQ(frames.missing, 2);
  EXPECT_EQ(frames.undecodable, 1);
  EXPECT_FALSE(summary.channels.at("OTHER").known);
  EXPECT_THAT(ProblemsOf(summary, {"COLOR_IMAGE", "PART_POSES"}),
              ElementsAre(HasSubstr("1 messages can't be decoded"), HasSubstr("PART_POSES: nothing was recorded")));
}

TEST_F(LogFileTest, AnEmptyAndACutOffRecordingAreNoticed) {
  { LogWriter writer(file_); }
  EXPECT_THAT(ProblemsOf(Summary(), {}), ElementsAre(HasSubstr("empty")));
  std::filesystem::remove(file_);
  {
    LogWriter writer(file_);
    for (int k = 0; k < 5; ++k) writer.Write(k, "T1/COLOR_IMAGE", Frame(k));
  }
  EXPECT_THAT(ProblemsOf(Summary(), {}), ElementsAre());
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 10);
  const LogSummary cut = Summary();
  EXPECT_EQ(cut.events, 4);
  EXPECT_THAT(ProblemsOf(cut, {}), ElementsAre(HasSubstr("cut off")));
}

TEST_F(LogFileTest, ADamagedHeaderEndsTheReading) {
  {
    LogWriter writer(file_);
    for (int k = 0; k < 3; ++k) writer.Write(k, "T1/COLOR_IMAGE", Frame(k));
  }
  std::fstream damage(file_, std::ios::in | std::ios::out | std::ios::binary);
  damage.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file_) / 3));
  damage.write("????", 4);
  damage.close();
  const LogSummary summary = Summary();
  EXPECT_LT(summary.events, 3);
  EXPECT_FALSE(summary.complete);
}

}  // namespace
}  // namespace coach
