#include "tools/evaluate/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>

namespace coach {
namespace {

constexpr double kWidth = 860, kHeight = 380, kLeft = 70, kRight = 20, kTop = 40, kBottom = 60;
constexpr std::array<const char*, 6> kColours{"#1b62a5", "#d9480f", "#2b8a3e", "#862e9c", "#5c4a1e", "#c2255c"};

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

struct Axes {
  explicit Axes(const Plot& p) : plot(p) {
    low = 1e300, high = -1e300;
    for (const PlotSeries& s : p.series) {
      for (const double x : s.x) low = std::min(low, x), high = std::max(high, x);
    }
    if (!(low < high)) low = 0, high = 1;
  }
  double X(double x) const {
    return kLeft + (std::clamp(x, low, high) - low) / (high - low) * (kWidth - kLeft - kRight);
  }
  double Y(double y) const {
    y = std::clamp(y, plot.y_low, plot.y_high);
    const double part = plot.log_y ? std::log(y / plot.y_low) / std::log(plot.y_high / plot.y_low)
                                   : (y - plot.y_low) / (plot.y_high - plot.y_low);
    return kHeight - kBottom - part * (kHeight - kTop - kBottom);
  }
  const Plot& plot;
  double low, high;
};

/// 1, 2 or 5 times a power of ten, about `count` steps over the range.
double TickStep(double range, int count) {
  const double raw = range / count, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double m : {1.0, 2.0, 5.0}) {
    if (raw <= m * power) return m * power;
  }
  return 10 * power;
}

std::vector<double> YTicks(const Plot& plot) {
  std::vector<double> ticks;
  if (plot.log_y) {
    for (double t = std::pow(10, std::ceil(std::log10(plot.y_low) - 1e-9)); t <= plot.y_high * 1.0001; t *= 10)
      ticks.push_back(t);
  } else {
    const double step = TickStep(plot.y_high - plot.y_low, 5);
    for (double t = std::ceil(plot.y_low / step) * step; t <= plot.y_high * 1.0001; t += step) ticks.push_back(t);
  }
  return ticks;
}

void Text(std::ostream& out, double x, double y, const std::string& anchor, const std::string& text,
          const std::string& more = "") {
  out << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\" " << more << ">" << Escaped(text)
      << "</text>\n";
}

void Line(std::ostream& out, const Axes& axes, const PlotSeries& series, const char* colour) {
  bool open = false;
  out << "<path fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"1.4\" d=\"";
  for (size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.y[i])) {
      open = false;
      continue;
    }
    out << (open ? "L" : "M") << axes.X(series.x[i]) << " " << axes.Y(series.y[i]) << " ";
    open = true;
  }
  out << "\"/>\n";
}

std::string Label(double x) {
  std::ostringstream text;
  text << std::setprecision(4) << x;
  return text.str();
}

}  // namespace

std::string ToSvg(const Plot& plot) {
  const Axes axes(plot);
  std::ostringstream out;
  out << std::fixed << std::setprecision(1);
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kWidth << " " << kHeight
      << "\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  for (const PlotBand& band : plot.bands) {
    out << "<rect x=\"" << axes.X(band.from) << "\" y=\"" << kTop << "\" width=\""
        << std::max(1.0, axes.X(band.to) - axes.X(band.from)) << "\" height=\"" << kHeight - kTop - kBottom
        << "\" fill=\"" << band.colour << "\"/>\n";
  }
  for (const double t : YTicks(plot)) {
    out << "<path stroke=\"#ddd\" d=\"M" << kLeft << " " << axes.Y(t) << "H" << kWidth - kRight << "\"/>\n";
    Text(out, kLeft - 6, axes.Y(t) + 4, "end", Label(t));
  }
  const double step = TickStep(axes.high - axes.low, 8);
  for (double t = std::ceil(axes.low / step) * step; t <= axes.high + 1e-9; t += step) {
    out << "<path stroke=\"#ddd\" d=\"M" << axes.X(t) << " " << kTop << "V" << kHeight - kBottom << "\"/>\n";
    Text(out, axes.X(t), kHeight - kBottom + 16, "middle", Label(t));
  }
  out << "<rect x=\"" << kLeft << "\" y=\"" << kTop << "\" width=\"" << kWidth - kLeft - kRight << "\" height=\""
      << kHeight - kTop - kBottom << "\" fill=\"none\" stroke=\"#888\"/>\n";
  for (size_t i = 0; i < plot.series.size(); ++i) {
    const char* colour = kColours[i % kColours.size()];
    Line(out, axes, plot.series[i], colour);
    const double x = kLeft + 8 + 190 * static_cast<double>(i % 4), y = kHeight - 22 + 14 * static_cast<double>(i / 4);
    out << "<path stroke-width=\"3\" stroke=\"" << colour << "\" d=\"M" << x << " " << y - 4 << "h16\"/>\n";
    Text(out, x + 20, y, "start", plot.series[i].name);
  }
  Text(out, kLeft, 24, "start", plot.title, "font-size=\"15\"");
  if (!plot.bands_legend.empty()) Text(out, kWidth - kRight, 24, "end", plot.bands_legend, "fill=\"#666\"");
  Text(out, kWidth - kRight, kHeight - kBottom + 32, "end", plot.x_label);
  Text(out, 16, kTop + 100, "middle", plot.y_label, "transform=\"rotate(-90 16 140)\"");
  out << "</svg>\n";
  return out.str();
}

void WriteSvg(const std::filesystem::path& file, const Plot& plot) {
  std::ofstream out(file, std::ios::binary);
  out << ToSvg(plot);
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": can't be written");
}

}  // namespace coach
