#include "tools/simulator/depth_sensor.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

constexpr float kStep = 0.03f;  // m: a jump of depth that makes an edge, at 1 m

CameraModel InfraredCamera(const DepthSensorOptions& options, const CameraModel& colour) {
  if (options.kind == DepthSensorOptions::Kind::kPerfect) return colour;
  CameraModel camera = colour;
  camera.fx = camera.fy = options.infrared_focal * colour.width / 640.0;
  camera.cx = (colour.width - 1) / 2.0;
  camera.cy = (colour.height - 1) / 2.0;
  return camera;
}

/// Nearest whole number; ordinary sizes only.
int Nearest(float x) { return static_cast<int>(x + 16384.5f) - 16384; }

struct Surface {
  bool edge = false;
  float facing = 1;  // cosine between the ray and the normal
};

Surface Look(const Hits& hits, const CameraModel& camera, const Eigen::Matrix3f& R_CW, int x, int y) {
  Surface s;
  const size_t k = static_cast<size_t>(y * hits.width + x);
  const float z = hits.z[k];
  if (x > 0 && y > 0 && x + 1 < hits.width && y + 1 < hits.height) {
    for (const size_t j : {k - 1, k + 1, k - static_cast<size_t>(hits.width), k + static_cast<size_t>(hits.width)}) {
      s.edge = s.edge || hits.body[j] < 0 || std::abs(hits.z[j] - z) > kStep * z;
    }
  }
  const Eigen::Vector3f n = R_CW * Eigen::Vector3f(hits.normal_x[k], hits.normal_y[k], hits.normal_z[k]);
  const Eigen::Vector3f ray((static_cast<float>(x) - static_cast<float>(camera.cx)) / static_cast<float>(camera.fx),
                            (static_cast<float>(y) - static_cast<float>(camera.cy)) / static_cast<float>(camera.fy), 1);
  s.facing = std::abs(n.dot(ray.normalized()));
  return s;
}

}  // namespace

DepthSensor::DepthSensor(const DepthSensorOptions& options, const CameraModel& colour, Random& random)
    : options_(options),
      colour_(colour),
      infrared_(InfraredCamera(options, colour)),
      table_(random),
      coarse_(colour.width, colour.height, 5),
      wobble_x_(colour.width, colour.height, 3),
      wobble_y_(colour.width, colour.height, 3),
      hole_field_(colour.width, colour.height, 6),
      measured_(static_cast<size_t>(colour.width * colour.height)),
      shadow_(measured_.size()),
      row_(static_cast<size_t>(3 * colour.width)) {}

Pose DepthSensor::X_CI() const {
  const double shift = options_.kind == DepthSensorOptions::Kind::kPerfect ? 0 : -options_.colour_baseline;
  return MakePose(Matrix3::Identity(), Vector3(shift, 0, 0));
}

cv::Mat DepthSensor::Measure(const Hits& hits, const Matrix3& R_WI, const std::vector<double>& holes, Random& random) {
  R_IW_ = R_WI.transpose().cast<float>();
  std::fill(measured_.begin(), measured_.end(), 0.0f);
  coarse_.Draw(random, table_);
  wobble_x_.Draw(random, table_);
  wobble_y_.Draw(random, table_);
  switch (options_.kind) {
    case DepthSensorOptions::Kind::kStructuredLight:
      StructuredLight(hits, holes, random);
      break;
    case DepthSensorOptions::Kind::kTimeOfFlight:
      TimeOfFlight(hits, holes, random);
      break;
    case DepthSensorOptions::Kind::kPerfect:
      std::copy(hits.z.begin(), hits.z.end(), measured_.begin());
      break;
  }
  return Register();
}

// A pixel is in the projector's shadow if a nearer surface of its row takes the same projector column.
void DepthSensor::MarkShadows(const Hits& hits) {
  const float fb = static_cast<float>(infrared_.fx * options_.projector_baseline);
  const int offset = 2 * hits.width;  // near surfaces have columns left of the image
  for (int y = 0; y < hits.height; ++y) {
    std::fill(row_.begin(), row_.end(), 0.0f);
    const size_t start = static_cast<size_t>(y * hits.width);
    const auto column = [&](int x, float disparity) {
      return static_cast<size_t>(
          std::clamp(Nearest(static_cast<float>(x) - disparity) + offset, 1, 3 * hits.width - 2));
    };
    for (int x = 0; x < hits.width; ++x) {
      if (hits.body[start + static_cast<size_t>(x)] < 0) continue;
      const float d = fb / hits.z[start + static_cast<size_t>(x)];
      const size_t c = column(x, d);
      for (size_t j = c - 1; j <= c + 1; ++j) row_[j] = std::max(row_[j], d);
    }
    for (int x = 0; x < hits.width; ++x) {
      const size_t k = start + static_cast<size_t>(x);
      if (hits.body[k] < 0) continue;
      const float d = fb / hits.z[k];
      shadow_[k] = row_[column(x, d)] > d + 1.2f ? 1 : 0;
    }
  }
}

