// Named scenarios: which lesson is played, in what room, before what camera.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/simulator/child.h"
#include "tools/simulator/simulator.h"

namespace coach {

struct ScenarioOptions {
  std::string name = "assemble";
  uint64_t seed = 1;
  double fps = 15;                      ///< Hz
  double seconds = 0;                   ///< s; 0: as long as the scenario takes
  std::string style = "normal";         ///< of the child: see StyleByName
  std::string depth_sensor = "kinect";  ///< kinect, tof or perfect
  int width = 640, height = 480;        ///< px
  double mistakes = 1;                  ///< wrong connections, made and undone, in a lesson (a fraction is a chance)
};

struct Scenario {
  ScenarioOptions options;
  Stage stage;
  std::vector<TriangleMesh> meshes;  ///< of the things: parts, then props
  Performance performance{{}, {}};
  CameraPath camera;
  std::vector<double> frame_times;  ///< s
  std::vector<int> image_ids;       ///< time = image id / id_rate
  double id_rate = 15;              ///< Hz
};

struct ScenarioName {
  std::string name, description;
};
const std::vector<ScenarioName>& ScenarioNames();

/// @throws std::invalid_argument naming an unknown scenario, style or sensor, or a task that the scenario can't use
/// (equal parts passing over each other need two parts of a type).
Scenario MakeScenario(const Task& task, const ScenarioOptions& options);

}  // namespace coach
