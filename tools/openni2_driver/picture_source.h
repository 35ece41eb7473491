// What a simulated OpenNI2 camera shows: a scene folder, or a child at a table that lives on while it is watched.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "common/imaging/frame.h"

namespace coach {

class PictureSource {
 public:
  virtual ~PictureSource() = default;
  virtual const CameraModel& camera() const = 0;
  virtual double fps() const = 0;  ///< Hz
  /// The picture of moment count / fps. Counts only grow; some may be left out.
  virtual Frame At(int count) = 0;
};

/// A scene folder; begins again when it is over. @throws std::runtime_error if it can't be read
/// @param begin s of the steady clock at which the scene begins, whoever looks: it stands still before, and on its last
/// frame after its end
std::unique_ptr<PictureSource> OpenScenePictures(const std::filesystem::path& folder, double fps,
                                                 std::optional<double> begin);

struct ChildOptions {
  std::filesystem::path station;  ///< station file: the task the child builds, the network on which it hears the robot
  std::string temper;             ///< listens, errs or never-listens
  uint64_t seed = 1;              ///< of room and child
  double fps = 15;                ///< Hz
  std::filesystem::path truth;    ///< folder for events.json, what really happened, written at the end; empty: none
};

/// A simulated child that hears ROBOT_COMMAND. @throws std::runtime_error if the station, the task or the network can't
/// be used
std::unique_ptr<PictureSource> OpenChildPictures(const ChildOptions& options);

}  // namespace coach
