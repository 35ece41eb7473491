#include <benchmark/benchmark.h>

#include "common/assembly/task_file.h"
#include "tools/simulator/live_lesson.h"
#include "tools/simulator/simulator.h"

namespace coach {
namespace {

/// A child that builds the rectangle, before a Kinect of 640x480 pixels; argument: with the truth of every frame.
void BM_Render(benchmark::State& state) {
  ScenarioOptions options;
  options.seconds = 20;
  const Scenario scenario =
      MakeScenario(LoadTask(COACH_SOURCE_DIR "/deploy/tasks/rectangle_long_medium.yaml"), options);
  Simulator simulator(scenario.stage, options.seed);
  FrameTruth truth;
  size_t i = 0;
  for (auto _ : state) {
    const double time = scenario.frame_times[i++ % scenario.frame_times.size()];
    benchmark::DoNotOptimize(
        simulator.Render(scenario.performance, scenario.camera, time, state.range(0) ? &truth : nullptr));
  }
}
BENCHMARK(BM_Render)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace coach
