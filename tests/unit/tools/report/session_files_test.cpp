#include "tools/report/session_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "temporary_folder.h"
#include "written_lesson.h"

namespace coach {
namespace {

using testing::Contains;
using testing::HasSubstr;

class SessionFilesTest : public testing::Test {
 protected:
  void Put(const std::string& name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }
  std::filesystem::path Lesson(const std::string& name, double from = 0) const {
    WrittenLesson lesson(folder_.path() / name);
    for (int k = 0; k < 4; ++k) lesson.Frame(from + k);
    return folder_.path() / name;
  }
  const TemporaryFolder folder_;
};

TEST_F(SessionFilesTest, AnnotationsBesideTheLogAreFound) {
  const auto log = Lesson("a.lcm", 10);
  Put("a.annotations.txt", "connect\tAK\t00:00:01.000\t00:00:02.000\t00:00:01.000\tcorner_1\n");
  const Session s = ReadSession(log);
  EXPECT_EQ(s.name, "a");
  ASSERT_EQ(s.annotations.size(), 1u);
  EXPECT_EQ(s.annotations[0].utime, WrittenLesson::At(11)) << "the video begins with the first frame";
  SessionOptions later;
  later.annotation_offset = 2;
  EXPECT_EQ(ReadSession(log, later).annotations[0].utime, WrittenLesson::At(13));
}

TEST_F(SessionFilesTest, TwoObserversAreNotTwoEvents) {
  const auto log = Lesson("a.lcm");
  Put("a.annotations.txt",
      "connect\tAK\t00:00:01.000\t00:00:02.000\tx\nconnect\tAK\t00:00:02.000\t00:00:03.000\ty\nnote\tCD\t00:00:02."
      "000\t00:00:03.000\thm\n");
  Put("a.annotations.csv", "Time,Behavior,Subject,Modifier #1\n1.1,connect,CD,x\n");
  const Session s = ReadSession(log);
  EXPECT_EQ(s.annotations.size(), 3u);
  EXPECT_THAT(s.problems, Contains("1 events noted by 'CD' are left out, those of 'AK' are the truth"));
  SessionOptions other;
  other.annotator = "CD";
  EXPECT_EQ(ReadSession(log, other).annotations.size(), 2u);
}

TEST_F(SessionFilesTest, AFolderIsOneSessionInTheOrderOfItsTimes) {
  std::filesystem::create_directory(folder_.path() / "day");
  Lesson("day/lesson-b.lcm", 0);
  Lesson("day/lesson-a.lcm", 10);
  const Session s = ReadSession(folder_.path() / "day/");
  EXPECT_EQ(s.name, "day");
  ASSERT_EQ(s.frames.size(), 8u);
  EXPECT_LT(s.frames[0].utime, s.frames[7].utime);
}

TEST_F(SessionFilesTest, WhatIsNoSessionIsRefusedByName) {
  const auto refused = [&](const std::string& name) -> std::string {
    try {
      ReadSession(folder_.path() / name);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  Put("picture.png", "\x89PNG");
  std::filesystem::create_directory(folder_.path() / "nothing");
  EXPECT_THAT(refused("picture.png"), HasSubstr("picture.png: is neither"));
  EXPECT_THAT(refused("missing.lcm"), HasSubstr("missing.lcm: can't be read"));
  EXPECT_THAT(refused("nothing"), HasSubstr("holds no recording"));
  Lesson("c.lcm");
  Put("c.annotations.csv", "no,header\n");
  EXPECT_THAT(refused("c.lcm"), HasSubstr("c.annotations.csv: no line names"));
}

TEST_F(SessionFilesTest, EmptyFilesAreEmptySessions) {
  Put("empty.jsonl", "");
  Put("empty.lcm", "");
  EXPECT_THAT(ReadSession(folder_.path() / "empty.jsonl").problems, Contains(HasSubstr("empty")));
  EXPECT_THAT(ReadSession(folder_.path() / "empty.lcm").problems, Contains(HasSubstr("empty")));
}

}  // namespace
}  // namespace coach
