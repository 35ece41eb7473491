#include "services/pose_filter/table_plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

namespace coach {
namespace {

struct Sample {
  Vector3 p;
  bool part_colour;
};

std::vector<Sample> GridSamples(const Observation& o, int grid) {
  std::vector<Sample> out;
  if (!o.depth) return out;
  const CameraModel& c = o.camera;
  for (int y = grid / 2; y < c.height; y += grid) {
    for (int x = grid / 2; x < c.width; x += grid) {
      const double z = o.Depth(x, y);
      if (z > 0.15 && z < 5) out.push_back({{(x - c.cx) / c.fx * z, (y - c.cy) / c.fy * z, z}, o.Classes(x, y) != 0});
    }
  }
  return out;
}

Plane Oriented(const Vector3& n, const Vector3& point) {
  const double d = -n.dot(point);
  return d >= 0 ? Plane{n, d} : Plane{-n, -d};
}

/// Distance from the plane along the viewing ray, which is where the noise is.
double RayResidual(const Plane& plane, const Vector3& p) {
  const double along = plane.n.dot(p) / p.z();
  return std::abs(along) < 0.05 ? 1e3 : plane.Height(p) / along;
}

Plane LeastSquares(const std::vector<Sample>& samples, const Plane& plane, double gate_sigmas) {
  Vector3 mean = Vector3::Zero();
  Matrix3 moment = Matrix3::Zero();
  double total = 0;
  for (const Sample& s : samples) {
    const double sigma = DepthSigma(s.p.z());
    const double r = std::abs(RayResidual(plane, s.p)) / (gate_sigmas * sigma);
    if (r >= 1) continue;
    const double w = (1 - r * r) * (1 - r * r) / (sigma * sigma);
    total += w;
    mean += w * s.p;
    moment += w * s.p * s.p.transpose();
  }
  if (!(total > 0)) return plane;
  mean /= total;
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(moment / total - mean * mean.transpose());
  return Oriented(solver.eigenvectors().col(0), mean);
}

std::optional<TableFit> Measure(const std::vector<Sample>& samples, const Plane& plane, const TableOptions& options) {
  TableFit fit{plane, 0, static_cast<int>(samples.size()), 0};
  std::vector<double> distances;
  for (const Sample& s : samples) {
    if (std::abs(RayResidual(plane, s.p)) < 3 * DepthSigma(s.p.z())) distances.push_back(std::abs(plane.Height(s.p)));
  }
  fit.inliers = static_cast<int>(distances.size());
  if (fit.inliers < 50 || fit.inliers < options.least_share * fit.samples) return std::nullopt;
  std::nth_element(distances.begin(), distances.begin() + fit.inliers / 2, distances.end());
  fit.residual = distances[fit.inliers / 2];
  return fit;
}

}  // namespace

std::optional<TableFit> FindTable(const Observation& observation, uint64_t seed, const TableOptions& options) {
  const std::vector<Sample> samples = GridSamples(observation, options.grid);
  const int n = static_cast<int>(samples.size());
  if (n < 50) return std::nullopt;
  std::mt19937_64 rng(seed);
  Plane best;
  double best_support = 0;
  for (int h = 0; h < options.hypotheses; ++h) {
    // Three samples within a third of the image: far ones seldom share a plane.
    const Vector3& a = samples[rng() % n].p;
    const Vector3& b = samples[rng() % n].p;
    const Vector3& c = samples[rng() % n].p;
    const Vector3 cross = (b - a).cross(c - a);
    if (cross.norm() < 0.01) continue;
    const Plane plane = Oriented(cross.normalized(), a);
    double support = 0;
    for (const Sample& s : samples) {
      if (std::abs(RayResidual(plane, s.p)) < 2.5 * DepthSigma(s.p.z())) {
        support += 1;
      } else if (s.part_colour) {
        const double height = plane.Height(s.p);
        if (height > 0 && height < 0.15) support += 5;
      }
    }
    if (support > best_support) {
      best_support = support;
      best = plane;
    }
  }
  for (const double gate : {4.0, 3.0, 2.5, 2.5}) best = LeastSquares(samples, best, gate);
  return Measure(samples, best, options);
}

std::optional<TableFit> RefineTable(const Observation& observation, const Plane& prior, const TableOptions& options) {
  const std::vector<Sample> samples = GridSamples(observation, options.grid);
  Plane plane = prior;
  for (const double gate : {4.0, 3.0, 2.5}) plane = LeastSquares(samples, plane, gate);
  return Measure(samples, plane, options);
}

Pose TableFrame(const Plane& plane) {
  // The axis (0, 0, s) meets the plane at s = -d / n_z.
  const bool meets = plane.n.z() < -0.05;
  const Vector3 origin = meets ? Vector3(0, 0, -plane.d / plane.n.z()) : Vector3(-plane.d * plane.n);
  Vector3 x = Vector3::UnitX() - plane.n.x() * plane.n;
  if (x.norm() < 1e-3) x = Vector3::UnitY() - plane.n.y() * plane.n;
  Matrix3 R_CT;
  R_CT.col(0) = x.normalized();
  R_CT.col(2) = plane.n;
  R_CT.col(1) = plane.n.cross(R_CT.col(0));
  return MakePose(R_CT, origin).inverse();
}

Plane PlaneOf(const Pose& X_TC) { return {X_TC.linear().row(2).transpose(), X_TC.translation().z()}; }

}  // namespace coach
