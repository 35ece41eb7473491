#include "tools/report/event_log_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coach {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string Line(int64_t utime, const std::string& kind, const std::string& subject) {
  return R"({"id":1,"utime":)" + std::to_string(utime) + R"(,"since":)" + std::to_string(utime) + R"(,"kind":")" +
         kind + R"(","subject":")" + subject + R"(","part_a":-1,"part_b":-1,"probability":0,"reason":""})";
}

TEST(EventLogSession, ReadsEveryLine) {
  const Session s = ParseEventLog(Line(0, "operator", "start") + "\n" + Line(5'000'000, "connect", "corner_1") +
                                  "\r\n" + Line(9'000'000, "phase", "complete"));
  EXPECT_TRUE(s.problems.empty());
  ASSERT_EQ(s.events.size(), 3u);
  EXPECT_EQ(s.events[0].utime, 5'000'000) << "an order before the first frame takes the time of what follows";
  EXPECT_EQ(s.end - s.begin, 4'000'000);
  EXPECT_FALSE(s.has_bus);
}

TEST(EventLogSession, SaysWhatItCannotRead) {
  const Session cut = ParseEventLog(Line(1, "a", "b") + "\n{\"id\":2,\"uti");
  EXPECT_EQ(cut.events.size(), 1u);
  EXPECT_THAT(cut.problems, ElementsAre("1 lines can't be read, the first is line 2"));
  EXPECT_THAT(ParseEventLog("").problems, ElementsAre(HasSubstr("empty")));
  EXPECT_EQ(ParseEventLog("[1]\n{\"id\":\"x\"}\n").problems.size(), 2u);
}

}  // namespace
}  // namespace coach
