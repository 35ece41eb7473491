// How far the table reaches: the cells of the table plane on which readings were seen, connected to its middle.
#pragma once

#include <array>
#include <vector>

#include "common/geometry/pose.h"
#include "services/pose_filter/observation.h"

namespace coach {

class TableArea {
 public:
  /// Adds what one frame shows (every 8th pixel). Cheap enough for every frame; once a second is plenty for a fixed
  /// camera.
  void Add(const Observation& observation, const Pose& X_TC);
  /// Whether a point of the table frame lies over the table or within 15 cm of it. True for everything before the first
  /// Add.
  bool Over(const Vector3& p_T) const;
  void Reset() { *this = TableArea(); }

 private:
  static constexpr int kCells = 80;      // each way
  static constexpr double kCell = 0.05;  // m
  static constexpr int kMargin = 3;      // cells
  static int Index(double v) { return static_cast<int>(std::floor(v / kCell)) + kCells / 2; }

  std::array<uint16_t, kCells * kCells> count_{};
  std::array<bool, kCells * kCells> over_{};
  bool known_ = false;
  std::vector<int> stack_;
};

}  // namespace coach
