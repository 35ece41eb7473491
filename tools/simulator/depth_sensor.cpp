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

/// The unit-depth ray through a pixel, and how squarely it meets a surface there.
struct InfraredRays {
  InfraredRays(const CameraModel& camera, const Matrix3& R_WI)
      : dx((R_WI.col(0) / camera.fx).cast<float>()),
        dy((R_WI.col(1) / camera.fy).cast<float>()),
        corner((R_WI * Vector3(-camera.cx / camera.fx, -camera.cy / camera.fy, 1)).cast<float>()) {}
  /// Cosine between the ray and the normal, 0..1.
  float Facing(const Hits& hits, int x, int y, size_t k) const {
    const Eigen::Vector3f ray = corner + static_cast<float>(x) * dx + static_cast<float>(y) * dy;
    const Eigen::Vector3f n(hits.normal_x[k], hits.normal_y[k], hits.normal_z[k]);
    return std::abs(n.dot(ray)) / ray.norm();
  }
  Eigen::Vector3f dx, dy, corner;
};

bool IsHole(float field, double share) { return share > 0 && 0.5 * (1 + std::erf(field / std::sqrt(2.0))) < share; }

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
      edge_(measured_.size()),
      nearest_of_column_(static_cast<size_t>(3 * colour.width)),
      rows_(static_cast<size_t>(4 * colour.width)) {}

Pose DepthSensor::X_CI() const {
  const double shift = options_.kind == DepthSensorOptions::Kind::kPerfect ? 0 : -options_.colour_baseline;
  return MakePose(Matrix3::Identity(), Vector3(shift, 0, 0));
}

cv::Mat DepthSensor::Measure(const Hits& hits, const Matrix3& R_WI, const std::vector<double>& holes, Random& random) {
  std::fill(measured_.begin(), measured_.end(), 0.0f);
  MarkEdges(hits);
  coarse_.Draw(random, table_);
  wobble_x_.Draw(random, table_);
  wobble_y_.Draw(random, table_);
  switch (options_.kind) {
    case DepthSensorOptions::Kind::kStructuredLight:
      StructuredLight(hits, R_WI, holes, random);
      break;
    case DepthSensorOptions::Kind::kTimeOfFlight:
      TimeOfFlight(hits, R_WI, holes, random);
      break;
    case DepthSensorOptions::Kind::kPerfect:
      std::copy(hits.z.begin(), hits.z.end(), measured_.begin());
      break;
  }
  return Register();
}

// A miss has z = 0, which makes an edge with whatever is beside it.
void DepthSensor::MarkEdges(const Hits& hits) {
  std::fill(edge_.begin(), edge_.end(), uint8_t{0});
  const size_t width = static_cast<size_t>(hits.width);
  for (size_t y = 1; y + 1 < static_cast<size_t>(hits.height); ++y) {
    const float* z = &hits.z[y * width];
    for (size_t x = 1; x + 1 < width; ++x) {
      const float far = std::max({std::abs(z[x - 1] - z[x]), std::abs(z[x + 1] - z[x]),
                                  std::abs(*(z + x - width) - z[x]), std::abs(z[x + width] - z[x])});
      edge_[y * width + x] = far > kStep * z[x] ? 1 : 0;
    }
  }
}

// A pixel is in the projector's shadow if a nearer surface of its row takes the same projector column.
void DepthSensor::MarkShadows(const Hits& hits) {
  const float fb = static_cast<float>(infrared_.fx * options_.projector_baseline);
  const int offset = 2 * hits.width;  // near surfaces have columns left of the image
  for (int y = 0; y < hits.height; ++y) {
    std::fill(nearest_of_column_.begin(), nearest_of_column_.end(), 0.0f);
    const size_t start = static_cast<size_t>(y * hits.width);
    const auto column = [&](int x, float disparity) {
      return static_cast<size_t>(
          std::clamp(Nearest(static_cast<float>(x) - disparity) + offset, 1, 3 * hits.width - 2));
    };
    for (int x = 0; x < hits.width; ++x) {
      if (hits.body[start + static_cast<size_t>(x)] < 0) continue;
      const float d = fb / hits.z[start + static_cast<size_t>(x)];
      const size_t c = column(x, d);
      for (size_t j = c - 1; j <= c + 1; ++j) nearest_of_column_[j] = std::max(nearest_of_column_[j], d);
    }
    for (int x = 0; x < hits.width; ++x) {
      const size_t k = start + static_cast<size_t>(x);
      if (hits.body[k] < 0) continue;
      const float d = fb / hits.z[k];
      shadow_[k] = nearest_of_column_[column(x, d)] > d + 1.2f ? 1 : 0;
    }
  }
}

