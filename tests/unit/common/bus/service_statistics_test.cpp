#include "common/bus/service_statistics.h"

#include <gtest/gtest.h>

namespace coach {
namespace {

TEST(RollingWindow, ForgetsAfterFiveSeconds) {
  RollingWindow window;
  for (int i = 0; i < 100; ++i) window.Add(i * 100'000, i);  // 10 a second over 10 s
  EXPECT_NEAR(window.Rate(9'900'000), 10, 0.3);
  EXPECT_EQ(window.Percentile(9'900'000, 0), 50);
  EXPECT_EQ(window.Percentile(9'900'000, 100), 99);
  EXPECT_NEAR(window.Percentile(9'900'000, 50), 75, 1);
  EXPECT_EQ(window.Rate(20'000'000), 0);
  EXPECT_EQ(window.Percentile(20'000'000, 50), 0);
}

TEST(RollingWindow, CountsTheRateFromTheFirstValue) {
  RollingWindow window;
  for (int i = 0; i <= 30; ++i) window.Add(1'000'000'000 + i * 66'667, 1);  // 15 a second for 2 s
  EXPECT_NEAR(window.Rate(1'002'000'000), 15, 1);
}

}  // namespace
}  // namespace coach
