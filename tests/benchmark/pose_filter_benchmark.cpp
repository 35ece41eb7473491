// The kernels of stage 2.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "services/pose_filter/collision.h"
#include "services/pose_filter/depth_renderer.h"
#include "services/pose_filter/observation_model.h"
#include "services/pose_filter/paper_filter.h"
#include "services/pose_filter/process_model.h"
#include "tests/support/test_scene.h"

namespace coach {
namespace {

CameraModel Camera() {
  CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 570;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

std::vector<Pose> Poses(int n) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  std::vector<Pose> poses;
  for (int i = 0; i < n; ++i) {
    const Vector3 w(normal(generator), normal(generator), normal(generator));
    poses.push_back(MakePose(ExpRotation(w), {0.1 * normal(generator), 0.08 * normal(generator), 0.8}));
  }
  return poses;
}

void Report(benchmark::State& state, const RenderedDepth& tile) {
  int points = 0;
  for (int j = 0; j < tile.area.height; ++j) {
    points += static_cast<int>(
        std::count_if(tile.row(j), tile.row(j) + tile.area.width, [](float z) { return z < RenderedDepth::kEmpty; }));
  }
  state.counters["points"] = points;
}

void BM_RenderBrick(benchmark::State& state) {
  const RenderMesh mesh(BoxMesh({0.12, 0.03, 0.03}));
  const PixelGrid grid = SampledGrid(Camera(), static_cast<int>(state.range(0)));
  const auto poses = Poses(64);
  RenderedDepth tile;
  size_t i = 0;
  for (auto _ : state) RenderDepth(mesh, grid, poses[i++ % poses.size()], tile);
  Report(state, tile);
}
BENCHMARK(BM_RenderBrick)->Arg(1)->Arg(2)->Arg(4)->Arg(8)->ArgName("step");

void BM_RenderTriangles(benchmark::State& state) {
  const int along = static_cast<int>(std::lround(std::sqrt(static_cast<double>(state.range(0)) / 4)));
  const TriangleMesh torus = TorusMesh(0.05, 0.02, 2 * along, along);
  const RenderMesh mesh(torus);
  const PixelGrid grid = SampledGrid(Camera(), 4);
  const auto poses = Poses(64);
  RenderedDepth tile;
  size_t i = 0;
  for (auto _ : state) RenderDepth(mesh, grid, poses[i++ % poses.size()], tile);
  Report(state, tile);
  state.counters["triangles"] = static_cast<double>(torus.triangles.size());
}
BENCHMARK(BM_RenderTriangles)->Arg(64)->Arg(256)->Arg(1024)->Arg(4096)->Arg(10000);

/// A brick's tile against a depth image full of readings.
void Score(benchmark::State& state, OcclusionForm form) {
  const RenderMesh mesh(BoxMesh({0.12, 0.03, 0.03}));
  const PixelGrid grid = SampledGrid(Camera(), static_cast<int>(state.range(0)));
  RenderedDepth tile;
  RenderDepth(mesh, grid, Poses(1)[0], tile);
  const ObservationModel model({}, form);
  DepthEvidence evidence;
  model.Prepare(cv::Mat(480, 640, CV_16UC1, cv::Scalar(790)), 0.001, grid, evidence);
  const std::vector<float> occlusion(evidence.z.size(), 0.1F);
  for (auto _ : state) benchmark::DoNotOptimize(model.LogLikelihood(evidence, tile, occlusion.data()));
  Report(state, tile);
}
void BM_LikelihoodFull(benchmark::State& state) { Score(state, OcclusionForm::kFull); }
void BM_LikelihoodPaper(benchmark::State& state) { Score(state, OcclusionForm::kPaper); }
BENCHMARK(BM_LikelihoodFull)->Arg(1)->Arg(2)->Arg(4)->Arg(8)->ArgName("step");
BENCHMARK(BM_LikelihoodPaper)->Arg(1)->Arg(2)->Arg(4)->Arg(8)->ArgName("step");

void BM_PrepareEvidence(benchmark::State& state) {
  const PixelGrid grid = SampledGrid(Camera(), static_cast<int>(state.range(0)));
  const ObservationModel model({}, OcclusionForm::kFull);
  const cv::Mat depth(480, 640, CV_16UC1, cv::Scalar(790));
  DepthEvidence evidence;
  for (auto _ : state) model.Prepare(depth, 0.001, grid, evidence);
}
BENCHMARK(BM_PrepareEvidence)->Arg(1)->Arg(2)->Arg(4)->Arg(8)->ArgName("step")->Unit(benchmark::kMicrosecond);

void BM_Propagate(benchmark::State& state) {
  Random random(1);
  MotionState motion;
  for (auto _ : state) Propagate({}, 1 / 30.0, random, motion);
}
BENCHMARK(BM_Propagate);

void BM_Overlap(benchmark::State& state) {
  const CollisionShape brick(BoxMesh({0.12, 0.03, 0.03}));
  Pose beside = Pose::Identity();
  beside.translation() << 0.045, 0.03 - 1e-3 * static_cast<double>(state.range(0)), 0;
  for (auto _ : state) benchmark::DoNotOptimize(Overlap(brick, Pose::Identity(), brick, beside, 0.002));
}
BENCHMARK(BM_Overlap)->Arg(-50)->Arg(0)->Arg(1)->Arg(5)->ArgName("depth_mm");

void BM_DistanceField(benchmark::State& state) {
  const DistanceField field(BoxMesh({0.12, 0.03, 0.03}));
  Eigen::Vector3f p(0.01F, 0.012F, 0.003F);
  for (auto _ : state) {
    benchmark::DoNotOptimize(field.At(p));
    p.x() = -p.x();
  }
}
BENCHMARK(BM_DistanceField);

/// A whole step of the paper's filter on drawn pictures: parts, particles, px between grid points.
void BM_PaperStep(benchmark::State& state) {
  const int parts = static_cast<int>(state.range(0));
  const Task task = TestTask({TestType("brick", BoxMesh({0.06, 0.02, 0.02}), true, parts)});
  std::vector<Pose> truth;
  for (int p = 0; p < parts; ++p)
    truth.push_back(OnTable(-0.25 + 0.1 * (p % 6), -0.15 + 0.07 * (p / 6), 0.4 * p, 0.01));
  const TestPicture picture = DrawScene(task, truth, 1);
  PaperFilterOptions options;
  options.particles = static_cast<int>(state.range(1));
  options.step = static_cast<int>(state.range(2));
  options.start_interval = 1e6;
  PaperFilter filter(task, options, 1);
  filter.Suggest(truth);
  FilterInput input;
  input.camera = picture.camera;
  input.depth = picture.depth;
  for (auto _ : state) {
    input.utime += 33333;
    benchmark::DoNotOptimize(filter.Step(input).parts.data());
  }
}
BENCHMARK(BM_PaperStep)
    ->ArgNames({"parts", "particles", "step"})
    ->Args({2, 200, 5})
    ->Args({6, 200, 5})
    ->Args({12, 200, 5})
    ->Args({30, 200, 5})
    ->Args({6, 50, 5})
    ->Args({6, 800, 5})
    ->Args({6, 200, 8})
    ->Args({6, 200, 2})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace coach
