// A changed fingerprint means that old recordings and other versions of Coach can't be read any more: a new generation
// of recordings, which belongs into CHANGELOG.md. Then, and only then, the numbers below change.
#include <gtest/gtest.h>

#include "common/bus/channels.h"

namespace coach {
namespace {

template <class M>
uint64_t Fingerprint() {
  return static_cast<uint64_t>(M::getHash());
}

TEST(Fingerprints, AreThoseOfTheRecordingsInTheWorld) {
  EXPECT_EQ(Fingerprint<annotation_t>(), 0x7af036891aa45c2aU);
  EXPECT_EQ(Fingerprint<assembly_state_t>(), 0x35cfd1eaa8d6a24aU);
  EXPECT_EQ(Fingerprint<color_image_t>(), 0x016c7870a4ef8b8cU);
  EXPECT_EQ(Fingerprint<config_t>(), 0xf90252ee8735dc52U);
  EXPECT_EQ(Fingerprint<connection_belief_t>(), 0x56d452af6457d5faU);
  EXPECT_EQ(Fingerprint<depth_image_t>(), 0xf0c1812f5175c359U);
  EXPECT_EQ(Fingerprint<detections_t>(), 0x41e6f54591a2b07bU);
  EXPECT_EQ(Fingerprint<guidance_event_t>(), 0x8da109d3e4e23312U);
  EXPECT_EQ(Fingerprint<operator_command_t>(), 0x0b7ccb0fd4e913aaU);
  EXPECT_EQ(Fingerprint<part_poses_t>(), 0x6b1bee55606e7685U);
  EXPECT_EQ(Fingerprint<robot_command_t>(), 0x31667b6de1b5ec71U);
  EXPECT_EQ(Fingerprint<robot_status_t>(), 0xa69caeab2ec73dd2U);
  EXPECT_EQ(Fingerprint<service_health_t>(), 0xe9beb8e00318d2a6U);
  EXPECT_EQ(Fingerprint<table_scene_t>(), 0x3967cf4a840eb6c1U);
  EXPECT_EQ(Fingerprint<task_t>(), 0x6069af8b75764cabU);
}

}  // namespace
}  // namespace coach
