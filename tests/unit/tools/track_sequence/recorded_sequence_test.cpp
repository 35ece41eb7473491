// On a recorded assembly with ground truth beside it: the truth is not read, the future is not known, chance is seeded.
#include <gtest/gtest.h>

#include "tracked_files.h"

namespace coach {
namespace {

TEST(RecordedSequence, DeterministicStrippedAndCausal) {
  const std::filesystem::path scene =
      std::filesystem::path(COACH_SOURCE_DIR).parent_path() / "shared" / "scenes" / "assemble_dev";
  if (!std::filesystem::exists(scene / "scene_camera.json")) GTEST_SKIP() << "no scene " << scene;
  const ScratchFolder folder("coach_recorded_sequence_test");
  constexpr int kFrames = 40;
  const auto stripped = folder.path() / "stripped", whole = folder.path() / "whole", half = folder.path() / "half";
  CopyStripped(scene, stripped, kFrames);
  CopyStripped(scene, half, kFrames / 2);
  CopyStripped(scene, whole, kFrames);
  for (const char* file : {"scene_gt.json", "scene_gt_info.json", "events.json", "assembly.json"})
    std::filesystem::copy(scene / file, whole / file);
  const TrackedFiles first = Track(stripped, 15);
  EXPECT_GT(first.poses.size(), 4u * kFrames * 50);
  EXPECT_TRUE(first == Track(stripped, 15));
  EXPECT_TRUE(first == Track(whole, 15));
  const TrackedFiles causal = Track(half, 15);
  EXPECT_GT(causal.poses.size(), first.poses.size() / 3);
  EXPECT_TRUE(first.poses.starts_with(causal.poses));
  EXPECT_TRUE(first.states.starts_with(causal.states));
  EXPECT_TRUE(first.events.starts_with(causal.events));
}

}  // namespace
}  // namespace coach