void DepthSensor::StructuredLight(const Hits& hits, const std::vector<double>& holes, Random& random) {
  MarkShadows(hits);
  hole_field_.Draw(random, table_);
  const float fb = static_cast<float>(infrared_.fx * options_.projector_baseline);
  const float noise = static_cast<float>(options_.noise * options_.disparity_noise);
  const float wobble = static_cast<float>(options_.noise * options_.edge_noise);
  const float step = static_cast<float>(options_.disparity_step);
  const size_t white = random.Bits(), chance = random.Bits();
  for (int y = 0; y < hits.height; ++y) {
    for (int x = 0; x < hits.width; ++x) {
      const size_t k = static_cast<size_t>(y * hits.width + x);
      // Edges are not where they are: the matching window belongs to one side or the other.
      const int sx = std::clamp(x + Nearest(wobble * wobble_x_.At(x, y)), 0, hits.width - 1);
      const int sy = std::clamp(y + Nearest(wobble * wobble_y_.At(x, y)), 0, hits.height - 1);
      const size_t s = static_cast<size_t>(sy * hits.width + sx);
      const int body = hits.body[s];
      if (body < 0 || shadow_[k] || shadow_[s]) continue;
      const float z = hits.z[s];
      const Surface look = Look(hits, infrared_, R_IW_, sx, sy);
      const float luck = table_.At(chance, k);
      if (look.edge && luck > 0.1f) continue;
      if (look.facing < 0.12f + 0.05f * luck || luck > 3.3f) continue;
      const double hole = holes[static_cast<size_t>(body)];
      if (hole > 0 && 0.5 * (1 + std::erf(hole_field_.At(x, y) / std::sqrt(2.0))) < hole) continue;
      const float spread =
          noise * (0.75f * coarse_.At(x, y) + 0.65f * table_.At(white, k)) * (0.7f + 0.3f / look.facing);
      const float disparity = static_cast<float>(Nearest((fb / z + spread) / step)) * step;
      if (disparity <= 0) continue;
      const float measured = fb / disparity;
      if (measured > options_.nearest && measured < options_.farthest) measured_[k] = measured;
    }
  }
}

void DepthSensor::TimeOfFlight(const Hits& hits, const std::vector<double>& holes, Random& random) {
  hole_field_.Draw(random, table_);
  const size_t white = random.Bits(), chance = random.Bits();
  const float noise = static_cast<float>(options_.noise);
  for (int y = 0; y < hits.height; ++y) {
    for (int x = 0; x < hits.width; ++x) {
      const size_t k = static_cast<size_t>(y * hits.width + x);
      const int body = hits.body[k];
      if (body < 0) continue;
      const Surface look = Look(hits, infrared_, R_IW_, x, y);
      const double hole = holes[static_cast<size_t>(body)];
      if (hole > 0 && 0.5 * (1 + std::erf(hole_field_.At(x, y) / std::sqrt(2.0))) < hole) continue;
      float z = hits.z[k];
      if (look.edge) {
        // A pixel that sees two surfaces reads something between them, or nothing.
        const float luck = table_.At(chance, k);
        if (luck > 0) continue;
        const size_t other = x + 1 < hits.width && hits.body[k + 1] >= 0 ? k + 1 : k;
        z += std::min(0.5f, -0.25f * luck) * (hits.z[other] - z);
      }
      if (look.facing < 0.06f) continue;
      z += noise * (0.0012f + 0.0012f * z * z / std::max(0.2f, look.facing)) *
           (0.5f * coarse_.At(x, y) + 0.85f * table_.At(white, k));
      if (z > options_.nearest && z < options_.farthest) measured_[k] = z;
    }
  }
}

// Every measured point goes to the colour pixel that sees it; the nearest of several stays.
cv::Mat DepthSensor::Register() const {
  cv::Mat depth(colour_.height, colour_.width, CV_16UC1, cv::Scalar(0));
  const double shift = X_CI().translation().x();
  for (int y = 0; y < infrared_.height; ++y) {
    const double v = (y - infrared_.cy) / infrared_.fy * colour_.fy + colour_.cy;
    const int row = static_cast<int>(std::lround(v));
    if (row < 0 || row >= colour_.height) continue;
    uint16_t* out = depth.ptr<uint16_t>(row);
    for (int x = 0; x < infrared_.width; ++x) {
      const float z = measured_[static_cast<size_t>(y * infrared_.width + x)];
      if (z <= 0) continue;
      const double u = ((x - infrared_.cx) / infrared_.fx + shift / z) * colour_.fx + colour_.cx;
      const int column = Nearest(static_cast<float>(u));
      if (column < 0 || column >= colour_.width) continue;
      const uint16_t mm = static_cast<uint16_t>(1000 * z + 0.5f);
      if (out[column] == 0 || mm < out[column]) out[column] = mm;
    }
  }
  return depth;
}

}  // namespace coach
