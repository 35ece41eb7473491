// Recorded RGB-D sessions on disk, in the layout of the BOP benchmark:
//   rgb/000000.png or .jpg (8 bit), depth/000000.png (16 bit), scene_camera.json ({"0": {"cam_K": [9 numbers, row
//   major], "depth_scale": mm per depth unit}}).
// Nothing else of a scene folder is read here: ground truth is for scoring only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "common/imaging/frame.h"

namespace coach {

/// Reads frames of a scene folder in the order of their image ids. Reading is stateless, so several threads may share
/// one.
class SceneReader {
 public:
  struct Options {
    double fps = 30;           ///< Hz; recording rate. Time runs with the image ids, so a gap in them is a gap in time
    int64_t utime_origin = 0;  ///< us; utime of the first image
  };

  /// Reads scene_camera.json and checks that every image it lists exists.
  /// @throws std::runtime_error naming the file and what is wrong with it: missing, no JSON, no frame, no usable
  /// camera.
  SceneReader(std::filesystem::path folder, const Options& options);
  explicit SceneReader(std::filesystem::path folder) : SceneReader(std::move(folder), Options()) {}

  int size() const { return static_cast<int>(entries_.size()); }  ///< frames, at least 1
  int scene_id() const { return scene_id_; }                      ///< the folder's name if it is a number, else 0
  int im_id(int index) const { return At(index).im_id; }          ///< BOP's image id
  int64_t utime(int index) const;                                 ///< us
  const CameraModel& camera(int index) const { return At(index).camera; }
  double period_us() const { return 1e6 / options_.fps; }  ///< us from one image id to the next

  /// Decodes frame `index` in [0, size()); sequence = index, received_utime = 0.
  /// @throws std::runtime_error naming the file that can't be decoded, or whose size or depth of pixels is wrong. Every
  /// image of a scene has the size of the first.
  Frame Read(int index) const;

 private:
  struct Entry {
    int im_id = 0;
    std::filesystem::path colour, depth;
    CameraModel camera;
    double metres_per_unit = 0.001;
  };
  const Entry& At(int index) const { return entries_.at(static_cast<size_t>(index)); }

  std::filesystem::path folder_;
  Options options_;
  int scene_id_ = 0;
  std::vector<Entry> entries_;
};

/// Writes a scene folder that SceneReader (and every tool of the BOP benchmark) reads.
class SceneWriter {
 public:
  struct Options {
    bool jpeg = false;      ///< colour as JPEG (4:4:4) instead of PNG
    int jpeg_quality = 95;  ///< 1..100
  };

  /// Makes the folder and its subfolders. @throws std::runtime_error naming what can't be made.
  SceneWriter(std::filesystem::path folder, const Options& options);
  explicit SceneWriter(std::filesystem::path folder) : SceneWriter(std::move(folder), Options()) {}
  ~SceneWriter();  ///< closes scene_camera.json
  SceneWriter(const SceneWriter&) = delete;
  SceneWriter& operator=(const SceneWriter&) = delete;

  /// Appends a frame; its im_id is one more than the last, from 0. Both images must be there and of the camera's
  /// size; distortion and time stamps have no place in the format and are not written.
  /// @throws std::invalid_argument for such a frame, std::runtime_error if the disk refuses.
  void Write(const Frame& frame) { Write(frame, last_im_id_ + 1); }
  /// The same with an im_id greater than those before: a gap stands for frames that are missing.
  void Write(const Frame& frame, int im_id);

 private:
  std::filesystem::path folder_;
  Options options_;
  std::ofstream cameras_;
  int last_im_id_ = -1;
};

}  // namespace coach
