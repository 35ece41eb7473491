#include "services/pose_filter/point_score.h"

#include <algorithm>
#include <cmath>

#include "services/pose_filter/score.h"

namespace coach {

PointSet MakePointSet(const PartModel& model, int points) {
  PointSet set;
  const size_t stride = std::max<size_t>(1, model.surface.size() / static_cast<size_t>(points));
  for (size_t i = stride / 2; i < model.surface.size(); i += stride) {
    const SurfacePoint& s = model.surface[i];
    set.x.push_back(static_cast<float>(s.p.x()));
    set.y.push_back(static_cast<float>(s.p.y()));
    set.z.push_back(static_cast<float>(s.p.z()));
    set.nx.push_back(static_cast<float>(s.n.x()));
    set.ny.push_back(static_cast<float>(s.n.y()));
    set.nz.push_back(static_cast<float>(s.n.z()));
  }
  return set;
}

float ScorePoints(const PointSet& points, const Observation& o, const OwnerMap& owners, int part, uint8_t class_bit,
                  const Pose& X_CP) {
  const Eigen::Matrix3f R = X_CP.linear().cast<float>();
  const Eigen::Vector3f t = X_CP.translation().cast<float>();
  const auto fx = static_cast<float>(o.camera.fx), fy = static_cast<float>(o.camera.fy);
  const float cx = static_cast<float>(o.camera.cx) + 0.5f, cy = static_cast<float>(o.camera.cy) + 0.5f;
  const auto sigma = static_cast<float>(DepthSigma(t.z()));
  float sum = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = R * Eigen::Vector3f(points.x[i], points.y[i], points.z[i]) + t;
    const Eigen::Vector3f n = R * Eigen::Vector3f(points.nx[i], points.ny[i], points.nz[i]);
    const float facing = -n.dot(p);
    if (facing <= 0 || p.z() < 0.05f) continue;
    const float w = 1 / p.z();
    const int x = static_cast<int>(std::floor(fx * p.x() * w + cx)),
              y = static_cast<int>(std::floor(fy * p.y() * w + cy));
    if (!o.Inside(x, y)) continue;
    const float other = owners.OtherDepth(x, y, part);
    if (other > 0 && other < p.z() + 0.006f) continue;
    const float cosine = facing * w;
    const float z = o.Depth(x, y);
    sum += cosine * JudgePixel(
                        p.z(), z, sigma, o.class_map != nullptr, o.Classes(x, y) & class_bit,
                        [&] { return o.OnTable(x, y, z); }, [&] { return o.LikelyDepth(x, y); })
                        .log_likelihood;
  }
  return sum;
}

void SelectVisible(const PartModel& model, const Pose& X_CP, const std::vector<int>& visible, int most,
                   VisiblePoints& points) {
  points.x.clear();
  points.y.clear();
  points.z.clear();
  points.weight.clear();
  const size_t stride =
      std::max<size_t>(1, (visible.size() + static_cast<size_t>(most) - 1) / static_cast<size_t>(most));
  for (size_t i = 0; i < visible.size(); i += stride) {
    const SurfacePoint& s = model.surface[static_cast<size_t>(visible[i])];
    const Vector3 p = X_CP * s.p;
    points.x.push_back(static_cast<float>(s.p.x()));
    points.y.push_back(static_cast<float>(s.p.y()));
    points.z.push_back(static_cast<float>(s.p.z()));
    points.weight.push_back(static_cast<float>(-(X_CP.linear() * s.n).dot(p) / p.z()));
  }
}

float ScoreVisible(const VisiblePoints& points, const Observation& o, const OwnerMap& owners, int part,
                   uint8_t class_bit, const Pose& X_CP) {
  const Eigen::Matrix3f R = X_CP.linear().cast<float>();
  const Eigen::Vector3f t = X_CP.translation().cast<float>();
  const auto fx = static_cast<float>(o.camera.fx), fy = static_cast<float>(o.camera.fy);
  const float cx = static_cast<float>(o.camera.cx) + 0.5f, cy = static_cast<float>(o.camera.cy) + 0.5f;
  const auto right = static_cast<float>(o.camera.width), bottom = static_cast<float>(o.camera.height);
  const auto sigma = static_cast<float>(DepthSigma(t.z()));
  const bool has_colour = o.class_map != nullptr;
  float sum = 0;
  for (size_t i = 0; i < points.x.size(); ++i) {
    const Eigen::Vector3f p = R * Eigen::Vector3f(points.x[i], points.y[i], points.z[i]) + t;
    if (p.z() < 0.05f) continue;
    const float w = 1 / p.z(), u = fx * p.x() * w + cx, v = fy * p.y() * w + cy;
    if (!(u >= 0 && v >= 0 && u < right && v < bottom)) continue;
    const int x = static_cast<int>(u), y = static_cast<int>(v);
    const float other = owners.OtherDepth(x, y, part);
    if (other > 0 && other < p.z() + 0.006f) continue;
    const float z = o.Depth(x, y);
    sum += points.weight[i] * JudgePixel(
                                  p.z(), z, sigma, has_colour, o.Classes(x, y) & class_bit,
                                  [&] { return o.OnTable(x, y, z); }, [&] { return o.LikelyDepth(x, y); })
                                  .log_likelihood;
  }
  return sum;
}

}  // namespace coach
