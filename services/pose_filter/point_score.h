// A cheap score of many poses: sparse surface points against depth and colour, without rendering.
#pragma once

#include <vector>

#include "services/pose_filter/observation.h"
#include "services/pose_filter/owner_map.h"
#include "services/pose_filter/part_model.h"

namespace coach {

/// Surface points of a part in single precision, structure of arrays.
struct PointSet {
  std::vector<float> x, y, z, nx, ny, nz;
  size_t size() const { return x.size(); }
};
/// Every stride-th point of the model's surface.
PointSet MakePointSet(const PartModel& model, int points);

/// Sum over the points that face the camera of what the pixel under each says (JudgePixel, per point, scaled by the
/// cosine of the slant so that a point stands for its share of the image).
/// Self-occlusion is not tested: right for ranking poses, not for accepting one.
float ScorePoints(const PointSet& points, const Observation& observation, const OwnerMap& owners, int part,
                  uint8_t class_bit, const Pose& X_CP);

}  // namespace coach
