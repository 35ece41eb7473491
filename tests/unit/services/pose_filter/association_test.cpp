#include "services/pose_filter/association.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace coach {
namespace {

double Cost(const std::vector<int>& assignment, int columns, const std::vector<double>& cost) {
  double sum = 0;
  for (size_t r = 0; r < assignment.size(); ++r) {
    if (assignment[r] >= 0) sum += cost[r * static_cast<size_t>(columns) + static_cast<size_t>(assignment[r])];
  }
  return sum;
}

/// Tries every assignment of the smaller side.
double CheapestByTrial(int rows, int columns, const std::vector<double>& cost) {
  const int large = std::max(rows, columns), small = std::min(rows, columns);
  std::vector<int> order(static_cast<size_t>(large));
  std::iota(order.begin(), order.end(), 0);
  double best = 1e300;
  do {
    double sum = 0;
    for (int i = 0; i < small; ++i) {
      const int r = rows <= columns ? i : order[static_cast<size_t>(i)];
      const int c = rows <= columns ? order[static_cast<size_t>(i)] : i;
      sum += cost[static_cast<size_t>(r * columns + c)];
    }
    best = std::min(best, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(SolveAssignment, AsCheapAsTheBestOfAllAssignments) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-5, 100);
  for (int rows = 1; rows <= 6; ++rows) {
    for (int columns = 1; columns <= 6; ++columns) {
      for (int k = 0; k < 5; ++k) {
        std::vector<double> cost(static_cast<size_t>(rows * columns));
        for (double& c : cost) c = k == 0 ? std::round(uniform(generator) / 50) : uniform(generator);
        const auto assignment = SolveAssignment(rows, columns, cost);
        ASSERT_EQ(assignment.size(), static_cast<size_t>(rows));
        std::vector<int> used;
        for (const int c : assignment) {
          if (c >= 0) used.push_back(c);
        }
        EXPECT_EQ(used.size(), static_cast<size_t>(std::min(rows, columns)));
        std::sort(used.begin(), used.end());
        EXPECT_EQ(std::adjacent_find(used.begin(), used.end()), used.end());
        EXPECT_NEAR(Cost(assignment, columns, cost), CheapestByTrial(rows, columns, cost), 1e-9);
      }
    }
  }
  EXPECT_EQ(SolveAssignment(2, 0, {}), (std::vector<int>{-1, -1}));
  EXPECT_TRUE(SolveAssignment(0, 3, {}).empty());
}

Task TwoBlueOneGreen() {
  Task task;
  task.types.resize(2);
  task.types[1].hsv.low = {50, 50, 50};
  task.parts = {{"blue_1", 0}, {"blue_2", 0}, {"green_1", 1}};
  return task;
}

Detections WithRegions(const std::vector<std::tuple<int, int, float>>& class_area_x) {
  Detections d;
  d.width = 640;
  d.height = 480;
  for (const auto& [colour_class, area, x] : class_area_x) {
    Region region;
    region.colour_class = colour_class;
    region.area = area;
    region.centroid = {x, 100};
    d.regions.push_back(region);
  }
  return d;
}

TEST(AssignRegions, NearestOfTheLargest) {
  // A third blue region, nearest to blue_1 but small, gets no part; it lowers the confidence of both.
  const auto found = AssignRegions(
      TwoBlueOneGreen(), WithRegions({{0, 1000, 400}, {0, 600, 100}, {0, 400, 395}, {1, 50, 300}, {1, 150, 9}}),
      {{{390, 100}}, {{110, 100}}, {{300, 100}}});
  EXPECT_EQ(found[0].region, 0);
  EXPECT_EQ(found[1].region, 1);
  EXPECT_DOUBLE_EQ(found[0].confidence, 1000.0 / 1400);
  EXPECT_DOUBLE_EQ(found[1].confidence, 0.6);
  EXPECT_EQ(found[2].region, 4) << "one part of its colour takes the largest region, however far";
  EXPECT_DOUBLE_EQ(found[2].confidence, 0.75);
}

TEST(AssignRegions, FewerRegionsThanParts) {
  const auto found =
      AssignRegions(TwoBlueOneGreen(), WithRegions({{0, 1000, 400}}), {{{100, 100}}, {{380, 100}}, std::nullopt});
  EXPECT_EQ(found[0].region, -1);
  EXPECT_EQ(found[0].confidence, 0);
  EXPECT_EQ(found[1].region, 0);
  EXPECT_DOUBLE_EQ(found[1].confidence, 1);
  EXPECT_EQ(found[2].region, -1);
}

TEST(AssignRegions, NeverSeenPartTakesWhatIsLeft) {
  const auto found = AssignRegions(TwoBlueOneGreen(), WithRegions({{0, 1000, 400}, {0, 900, 100}}),
                                   {std::nullopt, {{390, 100}}, std::nullopt});
  EXPECT_EQ(found[1].region, 0);
  EXPECT_EQ(found[0].region, 1);
}

}  // namespace
}  // namespace coach
