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

/// The same for particles close to one pose: only the points that are seen there take part, with the weights they have
/// there.
struct VisiblePoints {
  std::vector<float> x, y, z, weight;
};
/// @param visible indices into model.surface that are seen at X_CP; at most `most` are taken.
void SelectVisible(const PartModel& model, const Pose& X_CP, const std::vector<int>& visible, int most,
                   VisiblePoints& points);
float ScoreVisible(const VisiblePoints& points, const Observation& observation, const OwnerMap& owners, int part,
                   uint8_t class_bit, const Pose& X_CP);

}  // namespace coach
