#include "common/imaging/scene_folder.h"
#include "tools/openni2_driver/picture_source.h"

namespace coach {
namespace {

class ScenePictures final : public PictureSource {
 public:
  ScenePictures(const std::filesystem::path& folder, double fps)
      : scene_(folder, {.fps = fps, .utime_origin = 0}), fps_(fps) {}
  const CameraModel& camera() const override { return scene_.camera(0); }
  double fps() const override { return fps_; }
  Frame At(int count) override { return scene_.Read(count % scene_.size()); }

 private:
  SceneReader scene_;
  double fps_;
};

}  // namespace

std::unique_ptr<PictureSource> OpenScenePictures(const std::filesystem::path& folder, double fps) {
  return std::make_unique<ScenePictures>(folder, fps);
}

}  // namespace coach
