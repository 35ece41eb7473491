// Pieces of the image that no tracked part explains: parts' colours without a part, and things above the table that are
// no part.
#pragma once

#include <vector>

#include "common/assembly/part_poses.h"
#include "services/pose_filter/observation.h"
#include "services/pose_filter/owner_map.h"
#include "services/pose_filter/table_area.h"
#include "services/pose_filter/table_plane.h"

namespace coach {

/// A connected piece of one colour class, on a grid of Blob::kStep pixels.
struct Blob {
  static constexpr int kStep = 4;  ///< px
  int colour_class = 0;            ///< -1: of any colour
  int cells = 0;                   ///< kStep x kStep pixels each
  bool touches_border = false;
  Eigen::Vector2d centre{0, 0};         ///< px
  Vector3 p_C = Vector3::Zero();        ///< m, mean of its readings; zero if it has none
  int readings = 0;                     ///< cells with depth
  std::vector<Eigen::Vector2i> pixels;  ///< the cells' pixels
};

struct BlobOptions {
  int least_cells = 6;            ///< smaller ones are dropped
  double highest = 0.60;          ///< m above the table; what is farther off is the room
  double lowest = -0.02;          ///< m
  double farthest = 3.0;          ///< m from the camera
  double depth_step = 0.04;       ///< m; neighbours farther apart belong to different blobs
  double surface_height = 0.012;  ///< m above the table, from which on a surface is that of a thing
  double surface_step = 0.012;    ///< m; neighbours farther apart are different things
  int least_surface_cells = 30;   ///< smaller things are dropped
};

/// Finds blobs of class pixels outside the silhouettes in `owners` (cells of a part whose class is `colour_class` are
/// explained, with one cell of slack). X_TC places the table; only what is over `area` counts. Output is in a fixed
/// order: by class, then scan order.
class BlobFinder {
 public:
  explicit BlobFinder(const BlobOptions& options = {}) : options_(options) {}

  /// @param class_of_part colour class of each part
  const std::vector<Blob>& FindUnexplained(const Observation& observation, const OwnerMap& owners,
                                           const std::vector<int>& class_of_part, int num_classes, const Pose& X_TC,
                                           const TableArea& area);

  /// Blobs of whatever stands on the table and is no tracked part, by depth alone; their colour_class is -1.
  const std::vector<Blob>& FindSurfaces(const Observation& observation, const OwnerMap& owners, const Pose& X_TC,
                                        const TableArea& area);

 private:
  void Resize(const CameraModel& camera);
  void Flood(const Observation& observation, uint8_t bit, double depth_step, int start, Blob& blob);

  BlobOptions options_;
  int width_ = 0, height_ = 0;
  std::vector<uint8_t> open_;  // per cell: bits of classes that are unexplained
  std::vector<float> depth_;
  std::vector<int> stack_;
  std::vector<Blob> blobs_;
};

/// Things in a part's colour that are no part: what stays unexplained at one place while every part is tracked
/// elsewhere.
class Distractors {
 public:
  /// Called with the blobs of a frame in which every part was seen. Places that recur become known; places without a
  /// blob fade.
  void Remember(const std::vector<Blob>& blobs, const Pose& X_TC);
  /// Whether a blob is one of them: at the same place and not larger.
  bool Known(const Blob& blob, const Pose& X_TC) const;

 private:
  struct Place {
    int colour_class = 0;
    Vector3 p_T = Vector3::Zero();
    int cells = 0;
    int seen = 0;
  };
  std::vector<Place> places_;
};

}  // namespace coach
