#include "tools/operator/outline.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

namespace coach {
namespace {

constexpr double kNearest = 0.05;    // m; closer geometry is not drawn
constexpr int kShift = 4;            // fractional bits of cv::fillConvexPoly's corners
constexpr double kTolerance = 0.75;  // px; how far a simplified outline may leave the mask's border
constexpr double kSmallest = 3;      // px^2; specks of the mask that are no outline

using ProjectedTriangle = std::array<Eigen::Vector2d, 3>;

/// Outlines of the union of triangles given in pixels, within [0, width) x [0, height).
std::vector<Polygon> OutlineOfUnion(const std::vector<ProjectedTriangle>& triangles, int width, int height) {
  Eigen::Vector2d low(width, height), high(-1, -1);
  for (const auto& triangle : triangles) {
    for (const auto& p : triangle) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const int left = std::clamp(static_cast<int>(std::floor(low.x())), 0, width);
  const int top = std::clamp(static_cast<int>(std::floor(low.y())), 0, height);
  const int right = std::clamp(static_cast<int>(std::ceil(high.x())) + 1, 0, width);
  const int bottom = std::clamp(static_cast<int>(std::ceil(high.y())) + 1, 0, height);
  if (right <= left || bottom <= top) return {};

  cv::Mat mask = cv::Mat::zeros(bottom - top, right - left, CV_8UC1);
  const double limit = 1 << 20;  // px; keeps far-off corners inside cv::Point's range
  for (const auto& triangle : triangles) {
    std::array<cv::Point, 3> corners;
    for (size_t k = 0; k < 3; ++k) {
      corners[k] = {cvRound(std::clamp(triangle[k].x() - left, -limit, limit) * (1 << kShift)),
                    cvRound(std::clamp(triangle[k].y() - top, -limit, limit) * (1 << kShift))};
    }
    cv::fillConvexPoly(mask, corners.data(), 3, cv::Scalar(255), cv::LINE_8, kShift);
  }

  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE, {left, top});
  std::vector<Polygon> outlines;
  for (const auto& contour : contours) {
    if (contour.size() < 3 || cv::contourArea(contour) < kSmallest) continue;
    std::vector<cv::Point> simple;
    cv::approxPolyDP(contour, simple, kTolerance, true);
    Polygon polygon;
    for (const auto& p : simple) polygon.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
    if (polygon.size() >= 3) outlines.push_back(std::move(polygon));
  }
  return outlines;
}

TriangleMesh OnGrid(const TriangleMesh& mesh, const Vector3& low, double cell) {
  TriangleMesh simple;
  std::map<std::array<int, 3>, int> nodes;
  std::vector<int> node_of;
  node_of.reserve(mesh.vertices.size());
  for (const auto& p : mesh.vertices) {
    const Eigen::Array3i index = ((p - low) / cell).array().round().cast<int>();
    const auto [place, fresh] =
        nodes.try_emplace({index.x(), index.y(), index.z()}, static_cast<int>(simple.vertices.size()));
    if (fresh) simple.vertices.push_back(p);
    node_of.push_back(place->second);
  }
  for (const auto& t : mesh.triangles) {
    const std::array<int, 3> moved{node_of[t[0]], node_of[t[1]], node_of[t[2]]};
    if (moved[0] != moved[1] && moved[1] != moved[2] && moved[2] != moved[0]) simple.triangles.push_back(moved);
  }
  return simple;
}

}  // namespace

TriangleMesh Simplified(const TriangleMesh& mesh, size_t max_triangles) {
  if (mesh.triangles.size() <= max_triangles) return mesh;
  const MeshExtent extent = Extent(mesh);
  for (int cells = 128; cells > 2; cells = cells * 3 / 4) {
    TriangleMesh simple = OnGrid(mesh, extent.low, extent.diameter / cells);
    if (simple.triangles.size() <= max_triangles) return simple;
  }
  return OnGrid(mesh, extent.low, extent.diameter / 2);
}

std::vector<Polygon> Silhouette(const TriangleMesh& mesh, const Pose& X_CP, const CameraModel& camera) {
  std::vector<Vector3> points;
  std::vector<Eigen::Vector2d> pixels;
  points.reserve(mesh.vertices.size());
  pixels.reserve(mesh.vertices.size());
  for (const auto& p_P : mesh.vertices) {
    points.push_back(X_CP * p_P);
    pixels.push_back(points.back().z() > kNearest ? camera.Project(points.back()) : Eigen::Vector2d::Zero());
  }
  std::vector<ProjectedTriangle> visible;
  for (const auto& t : mesh.triangles) {
    const size_t a = static_cast<size_t>(t[0]), b = static_cast<size_t>(t[1]), c = static_cast<size_t>(t[2]);
    if (points[a].z() <= kNearest || points[b].z() <= kNearest || points[c].z() <= kNearest) continue;
    if ((points[b] - points[a]).cross(points[c] - points[a]).dot(points[a]) >= 0) continue;  // seen from behind
    visible.push_back({pixels[a], pixels[b], pixels[c]});
  }
  return OutlineOfUnion(visible, camera.width, camera.height);
}

std::vector<Polygon> SilhouetteFromAbove(const TriangleMesh& mesh, const Pose& X_FP, double resolution) {
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (const auto& p_P : mesh.vertices) {
    points.push_back((X_FP * p_P).head<2>());
    low = low.cwiseMin(points.back());
    high = high.cwiseMax(points.back());
  }
  std::vector<ProjectedTriangle> triangles;
  const auto cell = [&](int vertex) {
    return Eigen::Vector2d((points[static_cast<size_t>(vertex)] - low) / resolution + Eigen::Vector2d(1, 1));
  };
  for (const auto& t : mesh.triangles) triangles.push_back({cell(t[0]), cell(t[1]), cell(t[2])});
  const Eigen::Vector2i size = ((high - low) / resolution).array().ceil().cast<int>() + 3;
  std::vector<Polygon> outlines = OutlineOfUnion(triangles, size.x(), size.y());
  for (auto& polygon : outlines) {
    for (auto& p : polygon) {
      p = ((p.cast<double>() - Eigen::Vector2d(1, 1)) * resolution + low).cast<float>();
    }
  }
  return outlines;
}

}  // namespace coach
