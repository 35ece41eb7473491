// A drawn picture as the filter sees it: depth, colour, class map and table.
#pragma once

#include <random>
#include <vector>

#include "services/pose_filter/observation.h"
#include "services/pose_filter/owner_map.h"
#include "tests/support/test_scene.h"

namespace coach {

/// Class map of a drawn picture: its colours are exact, so no detector is needed.
inline std::vector<uint8_t> DrawnClassMap(const Task& task, const TestPicture& picture) {
  uint8_t blue = 0, green = 0;
  for (size_t t = 0; t < task.types.size(); ++t) {
    (task.types[t].hsv.low[0] > 100 ? blue : green) |= static_cast<uint8_t>(1 << task.ColourClass(static_cast<int>(t)));
  }
  std::vector<uint8_t> out(static_cast<size_t>(picture.colour.total()));
  for (size_t i = 0; i < out.size(); ++i) {
    const cv::Vec3b& c = picture.colour.ptr<cv::Vec3b>()[i];
    out[i] = c == kTestBlue ? blue : c == kTestGreen ? green : uint8_t{0};
  }
  return out;
}

/// Owns what its view points to; copies of it share the images.
struct DrawnObservation {
  TestPicture picture;
  std::vector<uint8_t> class_map;  ///< empty: no colour
  Pose X_CT = TestTable();

  DrawnObservation(const Task& task, const TestPicture& drawn, const Pose& table = TestTable())
      : picture(drawn), class_map(DrawnClassMap(task, drawn)), X_CT(table) {}

  Observation View() const {
    Observation o;
    o.camera = picture.camera;
    o.depth = picture.depth.empty() ? nullptr : picture.depth.ptr<uint16_t>();
    o.class_map = class_map.empty() ? nullptr : class_map.data();
    o.bgr = picture.colour.empty() ? nullptr : picture.colour.ptr<uint8_t>();
    o.table.n = X_CT.linear().col(2);
    o.table.d = -o.table.n.dot(X_CT.translation());
    o.has_table = true;
    return o;
  }
};

inline OwnerMap NoOwners(const CameraModel& camera) {
  OwnerMap owners;
  owners.Resize(camera);
  return owners;
}

/// A direction and length drawn by a seeded generator.
inline Vector3 RandomVector(std::mt19937_64& generator, double length) {
  std::normal_distribution<double> normal;
  return length * Vector3(normal(generator), normal(generator), normal(generator)).normalized();
}

/// Evenly spread over SO(3).
inline Matrix3 RandomRotation(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(generator), normal(generator), normal(generator), normal(generator))
      .normalized()
      .toRotationMatrix();
}

/// m and rad between two poses.
inline double PositionError(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }
inline double AngleError(const Pose& a, const Pose& b) { return RotationAngle(a.linear().transpose() * b.linear()); }
inline constexpr double kDegree = std::numbers::pi / 180;

}  // namespace coach