void DepthSensor::StructuredLight(const Hits& hits, const Matrix3& R_WI, const std::vector<double>& holes,
                                  Random& random) {
  MarkShadows(hits);
  hole_field_.Draw(random, table_);
  const float fb = static_cast<float>(infrared_.fx * options_.projector_baseline);
  const float noise = static_cast<float>(options_.noise * options_.disparity_noise);
  const float wobble = static_cast<float>(options_.noise * options_.edge_noise);
  const float step = static_cast<float>(options_.disparity_step);
  const size_t white = random.Bits(), chance = random.Bits();
  const InfraredRays rays(infrared_, R_WI);
  float *wobble_x = rows_.data(), *wobble_y = wobble_x + hits.width, *coarse = wobble_y + hits.width,
        *hole = coarse + hits.width;
  for (int y = 0; y < hits.height; ++y) {
    wobble_x_.Row(y, hits.width, wobble_x);
    wobble_y_.Row(y, hits.width, wobble_y);
    coarse_.Row(y, hits.width, coarse);
    hole_field_.Row(y, hits.width, hole);
    for (int x = 0; x < hits.width; ++x) {
      const size_t k = static_cast<size_t>(y * hits.width + x);
      // Edges are not where they are: the matching window belongs to one side or the other.
      const int sx = std::clamp(x + Nearest(wobble * wobble_x[x]), 0, hits.width - 1);
      const int sy = std::clamp(y + Nearest(wobble * wobble_y[x]), 0, hits.height - 1);
      const size_t s = static_cast<size_t>(sy * hits.width + sx);
      const int body = hits.body[s];
      if (body < 0 || shadow_[k] || shadow_[s]) continue;
      const float z = hits.z[s];
      const float luck = table_.At(chance, k);
      if (edge_[s] && luck > 0.1f) continue;
      const float facing = rays.Facing(hits, sx, sy, s);
      if (facing < 0.12f + 0.05f * luck || luck > 3.3f) continue;
      if (IsHole(hole[x], holes[static_cast<size_t>(body)])) continue;
      const float spread = noise * (0.75f * coarse[x] + 0.65f * table_.At(white, k)) * (0.7f + 0.3f / facing);
      const float disparity = static_cast<float>(Nearest((fb / z + spread) / step)) * step;
      if (disparity <= 0) continue;
      const float measured = fb / disparity;
      if (measured > options_.nearest && measured < options_.farthest) measured_[k] = measured;
    }
  }
}

void DepthSensor::TimeOfFlight(const Hits& hits, const Matrix3& R_WI, const std::vector<double>& holes,
                               Random& random) {
  hole_field_.Draw(random, table_);
  const size_t white = random.Bits(), chance = random.Bits();
  const float noise = static_cast<float>(options_.noise);
  const InfraredRays rays(infrared_, R_WI);
  float *coarse = rows_.data(), *hole = coarse + hits.width;
  for (int y = 0; y < hits.height; ++y) {
    coarse_.Row(y, hits.width, coarse);
    hole_field_.Row(y, hits.width, hole);
    for (int x = 0; x < hits.width; ++x) {
      const size_t k = static_cast<size_t>(y * hits.width + x);
      const int body = hits.body[k];
      if (body < 0) continue;
      if (IsHole(hole[x], holes[static_cast<size_t>(body)])) continue;
      const float facing = rays.Facing(hits, x, y, k);
      float z = hits.z[k];
      if (edge_[k]) {
        // A pixel that sees two surfaces reads something between them, or nothing.
        const float luck = table_.At(chance, k);
        if (luck > 0) continue;
        const size_t other = x + 1 < hits.width && hits.body[k + 1] >= 0 ? k + 1 : k;
        z += std::min(0.5f, -0.25f * luck) * (hits.z[other] - z);
      }
      if (facing < 0.06f) continue;
      z += noise * (0.0012f + 0.0012f * z * z / std::max(0.2f, facing)) *
           (0.5f * coarse[x] + 0.85f * table_.At(white, k));
      if (z > options_.nearest && z < options_.farthest) measured_[k] = z;
    }
  }
}

// Every measured point goes to the colour pixel that sees it; the nearest of several stays.
cv::Mat DepthSensor::Register() const {
  cv::Mat depth(colour_.height, colour_.width, CV_16UC1, cv::Scalar(0));
  const float scale_x = static_cast<float>(colour_.fx / infrared_.fx);
  const float offset_x = static_cast<float>(colour_.cx - infrared_.cx * colour_.fx / infrared_.fx);
  const float shift = static_cast<float>(X_CI().translation().x() * colour_.fx);
  for (int y = 0; y < infrared_.height; ++y) {
    const double v = (y - infrared_.cy) / infrared_.fy * colour_.fy + colour_.cy;
    const int row = static_cast<int>(std::lround(v));
    if (row < 0 || row >= colour_.height) continue;
    uint16_t* out = depth.ptr<uint16_t>(row);
    const float* measured = &measured_[static_cast<size_t>(y * infrared_.width)];
    for (int x = 0; x < infrared_.width; ++x) {
      const float z = measured[x];
      if (z <= 0) continue;
      const int column = Nearest(static_cast<float>(x) * scale_x + offset_x + shift / z);
      if (column < 0 || column >= colour_.width) continue;
      const uint16_t mm = static_cast<uint16_t>(1000 * z + 0.5f);
      if (out[column] == 0 || mm < out[column]) out[column] = mm;
    }
  }
  return depth;
}

}  // namespace coach
