#include "services/pose_filter/observation.h"

#include <gtest/gtest.h>

#include <vector>

namespace coach {
namespace {

/// One row of pixels: letters are colours, depth in mm.
struct Row {
  std::vector<uint8_t> bgr;
  std::vector<uint16_t> depth;
  Observation View() const {
    Observation o;
    o.camera.width = static_cast<int>(depth.size());
    o.camera.height = 1;
    o.depth = depth.data();
    o.bgr = bgr.data();
    return o;
  }
};

Row MakeRow(const std::string& colours, std::vector<uint16_t> depth) {
  Row row;
  row.depth = std::move(depth);
  for (const char c : colours) {
    const uint8_t skin[3]{120, 150, 210}, table[3]{170, 170, 170}, black[3]{0, 0, 0};
    const uint8_t* from = c == 's' ? skin : c == 't' ? table : black;
    row.bgr.insert(row.bgr.end(), from, from + 3);
  }
  return row;
}

TEST(Observation, AHoleBelongsToTheSideThatItLooksLike) {
  const Row row = MakeRow("sssstttt", {700, 700, 0, 0, 0, 0, 800, 800});
  const Observation o = row.View();
  for (const int x : {2, 3}) EXPECT_FLOAT_EQ(o.LikelyDepth(x, 0), 0.7f) << x;
  for (const int x : {4, 5}) EXPECT_FLOAT_EQ(o.LikelyDepth(x, 0), 0.8f) << x;
}

TEST(Observation, AHoleLikeNeitherSideIsUnknown) {
  EXPECT_EQ(MakeRow("sskttt", {700, 700, 0, 0, 800, 800}).View().LikelyDepth(2, 0), 0);
}

TEST(Observation, AHoleAtTheImagesBorderHasOneSide) {
  const Row row = MakeRow("ssst", {0, 0, 700, 800});
  EXPECT_FLOAT_EQ(row.View().LikelyDepth(0, 0), 0.7f);
  EXPECT_EQ(MakeRow("ss", {0, 0}).View().LikelyDepth(1, 0), 0);
}

TEST(Observation, WithoutColourNothingIsLikely) {
  const Row row = MakeRow("ssss", {700, 0, 0, 700});
  Observation o = row.View();
  o.bgr = nullptr;
  EXPECT_EQ(o.LikelyDepth(1, 0), 0);
}

}  // namespace
}  // namespace coach
