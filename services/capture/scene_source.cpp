#include "services/capture/scene_source.h"

namespace coach {

SceneSource::SceneSource(const std::filesystem::path& folder, double fps)
    : scene_(folder, {.fps = fps, .utime_origin = 0}) {}

FrameSource::Outcome SceneSource::Next(Frame& frame, int) {
  if (next_ == scene_.size()) return Outcome::kEnd;
  const int index = next_++;
  frame = scene_.Read(index);
  return Outcome::kFrame;
}

}  // namespace coach
