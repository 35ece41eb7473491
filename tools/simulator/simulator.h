// A simulated lesson as a camera sees it: frames with their truth, at any time.
#pragma once

#include <memory>
#include <vector>

#include "common/assembly/task.h"
#include "common/imaging/frame.h"
#include "tools/simulator/camera_path.h"
#include "tools/simulator/colour_sensor.h"
#include "tools/simulator/depth_sensor.h"
#include "tools/simulator/performance.h"
#include "tools/simulator/room.h"

namespace coach {

/// A movable thing that is no part: a box that hides something.
struct Prop {
  TriangleMesh mesh;
  Material material;
};

/// Everything that does not change while the lesson goes on.
struct Stage {
  Task task;
  Room room;
  std::vector<Material> part_materials;  ///< by part
  std::vector<Prop> props;               ///< things after the parts
  bool child = true;                     ///< somebody sits there
  CameraModel camera;
  DepthSensorOptions depth;
  ColourSensorOptions colour;
};

/// What is true of one part in one frame.
struct PartTruth {
  Pose X_CP = Pose::Identity();
  int pixels = 0;           ///< its silhouette when nothing hides it, also outside the image
  int pixels_in_image = 0;  ///< of them
  int pixels_visible = 0;
  std::array<int, 4> box{-1, -1, -1, -1};          ///< px: left, top, width, height of the silhouette
  std::array<int, 4> visible_box{-1, -1, -1, -1};  ///< of what is visible
  double visible_fraction() const { return pixels > 0 ? static_cast<double>(pixels_visible) / pixels : 0; }
};

struct FrameTruth {
  Pose X_WC = Pose::Identity();
  std::vector<PartTruth> parts;
  cv::Mat part_at;  ///< CV_8UC1: 1 + index of the part that a pixel shows, 0 none
};

/// Renders a Stage and a Performance. Frames depend on the seed and on the frames rendered before (noise), nothing
/// else.
class Simulator {
 public:
  Simulator(Stage stage, uint64_t seed);
  ~Simulator();

  /// @param time s @returns a frame with utime = time; `truth` may be null.
  Frame Render(const Performance& performance, const CameraPath& path, double time, FrameTruth* truth);
  const Stage& stage() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace coach
