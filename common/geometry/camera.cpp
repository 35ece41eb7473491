#include "common/geometry/camera.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

Eigen::Vector2d Distort(const std::array<double, 5>& k, const Eigen::Vector2d& n) {
  const double r2 = n.squaredNorm();
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double xy = n.x() * n.y();
  return {n.x() * radial + 2 * k[2] * xy + k[3] * (r2 + 2 * n.x() * n.x()),
          n.y() * radial + k[2] * (r2 + 2 * n.y() * n.y()) + 2 * k[3] * xy};
}

}  // namespace

bool CameraModel::distorted() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; });
}

Eigen::Vector2d CameraModel::Project(const Vector3& p_C) const {
  const Eigen::Vector2d n = p_C.head<2>() / p_C.z();
  const Eigen::Vector2d d = distorted() ? Distort(distortion, n) : n;
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Vector3 CameraModel::BackProject(const Eigen::Vector2d& pixel, double z) const {
  const Eigen::Vector2d d((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  Eigen::Vector2d n = d;
  if (distorted()) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector2d step = d - Distort(distortion, n);
      n += step;
      if (step.squaredNorm() < 1e-24) break;
    }
  }
  return {n.x() * z, n.y() * z, z};
}

std::string CameraModel::Problem() const {
  if (width <= 0 || height <= 0)
    return "image size " + std::to_string(width) + "x" + std::to_string(height) + " is empty";
  if (!(fx > 0) || !(fy > 0) || !std::isfinite(fx) || !std::isfinite(fy)) return "focal lengths must be positive";
  if (!(std::abs(cx - width / 2.0) < width) || !(std::abs(cy - height / 2.0) < height))
    return "principal point is not near the image";
  for (double k : distortion) {
    if (!std::isfinite(k)) return "distortion is not a number";
  }
  return {};
}

}  // namespace coach
