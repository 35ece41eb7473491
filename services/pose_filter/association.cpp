#include "services/pose_filter/association.h"

#include <algorithm>
#include <limits>

namespace coach {

std::vector<int> SolveAssignment(int rows, int columns, const std::vector<double>& cost) {
  if (rows > columns) {
    std::vector<double> transposed(cost.size());
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        transposed[static_cast<size_t>(c * rows + r)] = cost[static_cast<size_t>(r * columns + c)];
      }
    }
    const auto row_of_column = SolveAssignment(columns, rows, transposed);
    std::vector<int> result(static_cast<size_t>(rows), -1);
    for (int c = 0; c < columns; ++c) result[static_cast<size_t>(row_of_column[static_cast<size_t>(c)])] = c;
    return result;
  }
  // Rows and columns count from 1; column 0 holds the row that is being placed.
  const auto n = static_cast<size_t>(rows), m = static_cast<size_t>(columns);
  std::vector<double> row_potential(n + 1), column_potential(m + 1);
  std::vector<size_t> row_of(m + 1), previous(m + 1);
  for (size_t row = 1; row <= n; ++row) {
    row_of[0] = row;
    size_t column = 0;
    std::vector<double> slack(m + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> visited(m + 1);
    do {
      visited[column] = true;
      const size_t r = row_of[column];
      double delta = std::numeric_limits<double>::infinity();
      size_t next = 0;
      for (size_t c = 1; c <= m; ++c) {
        if (visited[c]) continue;
        const double reduced = cost[(r - 1) * m + c - 1] - row_potential[r] - column_potential[c];
        if (reduced < slack[c]) {
          slack[c] = reduced;
          previous[c] = column;
        }
        if (slack[c] < delta) {
          delta = slack[c];
          next = c;
        }
      }
      for (size_t c = 0; c <= m; ++c) {
        if (visited[c]) {
          row_potential[row_of[c]] += delta;
          column_potential[c] -= delta;
        } else {
          slack[c] -= delta;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = previous[column]) row_of[column] = row_of[previous[column]];
  }
  std::vector<int> result(n, -1);
  for (size_t c = 1; c <= m; ++c) {
    if (row_of[c] != 0) result[row_of[c] - 1] = static_cast<int>(c) - 1;
  }
  return result;
}

std::vector<RegionOfPart> AssignRegions(const Task& task, const Detections& detections,
                                        const std::vector<std::optional<Eigen::Vector2d>>& expected) {
  std::vector<RegionOfPart> result(task.parts.size());
  // More than any distance in the image: a part that was never seen has no preference.
  const double far = 2.0 * (detections.width + detections.height);
  for (int colour_class = 0; colour_class < task.NumColourClasses(); ++colour_class) {
    std::vector<int> parts, regions;
    for (size_t p = 0; p < task.parts.size(); ++p) {
      if (task.ColourClass(task.parts[p].type) == colour_class) parts.push_back(static_cast<int>(p));
    }
    for (size_t r = 0; r < detections.regions.size(); ++r) {
      if (detections.regions[r].colour_class == colour_class) regions.push_back(static_cast<int>(r));
    }
    const auto area = [&](int r) { return detections.regions[static_cast<size_t>(r)].area; };
    std::stable_sort(regions.begin(), regions.end(), [&](int a, int b) { return area(a) > area(b); });
    const size_t taken = std::min(parts.size(), regions.size());
    double unassigned = 0;
    for (size_t i = taken; i < regions.size(); ++i) unassigned += area(regions[i]);
    std::vector<double> cost;
    for (const int p : parts) {
      const auto& at = expected[static_cast<size_t>(p)];
      for (size_t i = 0; i < taken; ++i) {
        const auto& centre = detections.regions[static_cast<size_t>(regions[i])].centroid;
        cost.push_back(at ? (centre.cast<double>() - *at).norm() : far);
      }
    }
    const auto column = SolveAssignment(static_cast<int>(parts.size()), static_cast<int>(taken), cost);
    for (size_t i = 0; i < parts.size(); ++i) {
      if (column[i] < 0) continue;
      const int region = regions[static_cast<size_t>(column[i])];
      result[static_cast<size_t>(parts[i])] = {region, area(region) / (area(region) + unassigned)};
    }
  }
  return result;
}

}  // namespace coach
