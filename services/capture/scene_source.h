// Frames of a scene folder.
#pragma once

#include "common/imaging/scene_folder.h"
#include "services/capture/frame_source.h"

namespace coach {

class SceneSource final : public FrameSource {
 public:
  /// @param fps of the recording. @throws std::runtime_error (SceneReader's).
  SceneSource(const std::filesystem::path& folder, double fps);

  Outcome Next(Frame& frame, int timeout_ms) override;
  bool is_recording() const override { return true; }
  double period_us() const override { return scene_.period_us(); }

 private:
  SceneReader scene_;
  int next_ = 0;
};

}  // namespace coach
