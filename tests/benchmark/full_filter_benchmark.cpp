// The whole of stage 2 and what a hypothesis costs: refinement, scoring, drawing.
#include <benchmark/benchmark.h>

#include <cmath>

#include "services/pose_filter/full_filter.h"
#include "services/pose_filter/point_score.h"
#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

/// A torus of about so many triangles; a brick for 12.
TriangleMesh MeshOf(int triangles) {
  if (triangles <= 12) return BoxMesh({0.06, 0.02, 0.02});
  const int along = static_cast<int>(std::lround(std::sqrt(triangles / 4.0)));
  return TorusMesh(0.022, 0.008, 2 * along, along);
}

/// `parts` equal parts, half of them green, spread over the table; every second frame the first one moves 2 mm.
struct Scene {
  Task task;
  std::vector<Pose> truth;
  std::vector<DrawnObservation> frames;

  Scene(int parts, int triangles) {
    const TriangleMesh mesh = MeshOf(triangles);
    task = TestTask({TestType("blue", mesh, true, (parts + 1) / 2), TestType("green", mesh, false, parts / 2)});
    for (PartType& type : task.types) {
      type.symmetries =
          triangles <= 12 ? MakeSymmetryGroup(
                                {ExpRotation({std::numbers::pi / 2, 0, 0}), ExpRotation({0, std::numbers::pi, 0})}, {})
                          : MakeSymmetryGroup({ExpRotation({std::numbers::pi, 0, 0})}, {Vector3::UnitZ()});
    }
    for (int p = 0; p < parts; ++p)
      truth.push_back(OnTable(-0.25 + 0.1 * (p % 6), -0.15 + 0.08 * (p / 6), 0.4 * p, 0.01));
    for (uint64_t k = 0; k < 8; ++k) {
      std::vector<Pose> now = truth;
      now[0] = OnTable(-0.25 + 0.002 * static_cast<double>(k < 4 ? k : 8 - k), -0.15, 0, 0.01);
      frames.emplace_back(task, DrawScene(task, now, k));
    }
  }
};

void FullStep(benchmark::State& state, int parts, int triangles, int particles) {
  const Scene scene(parts, triangles);
  FullFilterOptions options;
  options.particles = particles;
  FullFilter filter(scene.task, options, 1);
  filter.Suggest(scene.truth);
  std::vector<Detections> detections(scene.frames.size());
  for (size_t k = 0; k < detections.size(); ++k) detections[k].class_map = scene.frames[k].class_map;
  FilterInput input;
  size_t k = 0;
  int tracked = 0;
  const auto step = [&] {
    const size_t i = k++ % scene.frames.size();
    input.utime += 33333;
    input.camera = scene.frames[i].picture.camera;
    input.depth = scene.frames[i].picture.depth;
    input.colour = scene.frames[i].picture.colour;
    input.detections = &detections[i];
    tracked = 0;
    for (const PartEstimate& p : filter.Step(input).parts) tracked += p.status == PartStatus::kTracked;
  };
  for (int i = 0; i < 40; ++i) step();  // until a part at rest is known to be at rest
  for (auto _ : state) step();
  state.counters["tracked"] = tracked;
  state.counters["triangles"] = static_cast<double>(scene.task.types[0].mesh.triangles.size());
}

void BM_FullStepParts(benchmark::State& state) { FullStep(state, static_cast<int>(state.range(0)), 12, 200); }
BENCHMARK(BM_FullStepParts)->ArgName("parts")->Arg(2)->Arg(6)->Arg(12)->Arg(30)->Unit(benchmark::kMillisecond);

void BM_FullStepTriangles(benchmark::State& state) { FullStep(state, 6, static_cast<int>(state.range(0)), 200); }
BENCHMARK(BM_FullStepTriangles)
    ->ArgName("triangles")
    ->Arg(12)
    ->Arg(256)
    ->Arg(1024)
    ->Arg(4096)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);

void BM_FullStepParticles(benchmark::State& state) { FullStep(state, 6, 12, static_cast<int>(state.range(0))); }
BENCHMARK(BM_FullStepParticles)
    ->ArgName("particles")
    ->Arg(0)
    ->Arg(50)
    ->Arg(200)
    ->Arg(800)
    ->Unit(benchmark::kMillisecond);

/// One L and a torus of thousands of triangles in front of the camera.
struct Single {
  Task task;
  Pose truth = OnTable(0, 0, 0.4);
  PartModel model;
  DrawnObservation drawn;
  OwnerMap owners = NoOwners(TestCamera());

  explicit Single(int triangles)
      : task(TestTask({TestType("part", triangles <= 20 ? LMesh() : MeshOf(triangles), true, 1)})),
        model(MakePartModel(task.types[0])),
        drawn(task, DrawScene(task, {truth}, 1)) {}
};

void BM_Refine(benchmark::State& state) {
  const Single s(static_cast<int>(state.range(0)));
  const Observation view = s.drawn.View();
  Vector6 xi;
  xi << 0.002, -0.002, 0.002, 0.02, -0.02, 0.02;
  const Pose start = Perturb(s.truth, xi);
  RefinementScratch scratch;
  for (auto _ : state) benchmark::DoNotOptimize(Refine(s.model, view, s.owners, 0, 1, start, {}, scratch).X_CP.data());
}
BENCHMARK(BM_Refine)->ArgName("triangles")->Arg(12)->Arg(1024)->Arg(10000)->Unit(benchmark::kMicrosecond);

void BM_RenderTile(benchmark::State& state) {
  const Single s(static_cast<int>(state.range(0)));
  DepthTile tile;
  for (auto _ : state) RenderTile(s.model, TestCamera(), s.truth, OwnerMap::kStep, 0, tile);
  state.counters["samples"] = tile.covered;
}
BENCHMARK(BM_RenderTile)->ArgName("triangles")->Arg(12)->Arg(1024)->Arg(10000)->Unit(benchmark::kMicrosecond);

void BM_ScoreTile(benchmark::State& state) {
  const Single s(12);
  const Observation view = s.drawn.View();
  DepthTile tile;
  RenderTile(s.model, TestCamera(), s.truth, static_cast<int>(state.range(0)), 0, tile);
  for (auto _ : state) benchmark::DoNotOptimize(ScoreTile(tile, view, s.owners, 0, 1).log_likelihood);
  state.counters["samples"] = tile.covered;
}
BENCHMARK(BM_ScoreTile)->ArgName("step")->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);

void BM_ScorePoints(benchmark::State& state) {
  const Single s(12);
  const Observation view = s.drawn.View();
  const PointSet points = MakePointSet(s.model, static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(ScorePoints(points, view, s.owners, 0, 1, s.truth));
}
BENCHMARK(BM_ScorePoints)->ArgName("points")->Arg(40)->Arg(110)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace coach
