// coach-track-sequence: tracks the parts of a recorded scene, lockstep, through the libraries that the services run.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>

#include "common/assembly/task_file.h"
#include "common/imaging/results_csv.h"
#include "common/imaging/scene_folder.h"
#include "services/assembly_reasoner/assembly_reasoner.h"
#include "services/detector/hsv_detector.h"
#include "services/pose_filter/full_filter.h"
#include "services/pose_filter/paper_filter.h"

namespace coach {
namespace {

struct Arguments {
  std::string scene, task, poses, states, events, timings;
  double fps = 30;
  uint64_t seed = 1;
  bool paper = false;
  int first = 0, last = -1;
};

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

std::unique_ptr<PoseFilter> MakeFilter(const Task& task, const Arguments& a) {
  if (a.paper) return std::make_unique<PaperFilter>(task, PaperFilterOptions{}, a.seed);
  return std::make_unique<FullFilter>(task, FullFilterOptions{}, a.seed, SerialFor());
}

void Run(const Arguments& a) {
  const Task task = LoadTask(a.task);
  const SceneReader reader(a.scene, {.fps = a.fps, .utime_origin = 0});
  HsvDetector detector(task);
  const std::unique_ptr<PoseFilter> filter = MakeFilter(task, a);
  PosesCsv poses(a.poses, task, reader.scene_id());
  std::unique_ptr<StatesCsv> states;
  if (!a.states.empty()) states = std::make_unique<StatesCsv>(a.states, task);
  std::unique_ptr<TimingsCsv> timings;
  if (!a.timings.empty()) timings = std::make_unique<TimingsCsv>(a.timings);
  std::unique_ptr<EventsCsv> events;
  if (!a.events.empty()) events = std::make_unique<EventsCsv>(a.events, task, reader.utime(0));
  AssemblyReasoner reasoner(task);
  ConnectionBelief belief;
  std::vector<double> filter_ms;
  for (int i = 0; i < reader.size(); ++i) {
    const Frame frame = reader.Read(i);
    const auto t0 = std::chrono::steady_clock::now();
    const Detections detections = detector.Detect(frame.colour, frame.depth, frame.metres_per_unit);
    const double detect = Seconds(t0);
    FilterInput input;
    input.utime = frame.utime;
    input.sequence = frame.sequence;
    input.camera = frame.camera;
    input.depth = frame.depth;
    input.metres_per_unit = frame.metres_per_unit;
    input.colour = frame.colour;
    input.detections = &detections;
    input.belief = &belief;
    const auto t1 = std::chrono::steady_clock::now();
    const PartPoses out = filter->Step(input);
    const double track = Seconds(t1);
    filter_ms.push_back(track * 1e3);
    ReasonerOutput reasoned = reasoner.Step(out);
    belief = std::move(reasoned.belief);
    poses.Write(reader.im_id(i), out);
    if (events) {
      for (const ConnectionEvent& e : reasoned.events) {
        GuidanceEvent g;
        g.utime = e.decided;
        g.since = e.since;
        g.kind = e.type;
        g.subject = e.name;
        g.part_a = e.part_a;
        g.part_b = e.part_b;
        g.probability = e.probability;
        events->Write(g);
      }
    }
    if (states) states->Write(reader.im_id(i), out);
    if (timings) {
      timings->Write(reader.im_id(i), "detector", detect);
      timings->Write(reader.im_id(i), "pose_filter", track);
    }
  }
  std::sort(filter_ms.begin(), filter_ms.end());
  std::cerr << "pose filter ms: median " << filter_ms[filter_ms.size() / 2] << " p99 "
            << filter_ms[filter_ms.size() * 99 / 100] << '\n';
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  CLI::App app{"Tracks the parts of a recorded RGB-D scene"};
  coach::Arguments a;
  app.add_option("scene", a.scene, "scene folder")->required();
  app.add_option("--task", a.task, "task file")->required();
  app.add_option("--poses", a.poses, "poses csv to write")->required();
  app.add_option("--states", a.states, "states csv to write");
  app.add_option("--events", a.events, "events csv to write");
  app.add_option("--timings", a.timings, "timings csv to write");
  app.add_option("--fps", a.fps, "frames a second of the recording");
  app.add_option("--seed", a.seed, "seed of every random choice");
  app.add_flag("--paper", a.paper, "the paper's algorithm by its equations");
  CLI11_PARSE(app, argc, argv);
  try {
    coach::Run(a);
  } catch (const std::exception& e) {
    std::cerr << "coach-track-sequence: " << e.what() << '\n';
    return 2;
  }
  return 0;
}
