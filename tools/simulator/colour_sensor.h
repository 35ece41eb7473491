// From light to an 8-bit colour image: lens blur, exposure, white balance, noise, gamma.
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "tools/simulator/noise.h"

namespace coach {

struct ColourSensorOptions {
  double noise = 1;                   ///< factor on all noise; at 1 about 1.2 of 255 in the mid-tones
  double white_balance_drift = 0.04;  ///< amplitude of the slow change of the red and blue gains
  double exposure_drift = 0.05;       ///< amplitude of the slow change of brightness
  double drift_period = 17;           ///< s
  double blur = 0.6;                  ///< px, standard deviation
  double vignetting = 0.2;            ///< loss of light in the corners, 0..1
};

class ColourSensor {
 public:
  ColourSensor(const ColourSensorOptions& options, Random& random);

  /// @param linear CV_32FC3, blue green red, 1 = white of the exposure; changed.
  /// @returns CV_8UC3.
  cv::Mat Expose(cv::Mat* linear, double time, Random& random) const;

 private:
  ColourSensorOptions options_;
  NoiseTable table_;
  std::array<double, 3> phase_;
  std::array<float, 3> gains_;    // blue green red: fixed colour cast of the camera
  std::vector<uint8_t> gamma_;    // linear 0..1 in kLevels steps -> sRGB
  std::vector<float> deviation_;  // of the noise at each linear level
};

}  // namespace coach
