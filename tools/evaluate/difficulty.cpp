#include "tools/evaluate/difficulty.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <sstream>

#include "common/imaging/scene_folder.h"

namespace coach {
namespace {

constexpr double kMoving = 0.02;  // m/s
constexpr int kPairs = 30;

void MeasureMotion(const SceneTruth& truth, Difficulty* d) {
  std::vector<double> speeds, turns;
  for (size_t f = 1; f < truth.X_CP.size(); ++f) {
    const double dt = (truth.image_ids[f] - truth.image_ids[f - 1]) / truth.fps;
    for (size_t k = 0; k < truth.objects.size(); ++k) {
      const double speed = (truth.X_CP[f][k].translation() - truth.X_CP[f - 1][k].translation()).norm() / dt;
      if (speed < kMoving) continue;
      speeds.push_back(speed);
      turns.push_back(RotationAngle(truth.X_CP[f - 1][k].linear().transpose() * truth.X_CP[f][k].linear()) / dt * 180 /
                      M_PI);
    }
  }
  d->speed = Summarise(speeds);
  d->turning_p95 = Quantile(turns, 0.95);
}

void MeasureNoise(const SceneTruth& truth, Difficulty* d) {
  const SceneReader reader(truth.folder, {.fps = truth.fps, .utime_origin = 0});
  std::vector<double> depth, colour;
  double missing = 0, pixels = 0;
  const int step = std::max(1, reader.size() / kPairs);
  for (int f = 0; f + 1 < reader.size(); f += step) {
    const Frame a = reader.Read(f), b = reader.Read(f + 1);
    for (int y = 2; y < a.depth.rows; y += 5) {
      for (int x = 2; x < a.depth.cols; x += 5, ++pixels) {
        const int za = a.depth.at<uint16_t>(y, x), zb = b.depth.at<uint16_t>(y, x);
        missing += za == 0;
        // Two readings of a still surface differ by their noise; much more is something that moves.
        const double change = (za - zb) * a.metres_per_unit * 1000;
        if (za > 0 && zb > 0 && std::abs(change) < 30) depth.push_back(std::abs(change));
        const double grey = a.colour.at<cv::Vec3b>(y, x)[1] - b.colour.at<cv::Vec3b>(y, x)[1];
        if (std::abs(grey) < 20) colour.push_back(std::abs(grey));
      }
    }
  }
  // The mean of |difference of two normal numbers| is 1.128 standard deviations.
  d->depth_noise_mm = Summarise(depth).mean / 1.128;
  d->colour_noise = Summarise(colour).mean / 1.128;
  d->depth_missing = pixels > 0 ? 100 * missing / pixels : 0;
}

}  // namespace

Difficulty MeasureDifficulty(const SceneTruth& truth) {
  Difficulty d;
  d.name = std::filesystem::path(truth.folder).filename().string();
  d.frames = truth.frames();
  d.parts = truth.parts();
  d.seconds = (truth.image_ids.back() - truth.image_ids.front()) / truth.fps;
  const double all = static_cast<double>(d.frames) * d.parts;
  for (const auto& frame : truth.visible) {
    for (const double v : frame) {
      d.mean_visible += v / all;
      d.under_half += (v < 0.5) * 100 / all, d.under_tenth += (v < 0.1) * 100 / all, d.hidden += (v < 0.05) * 100 / all;
    }
  }
  MeasureMotion(truth, &d);
  MeasureNoise(truth, &d);
  return d;
}

std::string DifficultyTable(const std::vector<Difficulty>& scenes) {
  struct Row {
    std::string name;
    int digits;
    std::function<double(const Difficulty&)> value;
  };
  const std::vector<Row> rows{
      {"length (s)", 1, [](const Difficulty& d) { return d.seconds; }},
      {"frames", 0, [](const Difficulty& d) { return d.frames; }},
      {"parts", 0, [](const Difficulty& d) { return d.parts; }},
      {"visible fraction, mean", 2, [](const Difficulty& d) { return d.mean_visible; }},
      {"part-frames under 0.5 visible (%)", 1, [](const Difficulty& d) { return d.under_half; }},
      {"part-frames under 0.1 visible (%)", 1, [](const Difficulty& d) { return d.under_tenth; }},
      {"part-frames hidden (%)", 1, [](const Difficulty& d) { return d.hidden; }},
      {"part-frames that move over 0.02 m/s", 0, [](const Difficulty& d) { return d.speed.n; }},
      {"their speed, median (m/s)", 2, [](const Difficulty& d) { return d.speed.median; }},
      {"their speed, p95 (m/s)", 2, [](const Difficulty& d) { return d.speed.p95; }},
      {"their speed, highest (m/s)", 2, [](const Difficulty& d) { return d.speed.max; }},
      {"their turning, p95 (deg/s)", 0, [](const Difficulty& d) { return d.turning_p95; }},
      {"depth noise (mm)", 2, [](const Difficulty& d) { return d.depth_noise_mm; }},
      {"depth missing (%)", 1, [](const Difficulty& d) { return d.depth_missing; }},
      {"colour noise (of 255)", 2, [](const Difficulty& d) { return d.colour_noise; }}};
  std::ostringstream out;
  out << "| |";
  for (const Difficulty& d : scenes) out << " " << d.name << " |";
  out << "\n|---|";
  for (size_t i = 0; i < scenes.size(); ++i) out << "---|";
  out << "\n" << std::fixed;
  for (const Row& row : rows) {
    out << "| " << row.name << " |";
    for (const Difficulty& d : scenes) out << " " << std::setprecision(row.digits) << row.value(d) << " |";
    out << "\n";
  }
  return out.str();
}

}  // namespace coach
