#include "services/pose_filter/camera_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace coach {
namespace {

Vector3 BackProject(const CameraModel& c, int x, int y, double z) {
  return {(x - c.cx) / c.fx * z, (y - c.cy) / c.fy * z, z};
}

/// Normal of the surface around a pixel by a plane through 5 x 5 readings 3 px apart; zero if they lie on no one
/// surface.
Vector3 LocalNormal(const Observation& o, int x, int y, double z) {
  constexpr int kReach = 2, kStride = 3;
  Vector3 mean = Vector3::Zero();
  Matrix3 moment = Matrix3::Zero();
  int n = 0;
  for (int j = -kReach; j <= kReach; ++j) {
    for (int i = -kReach; i <= kReach; ++i) {
      const int u = x + i * kStride, v = y + j * kStride;
      if (!o.Inside(u, v)) return Vector3::Zero();
      const double d = o.Depth(u, v);
      if (d == 0 || std::abs(d - z) > 0.03 * z + 0.02) return Vector3::Zero();
      const Vector3 p = BackProject(o.camera, u, v, d);
      mean += p;
      moment += p * p.transpose();
      ++n;
    }
  }
  mean /= n;
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(moment / n - mean * mean.transpose());
  if (solver.eigenvalues()[0] > 4 * DepthSigma(z) * DepthSigma(z)) return Vector3::Zero();
  const Vector3 normal = solver.eigenvectors().col(0);
  return normal.dot(mean) > 0 ? Vector3(-normal) : normal;
}

}  // namespace

void CameraMotion::Start(const Observation& observation, const TableFit& table) {
  started_ = true;
  table_ = table;
  table_seen_ = true;
  X_TC_ = TableFrame(table.plane);
  step_ = Pose::Identity();
  covariance_ = Matrix6::Identity() * 1e-7;
  background_.clear();
  AddKeyframe(observation, nullptr);
}

void CameraMotion::AddKeyframe(const Observation& o, const OwnerMap* owners) {
  background_.clear();
  keyframe_X_TC_ = X_TC_;
  AddMarks(o, owners);
  const Plane table = PlaneOf(X_TC_);
  for (int y = options_.grid; y < o.camera.height - options_.grid; y += options_.grid) {
    for (int x = options_.grid; x < o.camera.width - options_.grid; x += options_.grid) {
      const double z = o.Depth(x, y);
      if (z == 0 || z > 4 || o.Classes(x, y) != 0 || (owners && owners->Owner(x, y) >= 0)) continue;
      const Vector3 p_C = BackProject(o.camera, x, y, z);
      const double along = table.n.dot(p_C) / z;
      if (std::abs(along) > 0.05 && std::abs(table.Height(p_C) / along) < 2.5 * DepthSigma(z)) {
        Vector3 p_T = X_TC_ * p_C;
        p_T.z() = 0;
        background_.push_back({p_T, Vector3::UnitZ()});
        continue;
      }
      const Vector3 n_C = LocalNormal(o, x, y, z);
      if (n_C.squaredNorm() > 0.5) background_.push_back({X_TC_ * p_C, X_TC_.linear() * n_C});
    }
  }
}

void CameraMotion::AddMarks(const Observation& o, const OwnerMap* owners) {
  marks_.clear();
  at_keyframe_ = true;
  if (!o.bgr || !o.depth) return;
  const int cell = options_.mark_cell;
  for (int y0 = cell; y0 + 2 * cell < o.camera.height; y0 += cell) {
    for (int x0 = cell; x0 + 2 * cell < o.camera.width; x0 += cell) {
      Mark best;
      for (int y = y0; y < y0 + cell; y += 2) {
        for (int x = x0; x < x0 + cell; x += 2) {
          const float gx = 0.5f * (o.Grey(x + 1, y) - o.Grey(x - 1, y)),
                      gy = 0.5f * (o.Grey(x, y + 1) - o.Grey(x, y - 1));
          const float g = std::sqrt(gx * gx + gy * gy);
          if (g > best.gradient) best = {x, y, o.Grey(x, y), gx, gy, g, Vector3::Zero()};
        }
      }
      if (best.gradient < options_.least_gradient) continue;
      bool part = owners && owners->Owner(best.x, best.y) >= 0;
      for (const int dx : {-4, 0, 4}) {
        for (const int dy : {-4, 0, 4}) part |= o.Classes(best.x + dx, best.y + dy) != 0;
      }
      const double z = o.Depth(best.x, best.y);
      if (part || z == 0 || z > 4) continue;
      best.p_T = X_TC_ * BackProject(o.camera, best.x, best.y, z);
      marks_.push_back(best);
    }
  }
}

