#include "tools/simulator/colour_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace coach {
namespace {

constexpr int kLevels = 4096;

}  // namespace

ColourSensor::ColourSensor(const ColourSensorOptions& options, Random& random)
    : options_(options), table_(random), gamma_(kLevels), deviation_(kLevels) {
  for (double& p : phase_) p = random.Uniform(0, 2 * std::numbers::pi);
  gains_ = {static_cast<float>(random.Uniform(0.92, 1.08)), 1.0f, static_cast<float>(random.Uniform(0.94, 1.1))};
  for (int i = 0; i < kLevels; ++i) {
    const double linear = static_cast<double>(i) / (kLevels - 1);
    const double s = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    gamma_[static_cast<size_t>(i)] = static_cast<uint8_t>(std::lround(255 * s));
    deviation_[static_cast<size_t>(i)] =
        static_cast<float>(options.noise * std::sqrt(1.2e-5 + 1.4e-4 * linear) * (kLevels - 1));
  }
}

cv::Mat ColourSensor::Expose(cv::Mat* linear, double time, Random& random) const {
  if (options_.blur > 0) cv::GaussianBlur(*linear, *linear, cv::Size(3, 3), options_.blur);
  const double angle = 2 * std::numbers::pi * time / options_.drift_period;
  const double exposure = 1 + options_.exposure_drift * std::sin(angle + phase_[0]);
  const float scale[3] = {static_cast<float>(exposure * gains_[0] *
                                             (1 + options_.white_balance_drift * std::sin(0.83 * angle + phase_[1]))),
                          static_cast<float>(exposure * gains_[1]),
                          static_cast<float>(exposure * gains_[2] *
                                             (1 + options_.white_balance_drift * std::sin(1.21 * angle + phase_[2])))};
  cv::Mat image(linear->rows, linear->cols, CV_8UC3);
  const float cx = 0.5f * static_cast<float>(linear->cols), cy = 0.5f * static_cast<float>(linear->rows);
  const float falloff = static_cast<float>(options_.vignetting) / (cx * cx + cy * cy);
  for (int y = 0; y < linear->rows; ++y) {
    const float* in = linear->ptr<float>(y);
    uint8_t* out = image.ptr<uint8_t>(y);
    const size_t start = random.Bits();
    const float dy = static_cast<float>(y) - cy;
    for (int x = 0; x < linear->cols; ++x) {
      const float dx = static_cast<float>(x) - cx;
      const float lens = (1 - falloff * (dx * dx + dy * dy)) * static_cast<float>(kLevels - 1);
      for (int c = 0; c < 3; ++c, ++in, ++out) {
        const float clean = std::clamp(*in * scale[c] * lens, 0.0f, static_cast<float>(kLevels - 1));
        const float noise = deviation_[static_cast<size_t>(clean)] * table_.At(start, static_cast<size_t>(3 * x + c));
        *out = gamma_[static_cast<size_t>(std::clamp(clean + noise + 0.5f, 0.0f, static_cast<float>(kLevels - 1)))];
      }
    }
  }
  return image;
}

}  // namespace coach
