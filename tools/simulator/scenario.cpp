#include "tools/simulator/scenario.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "tools/simulator/hard_cases.h"
#include "tools/simulator/lessons.h"
#include "tools/simulator/still_scenes.h"

namespace coach {
namespace {

struct Entry {
  ScenarioName name;
  std::function<void(Making*)> make;
};

const std::vector<Entry>& Entries() {
  static const std::vector<Entry> entries{
      {{"assemble", "a lesson: the structure is built, with interludes, a mistake that is undone and a near miss"},
       Build},
      {{"ready", "the parts lie ready for a lesson, the child waits"}, Ready},
      {{"fig4", "parts lie still, the camera moves round an obstacle and is jolted (the paper's Fig. 4)"}, Fig4},
      {{"start", "all parts apart on the table, resting on any face; nobody there"}, Start},
      {{"hidden_still", "a part that lies still is fully hidden for 2 s"}, HiddenStill},
      {{"hidden_moving", "a part is moved 10 cm while it is fully hidden"}, HiddenMoving},
      {{"pass_over", "a part is carried close over an equal one, to and fro"}, PassOver},
      {{"touching", "a part is laid against an equal one, side by side and end to end"}, Touching},
      {{"fast", "a part is swung at 1.2 m/s and turned"}, Fast},
      {{"leave_return", "a part leaves the picture and comes back elsewhere"}, LeaveAndReturn},
      {{"handed_over", "parts go from hand to hand"}, HandedOver},
      {{"half_covered", "hands lie on parts and hold them"}, HalfCovered},
      {{"jolts", "a lesson before a camera on a shaky stand"}, BuildWithJolts},
      {{"shiny", "a lesson with parts whose depth is missing on 40 % of their area"}, BuildOfShinyParts},
      {{"dropped_frames",
        "a lesson at 30 Hz with every fifth frame missing, at times several in a row, and irregular time stamps"},
       Build},
      {{"slow_camera", "a lesson at 7 frames a second"}, Build},
      {{"noisy", "a lesson with twice the noise"}, BuildNoisy},
      {{"one_colour", "a lesson in which all parts have the colour of the first"}, BuildOfOneColour},
  };
  return entries;
}

/// Frames at a steady rate; dropped_frames: ids of a 120 Hz clock, frames late by up to 8 ms, some missing.
void SetFrameTimes(double seconds, Making* m) {
  Scenario& s = m->scenario;
  const bool irregular = s.options.name == "dropped_frames";
  if (s.options.name == "slow_camera") s.options.fps = 7;
  s.id_rate = irregular ? 120 : s.options.fps;
  const int frames = static_cast<int>(std::floor(seconds * (irregular ? 30 : s.options.fps)));
  int missing = 0;
  for (int i = 0; i < frames; ++i) {
    int id = i;
    if (irregular) {
      if (missing == 0 && i > 0 && m->random.Chance(0.15)) missing = m->random.Chance(0.2) ? 1 + m->random.Pick(8) : 1;
      id = 4 * i + (i > 0 ? m->random.Pick(2) : 0);
    }
    if (missing > 0) {
      --missing;
      continue;
    }
    s.image_ids.push_back(id);
    s.frame_times.push_back(id / s.id_rate);
  }
}

}  // namespace

const std::vector<ScenarioName>& ScenarioNames() {
  static const std::vector<ScenarioName> names = [] {
    std::vector<ScenarioName> all;
    for (const Entry& e : Entries()) all.push_back(e.name);
    return all;
  }();
  return names;
}

Scenario MakeScenario(const Task& task, const ScenarioOptions& options) {
  const auto& entries = Entries();
  const auto entry =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name.name == options.name; });
  if (entry == entries.end()) throw std::invalid_argument("scenario: no " + options.name + "; see --list");
  Making making(task, options);
  if (options.depth_sensor == "kinect") {
    making.scenario.stage.depth.kind = DepthSensorOptions::Kind::kStructuredLight;
  } else if (options.depth_sensor == "tof") {
    making.scenario.stage.depth.kind = DepthSensorOptions::Kind::kTimeOfFlight;
  } else if (options.depth_sensor == "perfect") {
    making.scenario.stage.depth.kind = DepthSensorOptions::Kind::kPerfect;
  } else {
    throw std::invalid_argument("depth sensor: found " + options.depth_sensor + ", expected kinect, tof or perfect");
  }
  entry->make(&making);
  SetFrameTimes(options.seconds > 0 ? options.seconds : making.child->now() + 1.0, &making);
  for (const Jolt& jolt : making.scenario.camera.jolts) {
    making.scenario.performance.events.push_back({.time = jolt.time,
                                                  .kind = "jolt",
                                                  .duration = jolt.duration,
                                                  .shift = jolt.shift.norm(),
                                                  .turn = jolt.turn.norm()});
  }
  return std::move(making.scenario);
}

}  // namespace coach
