// Depth images of one rigid part, fast enough to draw one for every particle.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/mesh.h"
#include "common/geometry/pose.h"

namespace coach {

/// The image points at which depth is compared: every step-th pixel, each way. Grid point (i, j) is image pixel
/// (step * i, step * j). A point p_C projects to (fx x / z + cx, fy y / z + cy) in grid units;
/// lens distortion is taken to be removed.
struct PixelGrid {
  int width = 0, height = 0;  ///< points
  int step = 1;               ///< px
  double fx = 0, fy = 0, cx = 0, cy = 0;

  int ImageX(int i) const { return step * i; }  ///< px
  int ImageY(int j) const { return step * j; }  ///< px
};
/// @param step at least 1, px.
PixelGrid SampledGrid(const CameraModel& camera, int step);

/// Part of a grid; empty if width or height is 0.
struct GridRectangle {
  int x = 0, y = 0, width = 0, height = 0;
  bool empty() const { return width == 0 || height == 0; }
};

/// Depths (m, along the optical axis) of a rectangle of the grid; infinity where nothing is. Memory only grows, so that
/// a tile used again allocates nothing.
struct RenderedDepth {
  static constexpr float kEmpty = std::numeric_limits<float>::infinity();

  GridRectangle area;
  int stride = 0;            ///< floats from row to row; a multiple of kPadding; the padding is kEmpty
  std::vector<float> depth;  ///< at least stride * area.height

  static constexpr int kPadding = 16;
  float* row(int j) { return depth.data() + static_cast<size_t>(j) * static_cast<size_t>(stride); }
  const float* row(int j) const { return depth.data() + static_cast<size_t>(j) * static_cast<size_t>(stride); }

  /// Sets area and stride and fills the tile with one value.
  void Reset(const GridRectangle& new_area, float value = kEmpty);
};

/// A mesh prepared for drawing. Any mesh will do; if it is closed and faces outwards, triangles that face away are
/// skipped.
class RenderMesh {
 public:
  explicit RenderMesh(const TriangleMesh& mesh);

  int num_triangles() const { return num_triangles_; }
  bool closed() const { return closed_; }
  const Vector3& low() const { return low_; }    ///< m, box in the part frame
  const Vector3& high() const { return high_; }  ///< m
  /// Coordinate `axis` of corner `corner` of every triangle, padded with zeros to a multiple of
  /// RenderedDepth::kPadding.
  const float* coordinates(int corner, int axis) const {
    return coordinates_[static_cast<size_t>(3 * corner + axis)].data();
  }
  int padded_triangles() const { return static_cast<int>(coordinates_[0].size()); }

 private:
  int num_triangles_ = 0;
  bool closed_ = false;
  Vector3 low_ = Vector3::Zero(), high_ = Vector3::Zero();
  std::array<std::vector<float>, 9> coordinates_;
};

/// What is nearer than this is not drawn. m
constexpr double kNearPlane = 0.05;

/// A rectangle of the grid that holds the whole silhouette; empty if the part is out of the image or behind the camera.
GridRectangle SilhouetteBounds(const RenderMesh& mesh, const PixelGrid& grid, const Pose& X_CP);

/// Draws the part into `tile`, which becomes `area`. A point belongs to a triangle if it is inside or within 0.001 of
/// the grid's spacing of it, so meshes have no cracks. Depths are within 1e-5 (relative) of exact.
void RenderDepth(const RenderMesh& mesh, const PixelGrid& grid, const Pose& X_CP, const GridRectangle& area,
                 RenderedDepth& tile);
/// The same with area = SilhouetteBounds.
void RenderDepth(const RenderMesh& mesh, const PixelGrid& grid, const Pose& X_CP, RenderedDepth& tile);

/// into = the nearer of both, where they overlap.
void MergeNearer(const RenderedDepth& from, RenderedDepth& into);

}  // namespace coach
