#include "tools/report/plots.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/report/numbers.h"
#include "tools/report/svg.h"

namespace coach {
namespace {

constexpr double kWidth = 520, kHeight = 220, kLeft = 52, kRight = 10, kTop = 30, kBottom = 42;
constexpr int kColours = 6;  // line-0 .. line-5 of the style sheet

int Digits(double step) { return std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9))); }

struct Frame {
  double x_low = 0, x_high = 1, y_high = 1;
  double X(double x) const { return kLeft + (x - x_low) / (x_high - x_low) * (kWidth - kLeft - kRight); }
  double Y(double y) const { return kTop + (1 - std::clamp(y / y_high, 0.0, 1.0)) * (kHeight - kTop - kBottom); }

  std::string Draw(const std::string& title, const std::string& y_label, double least_step = 0) const {
    std::string out = svg::Text(0, 14, title, "plot-title");
    const double step = std::max(least_step, svg::RoundStep(y_high, 5));
    for (double y = 0; y <= y_high * (1 + 1e-9); y += step)
      out += svg::Line(kLeft, Y(y), kWidth - kRight, Y(y), "grid") +
             svg::Text(kLeft - 6, Y(y) + 4, Fixed(y, Digits(step)), "label");
    return out + svg::Text(0, kTop - 3, y_label, "unit");
  }
};

std::string Named(const std::string& title, const std::string& content) {
  return svg::Picture(kWidth, kHeight, title, content);
}

}  // namespace

std::string LinePlot(const std::string& title, const std::string& y_label, const std::vector<PlotLine>& lines,
                     std::optional<double> bound) {
  Frame frame;
  frame.x_high = frame.y_high = 0;
  for (const PlotLine& line : lines) {
    for (const auto& [x, y] : line.points) {
      frame.x_high = std::max(frame.x_high, x);
      if (std::isfinite(y)) frame.y_high = std::max(frame.y_high, y);
    }
  }
  if (bound) frame.y_high = std::max(frame.y_high, *bound);
  frame.y_high = frame.y_high > 0 ? 1.05 * frame.y_high : 1;
  if (!(frame.x_high > 0)) frame.x_high = 1;
  std::string out = frame.Draw(title, y_label);
  const double step = svg::RoundTimeStep(frame.x_high, 8);
  for (double t = 0; t <= frame.x_high + 1e-9; t += step)
    out += svg::Text(frame.X(t), kHeight - kBottom + 16, Clock(t), "tick");
  if (bound) out += svg::Line(kLeft, frame.Y(*bound), kWidth - kRight, frame.Y(*bound), "bound");
  double key = kLeft;
  for (size_t i = 0; i < lines.size(); ++i) {
    const std::string style = "line line-" + std::to_string(i % kColours);
    std::vector<std::pair<double, double>> run;
    for (const auto& [x, y] : lines[i].points) {
      if (std::isfinite(y)) {
        run.emplace_back(frame.X(x), frame.Y(y));
      } else {
        out += svg::Path(std::exchange(run, {}), false, style);
      }
    }
    out += svg::Path(run, false, style);
    out += svg::Line(key, kHeight - 8, key + 14, kHeight - 8, style) +
           svg::Text(key + 18, kHeight - 4, lines[i].name, "key-name");
    key += 30 + 6.2 * static_cast<double>(lines[i].name.size());
  }
  return Named(title, out);
}

std::string BarPlot(const std::string& title, const std::string& x_label, const std::vector<Bar>& bars) {
  Frame frame;
  for (const Bar& bar : bars) frame.y_high = std::max(frame.y_high, bar.value);
  frame.y_high = std::max(1.0, 1.1 * frame.y_high);
  std::string out = frame.Draw(title, "", 1);
  const double width = (kWidth - kLeft - kRight) / static_cast<double>(std::max<size_t>(1, bars.size()));
  const size_t every = bars.size() > 12 ? (bars.size() + 11) / 12 : 1;
  for (size_t i = 0; i < bars.size(); ++i) {
    const double x = kLeft + static_cast<double>(i) * width, y = frame.Y(bars[i].value);
    out += svg::Rect(x + 0.08 * width, y, 0.84 * width, kHeight - kBottom - y, "bar",
                     bars[i].name + ": " + Fixed(bars[i].value, 0));
    if (i % every == 0) out += svg::Text(x + width / 2, kHeight - kBottom + 16, bars[i].name, "tick");
  }
  return Named(title, out + svg::Text(kLeft + (kWidth - kLeft - kRight) / 2, kHeight - 6, x_label, "tick"));
}

std::string Histogram(const std::string& title, const std::string& x_label, const std::vector<double>& values,
                      double low, double high) {
  const double width = svg::RoundStep(high - low, 20);
  const auto first = static_cast<int>(std::floor(low / width)), last = static_cast<int>(std::ceil(high / width)) - 1;
  std::vector<Bar> bars;
  for (int bin = first; bin <= last; ++bin) bars.push_back({Fixed(bin * width, Digits(width)), 0});
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    const int bin = static_cast<int>(std::floor(std::clamp(v / width, -1e6, 1e6)));
    bars[static_cast<size_t>(std::clamp(bin, first, last) - first)].value += 1;
  }
  return BarPlot(title, x_label, bars);
}

}  // namespace coach
