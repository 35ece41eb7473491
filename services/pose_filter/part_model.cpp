#include "services/pose_filter/part_model.h"

#include <open3d/geometry/Qhull.h>
#include <open3d/geometry/TriangleMesh.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace coach {
namespace {

constexpr double kPi = std::numbers::pi;

TriangleMesh Decimate(const TriangleMesh& mesh, int most_triangles) {
  if (static_cast<int>(mesh.triangles.size()) <= most_triangles) return mesh;
  open3d::geometry::TriangleMesh in;
  in.vertices_ = mesh.vertices;
  for (const auto& t : mesh.triangles) in.triangles_.emplace_back(t[0], t[1], t[2]);
  const auto out = in.SimplifyQuadricDecimation(most_triangles, std::numeric_limits<double>::infinity(), 1.0);
  TriangleMesh result;
  result.vertices = out->vertices_;
  for (const auto& t : out->triangles_) result.triangles.push_back({t[0], t[1], t[2]});
  return result;
}

/// Edges, without those inside a flat face: they are never part of the silhouette.
std::vector<ModelEdge> FindEdges(const TriangleMesh& mesh, const std::vector<Vector3>& normals) {
  std::map<std::pair<int, int>, std::vector<std::pair<int, int>>> faces;  // edge -> (triangle, opposite vertex)
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const int a = c[k], b = c[(k + 1) % 3];
      faces[{std::min(a, b), std::max(a, b)}].push_back({static_cast<int>(t), c[(k + 2) % 3]});
    }
  }
  std::vector<ModelEdge> edges;
  for (const auto& [edge, sides] : faces) {
    const auto& first = sides.front();
    const auto& last = sides.back();
    const bool flat = sides.size() > 1 && normals[first.first].dot(normals[last.first]) > 0.9999;
    if (!flat) edges.push_back({edge.first, edge.second, first.first, last.first, first.second, last.second});
  }
  return edges;
}

struct HullFace {
  Vector3 normal;  // outward
  double area;
};

/// Flat faces of the convex hull, largest first.
std::vector<HullFace> FindHullFaces(const PartModel& model) {
  open3d::geometry::TriangleMesh in;
  in.vertices_ = model.mesh.vertices;
  for (const auto& t : model.mesh.triangles) in.triangles_.emplace_back(t[0], t[1], t[2]);
  const auto hull = std::get<0>(open3d::geometry::Qhull::ComputeConvexHull(in.vertices_));
  Vector3 centre = Vector3::Zero();
  for (const SurfacePoint& s : model.surface) centre += s.p / model.surface.size();
  std::vector<HullFace> faces;
  for (size_t t = 0; t < hull->triangles_.size(); ++t) {
    const Eigen::Vector3i c = hull->triangles_[t];
    const Vector3 cross =
        (hull->vertices_[c[1]] - hull->vertices_[c[0]]).cross(hull->vertices_[c[2]] - hull->vertices_[c[0]]);
    const double area = cross.norm() / 2;
    if (!(area > 0)) continue;
    Vector3 n = cross.normalized();
    if (n.dot(hull->vertices_[c[0]] - centre) < 0) n = -n;
    const auto same =
        std::find_if(faces.begin(), faces.end(), [&](const HullFace& f) { return f.normal.dot(n) > 0.995; });
    if (same == faces.end()) {
      faces.push_back({n, area});
    } else {
      same->area += area;
    }
  }
  std::sort(faces.begin(), faces.end(), [](const HullFace& a, const HullFace& b) { return a.area > b.area; });
  return faces;
}

/// Axes of inertia; where two moments are alike they say nothing, and the normals of the largest faces do.
Matrix3 FindAxes(const PartModel& model, const std::vector<HullFace>& faces) {
  Vector3 mean = Vector3::Zero();
  for (const SurfacePoint& s : model.surface) mean += s.p / model.surface.size();
  Matrix3 covariance = Matrix3::Zero();
  for (const SurfacePoint& s : model.surface) covariance += (s.p - mean) * (s.p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(covariance);
  const Vector3 moments = solver.eigenvalues();
  const bool distinct = moments[0] < 0.8 * moments[1] && moments[1] < 0.8 * moments[2];
  if (!distinct && !faces.empty()) {
    const Vector3 first = faces[0].normal;
    const auto second = std::find_if(faces.begin(), faces.end(), [&](const HullFace& f) {
      return std::abs(f.normal.dot(first)) < 0.05 && f.area > 0.1 * faces[0].area;
    });
    if (second != faces.end()) {
      Matrix3 axes;
      axes.col(0) = first;
      axes.col(1) = (second->normal - second->normal.dot(first) * first).normalized();
      axes.col(2) = axes.col(0).cross(axes.col(1));
      return axes;
    }
  }
  return solver.eigenvectors();
}

void FindPrincipalBox(const std::vector<HullFace>& faces, PartModel& model) {
  const Matrix3 axes = FindAxes(model, faces);
  Vector3 low = Vector3::Constant(1e9), high = -low;
  for (const SurfacePoint& s : model.surface) {
    low = low.cwiseMin(axes.transpose() * s.p);
    high = high.cwiseMax(axes.transpose() * s.p);
  }
  model.principal_centre = axes * (low + high) / 2;
  const Vector3 half = (high - low) / 2;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return half[a] > half[b]; });
  for (int i = 0; i < 3; ++i) {
    model.principal_axes.col(i) = axes.col(order[i]);
    model.principal_half[i] = half[order[i]];
  }
  if (model.principal_axes.determinant() < 0) model.principal_axes.col(2) *= -1;
}

