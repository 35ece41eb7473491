#include "tools/report/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace coach {
namespace {

TEST(Statistics, OfKnownNumbers) {
  EXPECT_DOUBLE_EQ(Mean({1, 2, 6}), 3);
  EXPECT_DOUBLE_EQ(Deviation({2, 4, 4, 4, 5, 5, 7, 9}), std::sqrt(32.0 / 7));
  EXPECT_DOUBLE_EQ(Median({5, 1, 3}), 3);
  EXPECT_DOUBLE_EQ(Median({4, 1, 3, 2}), 2.5);
  EXPECT_DOUBLE_EQ(Quantile({10, 20, 30, 40, 50}, 0.9), 46);
  EXPECT_TRUE(std::isnan(Mean({})) && std::isnan(Median({})) && std::isnan(Deviation({1})));
}

TEST(Statistics, WilsonsIntervalOfPublishedExamples) {
  // Newcombe 1998, Table I, method 3.
  const auto check = [](double k, double n, double low, double high) {
    const auto i = WilsonInterval(k, n);
    ASSERT_TRUE(i);
    EXPECT_NEAR(i->low, low, 5e-5);
    EXPECT_NEAR(i->high, high, 5e-5);
  };
  check(81, 263, 0.2553, 0.3662);
  check(15, 148, 0.0624, 0.1605);
  check(0, 20, 0, 0.1611);
  check(1, 29, 0.0061, 0.1718);
  EXPECT_FALSE(WilsonInterval(0, 0));
}

TEST(Statistics, BootstrapCoversTheTruthAsOftenAsItSays) {
  std::mt19937 random(5);
  std::normal_distribution<double> draw(10, 3);
  int covered = 0;
  for (int study = 0; study < 200; ++study) {
    std::vector<double> values(40);
    for (double& v : values) v = draw(random);
    const auto mean = [&](const std::vector<size_t>& drawn) {
      double sum = 0;
      for (const size_t i : drawn) sum += values[i];
      return sum / static_cast<double>(drawn.size());
    };
    const auto interval = BootstrapInterval(values.size(), mean, {1, 400});
    ASSERT_TRUE(interval);
    covered += interval->low <= 10 && 10 <= interval->high;
  }
  EXPECT_GE(covered, 178);  // of 200; 95 % would be 190
  EXPECT_LE(covered, 199);
}

TEST(Statistics, BootstrapIsRepeatableAndKnowsWhenItCannot) {
  const auto first = [](const std::vector<size_t>& drawn) { return static_cast<double>(drawn[0]); };
  const auto a = BootstrapInterval(9, first, {7, 300}), b = BootstrapInterval(9, first, {7, 300});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->low, b->low);
  EXPECT_EQ(a->high, b->high);
  EXPECT_FALSE(BootstrapInterval(1, first));
  EXPECT_FALSE(BootstrapInterval(9, [](const auto&) { return std::nan(""); }));
}

}  // namespace
}  // namespace coach
