// Depth of one part at one pose, rendered into the piece of the image that it covers.
#pragma once

#include <vector>

#include "common/geometry/camera.h"
#include "services/pose_filter/part_model.h"

namespace coach {

/// A window of the image sampled at every step-th pixel. Sample (i, j) is pixel (x0 + i * step, y0 + j * step); x0 and
/// y0 are multiples of step, so tiles of the same step lie on one grid.
struct DepthTile {
  int x0 = 0, y0 = 0;         ///< px
  int width = 0, height = 0;  ///< samples
  int step = 1;               ///< px
  std::vector<float> depth;   ///< m along the optical axis; 0: not covered
  int covered = 0;            ///< samples with a depth

  float At(int i, int j) const { return depth[static_cast<size_t>(j) * width + i]; }
  /// Depth at a pixel, 0 outside the tile; the nearest sample at or before it.
  float AtPixel(int x, int y) const {
    const int i = (x - x0) / step, j = (y - y0) / step;
    if (x < x0 || y < y0 || i >= width || j >= height) return 0;
    return At(i, j);
  }
};

/// Renders into `tile`, whose buffer is reused (no allocation once it is large enough). Triangles with a vertex nearer
/// than 5 cm are left out. `margin` widens the window by so many pixels. The tile may be empty (part outside the
/// image).
void RenderTile(const PartModel& model, const CameraModel& camera, const Pose& X_CP, int step, int margin,
                DepthTile& tile);

/// Level of detail: the step, a multiple of `least`, at which a part at this distance gets some hundred samples and not
/// more, however large it is in the image.
int SampleStep(const PartModel& model, const CameraModel& camera, const Pose& X_CP, int least);

/// Part of the silhouette that lies inside the image, 0..1, by projected surface samples.
double InImageFraction(const PartModel& model, const CameraModel& camera, const Pose& X_CP);

}  // namespace coach
