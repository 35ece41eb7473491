// The camera's motion over the table, from the static background: the table, boxes on it, walls.
//
// Point-to-plane ICP with projective association between the frame and points kept in the table frame (as in
// KinectFusion's tracking, Newcombe et al., ISMAR 2011, but on a few thousand points of keyframes). Directions that the
// background leaves open (sliding along a bare table) are held by a weak prior on no motion.
#pragma once

#include <vector>

#include "services/pose_filter/owner_map.h"
#include "services/pose_filter/table_plane.h"

namespace coach {

struct CameraMotionOptions {
  int grid = 10;  ///< px between background points
  int iterations = 6;
  int mark_cell = 14;               ///< px; one mark of strong gradient a cell
  float least_gradient = 10;        ///< grey levels a px, of a mark
  double still_share = 0.5;         ///< of the marks unchanged: the camera stood still
  double still_position = 0.0005;   ///< m; smaller motions are none
  double still_rotation = 0.0005;   ///< rad
  double keyframe_position = 0.08;  ///< m; the background is renewed after so much motion
  double keyframe_rotation = 0.12;  ///< rad
};

class CameraMotion {
 public:
  explicit CameraMotion(const CameraMotionOptions& options = {}) : options_(options) {}

  bool started() const { return started_; }
  /// Starts from a table found in this frame.
  void Start(const Observation& observation, const TableFit& table);
  /// One frame on. `owners` says where the parts are expected: they and their colours are no background.
  /// Without depth, or with too little background, the pose stays and its covariance grows.
  void Step(const Observation& observation, const OwnerMap& owners);
  void Reset() { *this = CameraMotion(options_); }

  const Pose& X_TC() const { return X_TC_; }
  const Matrix6& covariance() const { return covariance_; }
  /// How far the camera moved in this step (identity: it stood still).
  const Pose& step() const { return step_; }
  const TableFit& table() const { return table_; }
  bool table_seen() const { return table_seen_; }

 private:
  struct BackgroundPoint {
    Vector3 p_T;
    Vector3 n_T;
  };
  /// A place of strong gradient.
  struct Mark {
    int x = 0, y = 0;  // px in the keyframe
    float grey = 0;
    float gx = 0, gy = 0;  // grey levels a px
    float gradient = 0;    // their length
    Vector3 p_T;
  };
  void AddMarks(const Observation& observation, const OwnerMap* owners);
  void AddBrightness(const Observation& observation, const Pose& X_TC, double blend, Matrix6& H, Vector6& g) const;
  bool StoodStill(const Observation& observation) const;
  void AddKeyframe(const Observation& observation, const OwnerMap* owners);
  bool Align(const Observation& observation, const Pose& start, Pose& X_TC, Matrix6& information, int& used) const;

  CameraMotionOptions options_;
  bool started_ = false;
  Pose X_TC_ = Pose::Identity();
  Pose step_ = Pose::Identity();
  Pose keyframe_X_TC_ = Pose::Identity();
  Matrix6 covariance_ = Matrix6::Identity() * 1e-6;
  TableFit table_;
  bool table_seen_ = false;
  std::vector<BackgroundPoint> background_;
  std::vector<Mark> marks_;
  bool at_keyframe_ = false;  // the camera has not moved since the marks were taken
  mutable std::vector<float> changes_, sorted_;
};

}  // namespace coach
