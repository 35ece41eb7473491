#include "tools/report/numbers.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coach {
namespace {

TEST(Numbers, AreWrittenWithoutSurprises) {
  EXPECT_EQ(Fixed(1.25, 1), "1.2");
  EXPECT_EQ(Fixed(-0.001, 2), "0.00");
  EXPECT_EQ(Fixed(-0.01, 2), "-0.01");
  EXPECT_EQ(Fixed(1e15, 0), "1000000000000000");
  EXPECT_EQ(Fixed(std::nan(""), 2), "");
  EXPECT_EQ(Fixed(INFINITY, 2), "");
}

TEST(Numbers, AreReadWholeOrNotAtAll) {
  EXPECT_EQ(ParseNumber(" 4.50 "), 4.5);
  EXPECT_EQ(ParseNumber("+3"), 3);
  EXPECT_EQ(ParseNumber("-2e1"), -20);
  for (const char* text : {"", " ", "4x", "1,5", "nan", "inf", "--1", "1e999"}) EXPECT_FALSE(ParseNumber(text)) << text;
}

TEST(Numbers, TimesAreMinutesAndSeconds) {
  EXPECT_EQ(Clock(754.2), "12:34");
  EXPECT_EQ(Clock(754.26, true), "12:34.3");
  EXPECT_EQ(Clock(59.96, true), "1:00.0");
  EXPECT_EQ(Clock(-5), "-0:05");
  EXPECT_EQ(Clock(std::nan("")), "");
}

TEST(Numbers, RecordedTimesAreNoDates) {
  EXPECT_EQ(Date(1'700'000'000'000'000), "2023-11-14 22:13");
  EXPECT_EQ(Date(57'000'000), "");
}

}  // namespace
}  // namespace coach
