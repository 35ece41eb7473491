#include "services/pose_filter/depth_tile.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

constexpr double kNear = 0.05;  // m

struct Corner {
  float x, y, w;  // px, px, 1 / depth
};

int FloorTo(double v, int step) { return static_cast<int>(std::floor(v / step)) * step; }

/// Fills samples inside one triangle with the nearer depth. 1 / z is linear in the image.
void FillTriangle(const Corner& a, const Corner& b, const Corner& c, DepthTile& tile) {
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (std::abs(area) < 1e-6f) return;
  const float inverse = 1.0f / area;
  const auto step = static_cast<float>(tile.step);
  const auto first = [&](float v, int origin) {
    return static_cast<int>(std::ceil((v - static_cast<float>(origin)) / step));
  };
  const auto last = [&](float v, int origin) {
    return static_cast<int>(std::floor((v - static_cast<float>(origin)) / step));
  };
  const int i0 = std::max(0, first(std::min({a.x, b.x, c.x}), tile.x0));
  const int i1 = std::min(tile.width - 1, last(std::max({a.x, b.x, c.x}), tile.x0));
  const int j0 = std::max(0, first(std::min({a.y, b.y, c.y}), tile.y0));
  const int j1 = std::min(tile.height - 1, last(std::max({a.y, b.y, c.y}), tile.y0));
  if (i0 > i1) return;
  // Barycentric coordinates of b and c, and 1 / z, as affine functions of the pixel.
  const float ub_x = (c.y - a.y) * inverse, ub_y = -(c.x - a.x) * inverse;
  const float uc_x = -(b.y - a.y) * inverse, uc_y = (b.x - a.x) * inverse;
  const float w_x = ub_x * (b.w - a.w) + uc_x * (c.w - a.w), w_y = ub_y * (b.w - a.w) + uc_y * (c.w - a.w);
  for (int j = j0; j <= j1; ++j) {
    const float dy = static_cast<float>(tile.y0 + j * tile.step) - a.y;
    float dx = static_cast<float>(tile.x0 + i0 * tile.step) - a.x;
    float* row = &tile.depth[static_cast<size_t>(j) * tile.width];
    for (int i = i0; i <= i1; ++i, dx += step) {
      const float ub = ub_x * dx + ub_y * dy, uc = uc_x * dx + uc_y * dy;
      if (ub < -1e-5f || uc < -1e-5f || ub + uc > 1 + 1e-5f) continue;
      const float z = 1.0f / (a.w + w_x * dx + w_y * dy);
      if (row[i] == 0 || z < row[i]) row[i] = z;
    }
  }
}

}  // namespace

void RenderTile(const PartModel& model, const CameraModel& camera, const Pose& X_CP, int step, int margin,
                DepthTile& tile) {
  thread_local std::vector<Corner> corners;
  thread_local std::vector<Vector3> points;
  corners.clear();
  points.clear();
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  for (const Vector3& v : model.mesh.vertices) {
    const Vector3 p = X_CP * v;
    points.push_back(p);
    if (p.z() < kNear) {
      corners.push_back({0, 0, -1});
      continue;
    }
    const double x = camera.fx * p.x() / p.z() + camera.cx, y = camera.fy * p.y() / p.z() + camera.cy;
    corners.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(1 / p.z())});
    x0 = std::min(x0, x);
    y0 = std::min(y0, y);
    x1 = std::max(x1, x);
    y1 = std::max(y1, y);
  }
  tile.step = step;
  tile.x0 = FloorTo(std::clamp(x0 - margin, 0.0, static_cast<double>(camera.width)), step);
  tile.y0 = FloorTo(std::clamp(y0 - margin, 0.0, static_cast<double>(camera.height)), step);
  const double right = std::min(x1 + margin, camera.width - 1.0), bottom = std::min(y1 + margin, camera.height - 1.0);
  tile.width = right < tile.x0 ? 0 : static_cast<int>(right - tile.x0) / step + 1;
  tile.height = bottom < tile.y0 ? 0 : static_cast<int>(bottom - tile.y0) / step + 1;
  if (tile.width == 0 || tile.height == 0) tile.width = tile.height = 0;
  tile.depth.assign(static_cast<size_t>(tile.width) * tile.height, 0.0f);
  if (tile.width > 0) {
    for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
      const auto& c = model.mesh.triangles[t];
      if ((X_CP.linear() * model.normals[t]).dot(points[c[0]]) >= 0) continue;  // faces away
      if (corners[c[0]].w < 0 || corners[c[1]].w < 0 || corners[c[2]].w < 0) continue;
      FillTriangle(corners[c[0]], corners[c[1]], corners[c[2]], tile);
    }
  }
  tile.covered = static_cast<int>(std::count_if(tile.depth.begin(), tile.depth.end(), [](float d) { return d > 0; }));
}

int SampleStep(const PartModel& model, const CameraModel& camera, const Pose& X_CP, int least) {
  constexpr double kSamples = 700;
  const double z = std::max(kNear, X_CP.translation().z());
  const double area = 4 * model.principal_half.x() * model.principal_half.y() * camera.fx * camera.fy / (z * z);
  return least * std::max(1, static_cast<int>(std::sqrt(area / kSamples) / least));
}

double InImageFraction(const PartModel& model, const CameraModel& camera, const Pose& X_CP) {
  int in = 0, all = 0;
  for (size_t i = 0; i < model.surface.size(); i += 8) {
    const Vector3 p = X_CP * model.surface[i].p;
    if ((X_CP.linear() * model.surface[i].n).dot(p) >= 0) continue;
    ++all;
    if (p.z() < kNear) continue;
    const double x = camera.fx * p.x() / p.z() + camera.cx, y = camera.fy * p.y() / p.z() + camera.cy;
    in += x >= 0 && y >= 0 && x <= camera.width - 1 && y <= camera.height - 1;
  }
  return all > 0 ? static_cast<double>(in) / all : 0;
}

}  // namespace coach
