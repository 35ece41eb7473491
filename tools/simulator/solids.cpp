#include "tools/simulator/solids.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

constexpr double kSkin = 0.0015;  // m
constexpr int kPoints = 240;

/// True if p is inside the convex hull of the points by at least `margin`.
bool InHull(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& p, double margin) {
  // p is inside if no line through p has all points on one side: look at the angles.
  for (int i = 0; i < 72; ++i) {
    const double a = 2 * M_PI * i / 72;
    const Eigen::Vector2d out(std::cos(a), std::sin(a));
    double farthest = -1e9;
    for (const auto& q : points) farthest = std::max(farthest, out.dot(q - p));
    if (farthest < margin) return false;
  }
  return true;
}

Vector3 Centroid(const TriangleMesh& mesh) {
  Vector3 sum = Vector3::Zero();
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices[static_cast<size_t>(t[0])], &b = mesh.vertices[static_cast<size_t>(t[1])],
                  &c = mesh.vertices[static_cast<size_t>(t[2])];
    const double v = a.dot(b.cross(c)) / 6;
    sum += v * (a + b + c) / 4;
    volume += v;
  }
  return std::abs(volume) > 1e-12 ? Vector3(sum / volume) : Extent(mesh).centre;
}

}  // namespace

Solids::Solids(const std::vector<TriangleMesh>& meshes) : meshes_(meshes) {
  for (const TriangleMesh& mesh : meshes_) {
    shapes_.AddMesh(mesh);
    extents_.push_back(Extent(mesh));
    std::vector<Vector3> points;
    for (const SurfacePoint& s : SampleSurface(mesh, kPoints)) points.push_back(s.p - kSkin * s.n);
    skin_.push_back(std::move(points));
  }
}

bool Solids::Overlap(int a, const Pose& X_WA, int b, const Pose& X_WB) const {
  const Pose X_BA = X_WB.inverse() * X_WA;
  const MeshExtent &ea = extent(a), &eb = extent(b);
  if ((X_BA * ea.centre - eb.centre).norm() > 0.5 * (ea.diameter + eb.diameter)) return false;
  for (const Vector3& p : skin_[static_cast<size_t>(a)]) {
    if (shapes_.Inside(b, X_BA * p)) return true;
  }
  const Pose X_AB = X_BA.inverse();
  for (const Vector3& p : skin_[static_cast<size_t>(b)]) {
    if (shapes_.Inside(a, X_AB * p)) return true;
  }
  return false;
}

double Solids::Lowest(int thing, const Matrix3& R) const {
  double low = 1e9;
  for (const Vector3& v : meshes_[static_cast<size_t>(thing)].vertices) low = std::min(low, R.row(2).dot(v));
  return low;
}

double Solids::Highest(int thing, const Matrix3& R) const {
  double high = -1e9;
  for (const Vector3& v : meshes_[static_cast<size_t>(thing)].vertices) high = std::max(high, R.row(2).dot(v));
  return high;
}

std::vector<Matrix3> Solids::Rests(int thing) const {
  const TriangleMesh& mesh = meshes_[static_cast<size_t>(thing)];
  const Vector3 centroid = Centroid(mesh);
  std::vector<Vector3> seen;
  std::vector<Matrix3> rests;
  for (size_t t = 0; t < mesh.triangles.size() && rests.size() < 24; ++t) {
    const Vector3 n = mesh.Normal(t);
    if (std::any_of(seen.begin(), seen.end(), [&](const Vector3& m) { return m.dot(n) > 0.999; })) continue;
    seen.push_back(n);
    const Matrix3 R = Eigen::Quaterniond::FromTwoVectors(n, -Vector3::UnitZ()).toRotationMatrix();
    const double low = Lowest(thing, R);
    std::vector<Eigen::Vector2d> feet;
    for (const Vector3& v : mesh.vertices) {
      const Vector3 w = R * v;
      if (w.z() < low + 2e-4) feet.emplace_back(w.x(), w.y());
    }
    const Vector3 c = R * centroid;
    if (feet.size() >= 3 && InHull(feet, {c.x(), c.y()}, 0.35 * (c.z() - low))) rests.push_back(R);
  }
  if (rests.empty()) rests.push_back(Matrix3::Identity());
  return rests;
}

}  // namespace coach