/// Turns about the principal axes, and about the middle of the box, that leave the box nearly unchanged.
std::vector<Pose> FindNearSymmetries(const PartModel& model) {
  const Vector3& h = model.principal_half;
  const double tolerance = 0.25;
  const auto alike = [&](int i, int j) { return std::abs(h[i] - h[j]) < tolerance * std::max(h[i], h[j]); };
  std::vector<Matrix3> candidates;
  for (int axis = 0; axis < 3; ++axis) {
    const bool quarter = alike((axis + 1) % 3, (axis + 2) % 3);
    for (double turn : {0.5, 1.0, 1.5}) {
      if (turn != 1.0 && !quarter) continue;
      candidates.push_back(model.principal_axes * ExpRotation(turn * kPi * Vector3::Unit(axis)) *
                           model.principal_axes.transpose());
    }
  }
  const size_t singles = candidates.size();
  for (size_t i = 0; i < singles; ++i) {
    for (size_t j = 0; j < singles; ++j) candidates.push_back(candidates[i] * candidates[j]);
  }
  std::vector<Pose> out;
  for (const Matrix3& R : candidates) {
    const auto same = [&](const Matrix3& S) { return RotationError(model.symmetries, R, S) < 0.2; };
    if (same(Matrix3::Identity())) continue;
    if (std::any_of(out.begin(), out.end(), [&](const Pose& X) { return same(X.linear()); })) continue;
    out.push_back(MakePose(R, model.principal_centre - R * model.principal_centre));
  }
  return out;
}

/// Rotations that bring each stable face of the convex hull down onto z = 0.
std::vector<Matrix3> FindRestingRotations(const PartModel& model, std::vector<HullFace> faces) {
  if (faces.size() > 10) faces.resize(10);
  std::vector<Matrix3> out;
  for (const HullFace& f : faces) {
    if (f.area < 0.05 * faces[0].area) break;
    const Matrix3 down = Eigen::Quaterniond::FromTwoVectors(f.normal, -Vector3::UnitZ()).toRotationMatrix();
    constexpr int kTurns = 16;
    for (int i = 0; i < kTurns; ++i) {
      const Matrix3 R = ExpRotation({0, 0, 2 * kPi * i / kTurns}) * down;
      const auto same = [&](const Matrix3& S) { return RotationError(model.symmetries, R, S) < 0.1; };
      if (std::none_of(out.begin(), out.end(), same)) out.push_back(R);
    }
  }
  return out;
}

}  // namespace

std::vector<Matrix3> CoverOfRotations(double step, const SymmetryGroup& symmetries) {
  // Super-Fibonacci spirals (M. Alexa, CVPR 2022): n quaternions with almost even spacing.
  const int n = std::max(24, static_cast<int>(std::lround(8.0 * kPi * kPi / (step * step * step) * 0.75)));
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;
  std::vector<Matrix3> out;
  for (int i = 0; i < n; ++i) {
    const double s = i + 0.5, t = s / n, d = 2 * kPi * s, r = std::sqrt(t), R = std::sqrt(1 - t);
    const double alpha = d / phi, beta = d / psi;
    const Matrix3 M =
        Eigen::Quaterniond(r * std::sin(alpha), r * std::cos(alpha), R * std::sin(beta), R * std::cos(beta))
            .toRotationMatrix();
    const auto same = [&](const Matrix3& S) { return RotationError(symmetries, M, S) < 0.6 * step; };
    if (symmetries.trivial() || std::none_of(out.begin(), out.end(), same)) out.push_back(M);
  }
  return out;
}

PartModel MakePartModel(const PartType& type, const PartModelOptions& options) {
  PartModel model;
  model.mesh = Decimate(type.mesh, options.most_triangles);
  model.extent = Extent(model.mesh);
  model.symmetries = type.symmetries;
  for (size_t t = 0; t < model.mesh.triangles.size(); ++t) model.normals.push_back(model.mesh.Normal(t));
  model.edges = FindEdges(model.mesh, model.normals);
  model.surface = SampleSurface(model.mesh, options.surface_points);
  const std::vector<HullFace> faces = FindHullFaces(model);
  FindPrincipalBox(faces, model);
  model.near_symmetries = FindNearSymmetries(model);
  model.orientations = CoverOfRotations(options.orientation_step, model.symmetries);
  model.resting = FindRestingRotations(model, faces);
  return model;
}

}  // namespace coach
