// How often a step in the steady state asks for memory.
#include <gtest/gtest.h>

#include "counted_new.h"
#include "tests/support/drawn_session.h"

namespace coach {
namespace {

/// Every buffer is kept from step to step.
constexpr int64_t kMostAllocations = 0;

TEST(FullFilterAllocations, SteadyState) {
  const Task task = TwoLsAndABrick();
  std::vector<TestPicture> pictures;
  std::vector<Detections> detections(10);
  for (int k = 0; k < 10; ++k) {
    pictures.push_back(
        DrawScene(task, {OnTable(-0.15 + 0.003 * k, 0.02, 0.3), OnTable(0.13, -0.07, 2.1), OnTable(0.05, 0.14, 1.0)},
                  static_cast<uint64_t>(k)));
    detections[static_cast<size_t>(k)].class_map = DrawnClassMap(task, pictures.back());
  }
  FullFilter filter(task, {}, 1);
  int64_t steady = 0, steady_bytes = 0, worst = 0;
  constexpr int kSteps = 30;
  for (int k = 0; k < 2 * kSteps; ++k) {
    // There and back: no jump.
    const auto i = static_cast<size_t>(k % 20 < 10 ? k % 20 : 19 - k % 20);
    FilterInput input;
    input.utime = 1000 + 33333 * k;
    input.camera = pictures[i].camera;
    input.depth = pictures[i].depth;
    input.colour = pictures[i].colour;
    input.detections = &detections[i];
    const CountedNew before = NewSoFar();
    const PartPoses& out = filter.Step(input);
    const CountedNew after = NewSoFar();
    if (k < kSteps) continue;
    for (const PartEstimate& p : out.parts) ASSERT_EQ(p.status, PartStatus::kTracked);
    steady += after.calls - before.calls;
    steady_bytes += after.bytes - before.bytes;
    worst = std::max(worst, after.calls - before.calls);
  }
  std::printf("allocations a step: %.1f on average, %d at most, %.0f bytes\n", static_cast<double>(steady) / kSteps,
              static_cast<int>(worst), static_cast<double>(steady_bytes) / kSteps);
  EXPECT_LE(worst, kMostAllocations);
}

}  // namespace
}  // namespace coach
