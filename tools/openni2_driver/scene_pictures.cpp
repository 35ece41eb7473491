#include <algorithm>
#include <chrono>

#include "common/imaging/scene_folder.h"
#include "tools/openni2_driver/picture_source.h"

namespace coach {
namespace {

class ScenePictures final : public PictureSource {
 public:
  ScenePictures(const std::filesystem::path& folder, double fps, std::optional<double> begin)
      : scene_(folder, {.fps = fps, .utime_origin = 0}), fps_(fps), begin_(begin) {}
  const CameraModel& camera() const override { return scene_.camera(0); }
  double fps() const override { return fps_; }
  Frame At(int count) override {
    if (!begin_) return scene_.Read(count % scene_.size());
    const double now = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    return scene_.Read(static_cast<int>(std::clamp((now - *begin_) * fps_, 0., scene_.size() - 1.)));
  }

 private:
  SceneReader scene_;
  double fps_;
  std::optional<double> begin_;
};

}  // namespace

std::unique_ptr<PictureSource> OpenScenePictures(const std::filesystem::path& folder, double fps,
                                                 std::optional<double> begin) {
  return std::make_unique<ScenePictures>(folder, fps, begin);
}

}  // namespace coach
