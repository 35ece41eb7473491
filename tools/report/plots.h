// The report's other pictures, as SVG.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace coach {

struct PlotLine {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y; a y that is not finite is a gap
};

/// Lines over time (s). @param bound a dashed line at this y
std::string LinePlot(const std::string& title, const std::string& y_label, const std::vector<PlotLine>& lines,
                     std::optional<double> bound = std::nullopt);

struct Bar {
  std::string name;
  double value = 0;
};
std::string BarPlot(const std::string& title, const std::string& x_label, const std::vector<Bar>& bars);

/// How many values lie in each of some 20 bins of a round width. Those outside [low, high] are counted in the
/// outermost.
std::string Histogram(const std::string& title, const std::string& x_label, const std::vector<double>& values,
                      double low, double high);

}  // namespace coach
