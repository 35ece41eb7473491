// The ground truth of a scene folder, for scoring only.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/geometry/pose.h"
#include "common/geometry/symmetry.h"

namespace coach {

struct TruthEvent {
  double time = 0;  ///< s
  std::string kind;
  std::string connection;
  std::vector<int> parts;
  double duration = 0;  ///< s, of a jolt
};

struct TrueObject {
  int obj_id = 0;
  std::string name;
  SymmetryGroup symmetries;
  std::vector<Vector3> surface;  ///< points on the surface, m, part frame
};

struct SceneTruth {
  std::string folder, scenario;
  double fps = 30;  ///< Hz, of image ids
  std::vector<int> image_ids;
  std::vector<TrueObject> objects;           ///< by part
  std::vector<std::vector<Pose>> X_CP;       ///< [frame][part]
  std::vector<std::vector<double>> visible;  ///< [frame][part], 0..1
  std::vector<TruthEvent> events;
  std::map<std::string, std::string> joint_class;  ///< by connection name, wrong ones too

  int frames() const { return static_cast<int>(image_ids.size()); }
  int parts() const { return static_cast<int>(objects.size()); }
  /// Parts of one object id, for each id in ascending order.
  std::vector<std::vector<int>> Kinds() const;
};

/// @throws std::runtime_error naming the file and what is wrong with it.
SceneTruth ReadSceneTruth(const std::filesystem::path& folder);

}  // namespace coach
