#include "common/geometry/mesh_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace coach {
namespace {

constexpr int kLeafTriangles = 4;
constexpr int kMaxDepth = 64;
/// Distance in radii from which a node counts as one dipole.
constexpr double kFar = 3;

/// Closest point of a triangle. [Ericson, Real-Time Collision Detection, 5.1.5]
Vector3 ClosestOnTriangle(const Vector3& p, const std::array<Vector3, 3>& t) {
  const auto& [a, b, c] = t;
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

/// Solid angle of a triangle over 4 pi, positive seen from behind. [Van Oosterom and Strackee 1983]
double TriangleWinding(const Vector3& p, const std::array<Vector3, 3>& t) {
  const Vector3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return std::atan2(numerator, denominator) / (2 * std::numbers::pi);
}

double SquaredBoxDistance(const Vector3& p, const Vector3& low, const Vector3& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0).squaredNorm();
}

}  // namespace

MeshTree::MeshTree(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw std::invalid_argument("a mesh without triangles has no distance");
  for (const auto& t : mesh.triangles)
    corners_.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  triangle_.resize(corners_.size());
  std::iota(triangle_.begin(), triangle_.end(), 0);
  nodes_.reserve(corners_.size());
  Build(0, static_cast<int>(corners_.size()));
  // The corners in the order of the leaves.
  auto ordered = corners_;
  for (size_t i = 0; i < corners_.size(); ++i) ordered[i] = corners_[static_cast<size_t>(triangle_[i])];
  corners_ = std::move(ordered);
}

int MeshTree::Build(int first, int count) {
  const auto begin = triangle_.begin() + first, end = begin + count;
  const auto corners = [this](int t) -> const std::array<Vector3, 3>& { return corners_[static_cast<size_t>(t)]; };
  const auto centroid = [&](int t) -> Vector3 { return (corners(t)[0] + corners(t)[1] + corners(t)[2]) / 3; };
  Node node;
  node.low.setConstant(std::numeric_limits<double>::infinity());
  node.high = -node.low;
  node.centre.setZero();
  node.area_normal.setZero();
  double area = 0;
  Vector3 mean = Vector3::Zero();
  for (auto t = begin; t != end; ++t) {
    for (const Vector3& v : corners(*t)) {
      node.low = node.low.cwiseMin(v);
      node.high = node.high.cwiseMax(v);
    }
    const Vector3 n = 0.5 * (corners(*t)[1] - corners(*t)[0]).cross(corners(*t)[2] - corners(*t)[0]);
    node.area_normal += n;
    node.centre += n.norm() * centroid(*t);
    area += n.norm();
    mean += centroid(*t) / count;
  }
  node.centre = area > 0 ? Vector3(node.centre / area) : mean;
  for (auto t = begin; t != end; ++t) {
    for (const Vector3& v : corners(*t)) node.radius = std::max(node.radius, (v - node.centre).norm());
  }
  const int index = static_cast<int>(nodes_.size());
  if (count <= kLeafTriangles) {
    node.first = first;
    node.count = count;
    nodes_.push_back(node);
    return index;
  }
  nodes_.push_back(node);
  int axis = 0;
  (node.high - node.low).maxCoeff(&axis);
  std::nth_element(begin, begin + count / 2, end, [&](int a, int b) {
    const double ca = centroid(a)[axis], cb = centroid(b)[axis];
    return ca != cb ? ca < cb : a < b;
  });
  const int left = Build(first, count / 2), right = Build(first + count / 2, count - count / 2);
  nodes_[static_cast<size_t>(index)].left = left;
  nodes_[static_cast<size_t>(index)].right = right;
  return index;
}

ClosestPoint MeshTree::Closest(const Vector3& p) const {
  ClosestPoint best;
  double best_squared = std::numeric_limits<double>::infinity();
  std::array<int, kMaxDepth> stack{0};
  int depth = 1;
  while (depth > 0) {
    const Node& node = nodes_[static_cast<size_t>(stack[static_cast<size_t>(--depth)])];
    if (SquaredBoxDistance(p, node.low, node.high) >= best_squared) continue;
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const Vector3 q = ClosestOnTriangle(p, corners_[static_cast<size_t>(i)]);
        if (const double squared = (q - p).squaredNorm(); squared < best_squared) {
          best_squared = squared;
          best = {q, 0, triangle_[static_cast<size_t>(i)]};
        }
      }
      continue;
    }
    const Node &left = nodes_[static_cast<size_t>(node.left)], &right = nodes_[static_cast<size_t>(node.right)];
    const bool left_first = SquaredBoxDistance(p, left.low, left.high) < SquaredBoxDistance(p, right.low, right.high);
    stack[static_cast<size_t>(depth++)] = left_first ? node.right : node.left;
    stack[static_cast<size_t>(depth++)] = left_first ? node.left : node.right;
  }
  best.distance = std::sqrt(best_squared);
  return best;
}

double MeshTree::WindingNumber(const Vector3& p) const {
  double winding = 0;
  std::array<int, kMaxDepth> stack{0};
  int depth = 1;
  while (depth > 0) {
    const Node& node = nodes_[static_cast<size_t>(stack[static_cast<size_t>(--depth)])];
    const Vector3 r = node.centre - p;
    const double distance = r.norm();
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        winding += TriangleWinding(p, corners_[static_cast<size_t>(i)]);
      }
    } else if (distance > kFar * node.radius) {
      winding += node.area_normal.dot(r) / (4 * std::numbers::pi * distance * distance * distance);
    } else {
      stack[static_cast<size_t>(depth++)] = node.left;
      stack[static_cast<size_t>(depth++)] = node.right;
    }
  }
  return winding;
}

double MeshTree::SignedDistance(const Vector3& p) const {
  const double distance = Closest(p).distance;
  return WindingNumber(p) > 0.5 ? -distance : distance;
}

}  // namespace coach
