// A line plot as an SVG picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coach {

struct PlotSeries {
  std::string name;
  std::vector<double> x, y;  ///< not finite: a gap in the line
};

/// A shaded stretch of the x axis.
struct PlotBand {
  double from = 0, to = 0;
  std::string colour = "#f4c7c3";
};

struct Plot {
  std::string title, x_label, y_label;
  double y_low = 0.1, y_high = 100;  ///< what lies outside is drawn on the border
  bool log_y = true;
  std::vector<PlotSeries> series{};
  std::vector<PlotBand> bands{};
  std::string bands_legend{};  ///< what the bands mean
};

std::string ToSvg(const Plot& plot);
/// @throws std::runtime_error naming the file.
void WriteSvg(const std::filesystem::path& file, const Plot& plot);

}  // namespace coach
