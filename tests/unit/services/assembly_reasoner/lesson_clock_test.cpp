#include "services/assembly_reasoner/lesson_clock.h"

#include <gtest/gtest.h>

namespace coach {
namespace {

constexpr int64_t kSecond = 1'000'000, kHour = 3600 * kSecond;

TEST(LessonClock, RunsWithThePosesAndKeepsGaps) {
  LessonClock clock;
  for (const int64_t utime : {5 * kSecond, 6 * kSecond, 6 * kSecond, 90 * kSecond, 90 * kSecond - 10})
    EXPECT_EQ(clock.ToLesson(utime), utime);
}

TEST(LessonClock, AClockThatIsSetDoesNotMoveIt) {
  LessonClock clock;
  int64_t last = clock.ToLesson(100 * kHour);
  for (const int64_t step : {-kHour, -2 * kSecond, kHour, 11 * 60 * kSecond, -100 * kHour}) {
    static int64_t utime = 100 * kHour;
    utime += step;
    const int64_t at = clock.ToLesson(utime);
    EXPECT_GT(at, last);
    EXPECT_LT(at, last + kSecond / 10);
    utime += kSecond;
    EXPECT_EQ(clock.ToLesson(utime), at + kSecond) << "and then goes on with it";
    last = at + kSecond;
  }
}

}  // namespace
}  // namespace coach