bool CameraMotion::StoodStill(const Observation& o) const {
  if (!o.bgr || !at_keyframe_ || marks_.size() < 20) return false;
  changes_.clear();
  for (const Mark& m : marks_) changes_.push_back(o.Grey(m.x, m.y) - m.grey);
  std::vector<float>& sorted = sorted_;
  sorted = changes_;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const float drift = sorted[sorted.size() / 2];  // exposure and white balance
  size_t same = 0;
  for (size_t i = 0; i < marks_.size(); ++i) {
    const Mark& m = marks_[i];
    if (std::abs(changes_[i] - drift) >= 5.0f + 0.25f * m.gradient) continue;
    // The gradient too: on a speckled table all marks are darker than what moves into their place, and that looks like
    // a change of exposure.
    const float gx = 0.5f * (o.Grey(m.x + 1, m.y) - o.Grey(m.x - 1, m.y)),
                gy = 0.5f * (o.Grey(m.x, m.y + 1) - o.Grey(m.x, m.y - 1));
    same += gx * m.gx + gy * m.gy > 0.5f * m.gradient * m.gradient;
  }
  return static_cast<double>(same) > options_.still_share * static_cast<double>(marks_.size());
}

void CameraMotion::AddBrightness(const Observation& o, const Pose& X_TC, double blend, Matrix6& H, Vector6& g) const {
  if (!o.bgr) return;
  const Pose X_CT = X_TC.inverse();
  const double gate = 60 * (1 - blend) + 15 * blend;  // grey levels
  for (const Mark& m : marks_) {
    const Vector3 p = X_CT * m.p_T;
    if (p.z() < 0.1) continue;
    const double u = o.camera.fx * p.x() / p.z() + o.camera.cx, v = o.camera.fy * p.y() / p.z() + o.camera.cy;
    const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
    if (x < 1 || y < 1 || x + 2 >= o.camera.width || y + 2 >= o.camera.height) continue;
    const double a = u - x, b = v - y;
    const double g00 = o.Grey(x, y), g10 = o.Grey(x + 1, y), g01 = o.Grey(x, y + 1), g11 = o.Grey(x + 1, y + 1);
    const double grey = (1 - b) * ((1 - a) * g00 + a * g10) + b * ((1 - a) * g01 + a * g11);
    const double gu = (1 - b) * (g10 - g00) + b * (g11 - g01), gv = (1 - a) * (g01 - g00) + a * (g11 - g10);
    const double r = m.grey - grey, t = r / gate;
    if (std::abs(t) >= 1) continue;
    // d(grey) / d(p_C), then p_C moves by -R_CT (dt + w x (p_T - t_TC)).
    const Vector3 d_C =
        (gu * o.camera.fx * Vector3(1, 0, -p.x() / p.z()) + gv * o.camera.fy * Vector3(0, 1, -p.y() / p.z())) / p.z();
    const Vector3 d_T = -(X_TC.linear() * d_C);
    const Vector3 arm = m.p_T - X_TC.translation();
    Vector6 J;
    J.head<3>() = d_T;
    J.tail<3>() = arm.cross(d_T);
    const double w = (1 - t * t) * (1 - t * t) / (8.0 * 8.0);
    H.noalias() += w * J * J.transpose();
    g.noalias() += w * r * J;
  }
}

