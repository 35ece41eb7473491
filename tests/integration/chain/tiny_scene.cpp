#include "tiny_scene.h"

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/imaging/scene_folder.h"
#include "tests/support/test_meshes.h"

namespace coach {

void WriteTinyScene(const std::filesystem::path& folder, int frames) {
  SceneWriter writer(folder);
  for (int i = 0; i < frames; ++i) {
    Frame frame;
    frame.camera = {160, 120, 130, 130, 79.5, 59.5, {}};
    frame.colour = cv::Mat(120, 160, CV_8UC3, cv::Scalar(150, 160, 170));
    frame.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(700));
    const cv::Rect box(50 + i % 20, 50, 23, 12);  // 120 x 60 mm at 670 mm
    cv::rectangle(frame.colour, box, cv::Scalar(170, 60, 20), cv::FILLED);
    cv::rectangle(frame.depth, box, cv::Scalar(670), cv::FILLED);
    writer.Write(frame);
  }
  WritePly(folder / "box.ply", BoxMesh({0.12, 0.06, 0.03}), 1000);
  std::ofstream(folder / "task.yaml")
      << "name: slide\nunits: mm\nparts:\n"
         "  - {type: box, count: 1, mesh: box.ply, mesh_units: mm, bop_id: 1, colour: blue, "
         "hsv: {low: [100, 100, 40], high: [125, 255, 255]}}\n";
}

}  // namespace coach
