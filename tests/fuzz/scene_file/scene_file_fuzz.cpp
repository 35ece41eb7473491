// Fuzzes the reader of scene_camera.json; the folder has the images 0 and 1.
#include <cstdlib>
#include <opencv2/core/mat.hpp>
#include <stdexcept>

#include "common/imaging/scene_folder.h"
#include "tests/fuzz/scratch_file.h"

namespace {

bool WriteImages() {
  coach::SceneWriter writer(ScratchFolder());
  coach::Frame frame;
  frame.camera = {16, 12, 15, 15, 7.5, 5.5, {}};
  frame.colour = cv::Mat::zeros(12, 16, CV_8UC3);
  frame.depth = cv::Mat::zeros(12, 16, CV_16UC1);
  writer.Write(frame);
  writer.Write(frame);
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const bool images = WriteImages();
  (void)images;
  ScratchFile("scene_camera.json", data, size);
  try {
    const coach::SceneReader scene(ScratchFolder());
    for (int i = 0; i < scene.size(); ++i) {
      if (!scene.camera(i).Problem().empty()) std::abort();
      scene.utime(i);
    }
    scene.Read(0);
  } catch (const std::runtime_error&) {
    // the only answer to a file that is wrong
  }
  return 0;
}
