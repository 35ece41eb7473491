#include "tools/task/congruence.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/mesh_tree.h"

namespace coach {
namespace {

constexpr int kMostTries = 20'000;
constexpr int kSurfacePoints = 200;
constexpr size_t kRevolution = 12;  // rotations about one axis that make it a free one

/// An orthonormal frame from two directions that are not parallel.
Matrix3 Frame(const Vector3& first, const Vector3& second) {
  Matrix3 R;
  R.col(0) = first.normalized();
  R.col(2) = first.cross(second).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

/// Finds whether a vertex is at a place.
class VertexGrid {
 public:
  VertexGrid(const std::vector<Vector3>& points, double tolerance) : points_(points), tolerance_(tolerance) {
    for (size_t k = 0; k < points.size(); ++k) order_.push_back(k);
    std::sort(order_.begin(), order_.end(), [&](size_t a, size_t b) { return points[a].x() < points[b].x(); });
  }
  bool Has(const Vector3& p) const {
    auto at = std::lower_bound(order_.begin(), order_.end(), p.x() - tolerance_,
                               [&](size_t k, double x) { return points_[k].x() < x; });
    for (; at != order_.end() && points_[*at].x() <= p.x() + tolerance_; ++at) {
      if ((points_[*at] - p).norm() <= tolerance_) return true;
    }
    return false;
  }

 private:
  const std::vector<Vector3>& points_;
  double tolerance_;
  std::vector<size_t> order_;
};

bool Known(const std::vector<Pose>& found, const Pose& X) {
  return std::any_of(found.begin(), found.end(),
                     [&](const Pose& Y) { return RotationAngle(Y.linear().transpose() * X.linear()) < 0.01; });
}

/// The vertex that is farthest from the middle, and the one that spans the largest triangle with it.
std::pair<Vector3, Vector3> Landmarks(const TriangleMesh& mesh, const Vector3& middle) {
  Vector3 first = Vector3::Zero(), second = Vector3::Zero();
  for (const auto& v : mesh.vertices) {
    if ((v - middle).norm() > first.norm()) first = v - middle;
  }
  for (const auto& v : mesh.vertices) {
    if (first.cross(v - middle).norm() > first.cross(second).norm()) second = v - middle;
  }
  return {first, second};
}

}  // namespace

Vector3 MiddleOf(const TriangleMesh& mesh) {
  Vector3 sum = Vector3::Zero();
  for (const auto& v : mesh.vertices) sum += v;
  return sum / static_cast<double>(mesh.vertices.size());
}

std::vector<Pose> Alignments(const TriangleMesh& a, const TriangleMesh& b, const CongruenceOptions& options) {
  std::vector<Pose> found;
  if (a.vertices.size() != b.vertices.size() || a.vertices.empty()) return found;
  const Vector3 middle_a = MiddleOf(a), middle_b = MiddleOf(b);
  const auto [first, second] = Landmarks(a, middle_a);
  const VertexGrid grid(b.vertices, options.tolerance);
  const MeshTree tree(b);
  const auto samples = SampleSurface(a, kSurfacePoints);
  const auto lies = [&](const Pose& X) {
    return std::all_of(a.vertices.begin(), a.vertices.end(), [&](const Vector3& v) { return grid.Has(X * v); }) &&
           std::all_of(samples.begin(), samples.end(),
                       [&](const SurfacePoint& s) { return tree.Closest(X * s.p).distance <= options.tolerance; });
  };
  const auto near = [&](double x, double y) { return std::abs(x - y) <= 2 * options.tolerance; };
  int tries = 0;
  for (const auto& w1 : b.vertices) {
    const Vector3 one = w1 - middle_b;
    if (!near(one.norm(), first.norm())) continue;
    for (const auto& w2 : b.vertices) {
      const Vector3 two = w2 - middle_b;
      if (!near(two.norm(), second.norm()) || !near((two - one).norm(), (second - first).norm())) continue;
      if (++tries > kMostTries) return found;
      const Matrix3 R = Frame(one, two) * Frame(first, second).transpose();
      const Pose X = MakePose(R, middle_b - R * middle_a);
      if (!R.allFinite() || Known(found, X) || !lies(X)) continue;
      found.push_back(X);
      if (static_cast<int>(found.size()) >= options.most) return found;
    }
  }
  return found;
}

SymmetryGroup SymmetriesOf(const TriangleMesh& mesh, const CongruenceOptions& options) {
  std::vector<Matrix3> rotations;
  for (const Pose& X : Alignments(mesh, mesh, options)) rotations.push_back(X.linear());
  const auto axis_of = [](const Matrix3& R) { return LogRotation(R).normalized(); };
  for (const Matrix3& R : rotations) {
    if (RotationAngle(R) < 0.01) continue;
    const Vector3 axis = axis_of(R);
    const auto about = static_cast<size_t>(std::count_if(rotations.begin(), rotations.end(), [&](const Matrix3& other) {
      return RotationAngle(other) > 0.01 && std::abs(axis_of(other).dot(axis)) > 0.999;
    }));
    if (about + 1 < kRevolution) continue;
    const auto flip = std::find_if(rotations.begin(), rotations.end(),
                                   [&](const Matrix3& other) { return (other * axis).dot(axis) < -0.999; });
    return MakeSymmetryGroup(flip == rotations.end() ? std::vector<Matrix3>{} : std::vector<Matrix3>{*flip}, {axis});
  }
  return MakeSymmetryGroup(rotations, {});
}

}  // namespace coach