bool CameraMotion::Align(const Observation& o, const Pose& start, Pose& X_TC, Matrix6& information, int& used) const {
  X_TC = start;
  for (int k = 0; k < options_.iterations; ++k) {
    const double blend = static_cast<double>(k) / (options_.iterations - 1);
    const double gate_scale = 12 * (1 - blend) + 3 * blend;  // sigmas
    const Pose X_CT = X_TC.inverse();
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    used = 0;
    for (const BackgroundPoint& b : background_) {
      const Vector3 p = X_CT * b.p_T;
      if (p.z() < 0.1) continue;
      const int x = static_cast<int>(std::lround(o.camera.fx * p.x() / p.z() + o.camera.cx));
      const int y = static_cast<int>(std::lround(o.camera.fy * p.y() / p.z() + o.camera.cy));
      if (!o.Inside(x, y)) continue;
      const double z = o.Depth(x, y);
      if (z == 0) continue;
      const double sigma = DepthSigma(z);
      const Vector3 ray((x - o.camera.cx) / o.camera.fx, (y - o.camera.cy) / o.camera.fy, 1);
      const Vector3 q_T = X_TC * Vector3(z * ray);
      const Vector3 ray_T = X_TC.linear() * ray;
      const double slant = std::max(0.2, std::abs(b.n_T.dot(ray_T)));
      // Normals of surfaces other than the table are themselves estimates.
      const double s = sigma * slant * (b.n_T.z() == 1.0 ? 1.0 : 2.0);
      const double r = b.n_T.dot(b.p_T - q_T);
      const double t = r / (gate_scale * s);
      if (std::abs(t) >= 1) continue;
      const double w = (1 - t * t) * (1 - t * t) / (s * s);
      // q_T moves by dt + w x (R ray z).
      const Vector3 arm = q_T - X_TC.translation();
      Vector6 J;
      J.head<3>() = b.n_T;
      J.tail<3>() = arm.cross(b.n_T);
      H.noalias() += w * J * J.transpose();
      g.noalias() += w * r * J;
      ++used;
    }
    if (used < 100) return false;
    AddBrightness(o, X_TC, blend, H, g);
    information = H * (200.0 / std::max(200, used));  // neighbouring readings are no independent witnesses
    // Weak prior on the predicted pose holds the directions that nothing constrains.
    Matrix6 prior = Matrix6::Zero();
    prior.diagonal().head<3>().setConstant(used / (0.5 * 0.5));
    prior.diagonal().tail<3>().setConstant(used / (2.0 * 2.0));
    const Vector6 step = (H + prior).ldlt().solve(g);
    if (!step.allFinite()) return false;
    X_TC = Perturb(X_TC, step);
  }
  return true;
}

void CameraMotion::Step(const Observation& observation, const OwnerMap& owners) {
  step_ = Pose::Identity();
  table_seen_ = false;
  if (!observation.depth) {
    covariance_ += Matrix6::Identity() * 1e-7;
    return;
  }
  if (StoodStill(observation)) {
    table_seen_ = true;
    covariance_ = Matrix6::Identity() * 1e-8;
    return;
  }
  Pose aligned;
  Matrix6 information;
  int used = 0;
  if (!Align(observation, X_TC_, aligned, information, used)) {
    covariance_ += Matrix6::Identity() * 1e-6;
    return;
  }
  const Vector6 moved = Difference(X_TC_, aligned);
  const Vector3 centre_moved = aligned * Vector3(0, 0, table_.plane.d) - X_TC_ * Vector3(0, 0, table_.plane.d);
  table_seen_ = true;
  covariance_ = (information + Matrix6::Identity() * 1e2).inverse();
  if (moved.head<3>().norm() < options_.still_position && centre_moved.norm() < options_.still_position) return;
  step_ = X_TC_.inverse() * aligned;
  X_TC_ = aligned;
  at_keyframe_ = false;
  const Vector6 since = Difference(keyframe_X_TC_, X_TC_);
  if (since.head<3>().norm() > options_.keyframe_position || since.tail<3>().norm() > options_.keyframe_rotation)
    AddKeyframe(observation, &owners);
}

}  // namespace coach
