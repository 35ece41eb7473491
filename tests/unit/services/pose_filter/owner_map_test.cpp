// Which part is where in the image, and what no part explains.
#include "services/pose_filter/owner_map.h"

#include <gtest/gtest.h>

#include "services/pose_filter/blobs.h"
#include "services/pose_filter/foreign_blobs.h"
#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

DepthTile RandomTile(std::mt19937_64& generator) {
  DepthTile tile;
  tile.step = OwnerMap::kStep;
  tile.x0 = 2 * static_cast<int>(generator() % 20);
  tile.y0 = 2 * static_cast<int>(generator() % 20);
  tile.width = 5 + static_cast<int>(generator() % 20);
  tile.height = 5 + static_cast<int>(generator() % 20);
  for (int i = 0; i < tile.width * tile.height; ++i) {
    tile.depth.push_back(generator() % 3 ? 0.3f + 1e-6f * static_cast<float>(generator() % 1000000) : 0.0f);
  }
  return tile;
}

// Two parts, which is what a cell holds, against a search through both tiles.
TEST(OwnerMap, AddAndRemoveAgainstASearch) {
  std::mt19937_64 generator(4);
  CameraModel camera = TestCamera();
  camera.width = camera.height = 100;
  OwnerMap owners;
  for (int k = 0; k < 50; ++k) {
    owners.Resize(camera);
    const std::vector<DepthTile> tiles{RandomTile(generator), RandomTile(generator)};
    std::vector<bool> in{false, false};
    for (int action = 0; action < 6; ++action) {
      const size_t part = generator() % 2;
      in[part] ? owners.Remove(static_cast<int>(part), tiles[part]) : owners.Add(static_cast<int>(part), tiles[part]);
      in[part] = !in[part];
      for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
          float depth[2];
          for (size_t p = 0; p < 2; ++p) depth[p] = in[p] ? tiles[p].AtPixel(x / 2 * 2, y / 2 * 2) : 0;
          ASSERT_EQ(owners.OtherDepth(x, y, 0), depth[1]);
          ASSERT_EQ(owners.OtherDepth(x, y, 1), depth[0]);
          ASSERT_EQ(owners.OtherOwner(x, y, 0), depth[1] > 0 ? 1 : -1);
          const int nearest = depth[0] > 0 && (depth[1] == 0 || depth[0] <= depth[1]) ? 0 : depth[1] > 0 ? 1 : -1;
          ASSERT_EQ(owners.Owner(x, y), nearest);
          ASSERT_EQ(owners.NearestDepth(x, y), nearest < 0 ? 0 : depth[nearest]);
        }
      }
    }
  }
}

TEST(OwnerMap, AThirdPartSeesTheNearestOfTheOthers) {
  CameraModel camera = TestCamera();
  OwnerMap owners = NoOwners(camera);
  DepthTile tile;
  tile.step = 2;
  tile.width = tile.height = 4;
  for (const int part : {2, 0, 1}) {
    tile.depth.assign(16, 0.5f + 0.1f * static_cast<float>(part));
    owners.Add(part, tile);
  }
  EXPECT_FLOAT_EQ(owners.OtherDepth(0, 0, 2), 0.5f);
  EXPECT_FLOAT_EQ(owners.OtherDepth(0, 0, 0), 0.6f);
  owners.Clear();
  EXPECT_EQ(owners.Owner(0, 0), -1);
}

class BlobTest : public ::testing::Test {
 protected:
  BlobTest() {
    table_.Add(DrawnObservation(task_, DrawScene(task_, {}, 1)).View(), TestTable().inverse());
    for (const PartType& type : task_.types) models_.push_back(MakePartModel(type));
  }
  std::vector<Blob> Find(const DrawnObservation& drawn, const OwnerMap& owners) {
    return finder_.FindUnexplained(drawn.View(), owners, {0, 1}, 2, TestTable().inverse(), table_);
  }
  void Explain(int part, const Pose& X_CP, OwnerMap& owners) const {
    DepthTile tile;
    RenderTile(models_[static_cast<size_t>(part)], TestCamera(), X_CP, OwnerMap::kStep, 0, tile);
    owners.Add(part, tile);
  }
  Task task_ = TestTask({TestType("blue", BoxMesh({0.12, 0.03, 0.03}), true, 1),
                         TestType("green", BoxMesh({0.06, 0.04, 0.03}), false, 1)});
  std::vector<PartModel> models_;
  const std::vector<Pose> truth_{OnTable(-0.1, 0, 0.3), OnTable(0.12, 0.05, 0.8)};
  TableArea table_;
  BlobFinder finder_;
};

TEST_F(BlobTest, APartIsOneBlobUntilItIsExplained) {
  const DrawnObservation drawn(task_, DrawScene(task_, truth_, 1));
  OwnerMap owners = NoOwners(TestCamera());
  const std::vector<Blob> both = Find(drawn, owners);
  ASSERT_EQ(both.size(), 2u);
  for (int c = 0; c < 2; ++c) {
    const Blob& blob = both[static_cast<size_t>(c)];
    EXPECT_EQ(blob.colour_class, c);
    EXPECT_FALSE(blob.touches_border);
    EXPECT_EQ(static_cast<size_t>(blob.cells), blob.pixels.size());
    DepthTile tile;
    RenderTile(models_[static_cast<size_t>(c)], TestCamera(), truth_[static_cast<size_t>(c)], 1, 0, tile);
    EXPECT_NEAR(blob.cells * 16, tile.covered, 0.15 * tile.covered);
    // The mean of the visible surface is within a part's half thickness of its middle.
    EXPECT_LT((blob.p_C - truth_[static_cast<size_t>(c)].translation()).norm(), 0.025);
    EXPECT_LT((blob.centre - TestCamera().Project(blob.p_C)).norm(), 3);
  }
  Explain(0, truth_[0], owners);
  const std::vector<Blob> rest = Find(drawn, owners);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].colour_class, 1);
  Explain(1, truth_[1], owners);
  EXPECT_TRUE(Find(drawn, owners).empty());
}

TEST_F(BlobTest, APartBelievedElsewhereExplainsNothing) {
  const DrawnObservation drawn(task_, DrawScene(task_, truth_, 1));
  OwnerMap owners = NoOwners(TestCamera());
  Explain(0, truth_[1], owners);  // the blue one where the green one is
  const std::vector<Blob> blobs = Find(drawn, owners);
  ASSERT_EQ(blobs.size(), 2u);
}

TEST_F(BlobTest, WhatIsNotOverTheTableIsTheRoom) {
  const DrawnObservation drawn(task_, DrawScene(task_, {OnTable(0, 0, 0, 0.30), OnTable(0, 9, 0)}, 1));
  EXPECT_EQ(Find(drawn, NoOwners(TestCamera())).size(), 1u) << "held up";
  BlobOptions options;
  options.highest = 0.25;
  finder_ = BlobFinder(options);
  EXPECT_EQ(Find(drawn, NoOwners(TestCamera())).size(), 0u);
  finder_ = BlobFinder();
  DrawnObservation colourless(task_, DrawScene(task_, truth_, 1));
  colourless.class_map.clear();
  EXPECT_TRUE(Find(colourless, NoOwners(TestCamera())).empty());
}

Blob At(int colour_class, const Vector3& p_C, int cells) {
  Blob blob;
  blob.colour_class = colour_class;
  blob.p_C = p_C;
  blob.cells = blob.readings = cells;
  return blob;
}

TEST(Distractors, WhatStaysUnexplainedBecomesKnownAndIsForgotten) {
  Distractors distractors;
  const Pose X_TC = TestTable().inverse();
  const Blob poster = At(0, {0.1, 0.1, 0.9}, 50);
  EXPECT_FALSE(distractors.Known(poster, X_TC));
  for (int k = 0; k < 5; ++k) distractors.Remember({poster}, X_TC);
  EXPECT_TRUE(distractors.Known(poster, X_TC));
  // The same place seen from elsewhere.
  Vector6 xi;
  xi << 0.1, 0.05, -0.1, 0.1, 0.2, 0.1;
  const Pose X_TD = Perturb(X_TC, xi);
  EXPECT_TRUE(distractors.Known(At(0, X_TD.inverse() * (X_TC * poster.p_C), 50), X_TD));
  EXPECT_FALSE(distractors.Known(At(1, poster.p_C, 50), X_TC)) << "another colour";
  EXPECT_FALSE(distractors.Known(At(0, poster.p_C + Vector3(0.05, 0, 0), 50), X_TC)) << "another place";
  EXPECT_FALSE(distractors.Known(At(0, poster.p_C, 120), X_TC)) << "a part lies in front of it";
  for (int k = 0; k < 60; ++k) distractors.Remember({}, X_TC);
  EXPECT_FALSE(distractors.Known(poster, X_TC));
}

// A colourless ball of 10 cm over the table is a hand.
TEST(ForeignFinder, FollowsAHand) {
  const Task task = TestTask({TestType("hand", BoxMesh({0.09, 0.09, 0.04}), true, 1),
                              TestType("part", BoxMesh({0.12, 0.03, 0.03}), false, 1)});
  TableArea table;
  const Pose X_TC = TestTable().inverse();
  table.Add(DrawnObservation(task, DrawScene(task, {}, 1)).View(), X_TC);
  const PartModel part = MakePartModel(task.types[1]);
  ForeignFinder finder;
  EXPECT_EQ(finder.Nearest({0, 0, 0}), 10);
  const double dt = 1.0 / 30;
  for (int k = 0; k < 12; ++k) {
    const Pose hand = OnTable(-0.15 + 0.5 * dt * k, 0, 0, 0.1), brick = OnTable(0.15, -0.1, 0.5);
    DrawnObservation drawn(task, DrawScene(task, {hand, brick}, static_cast<uint64_t>(k)));
    for (uint8_t& c : drawn.class_map) c = c == 1 ? 0 : c;  // skin is of no class
    OwnerMap owners = NoOwners(TestCamera());
    DepthTile tile;
    RenderTile(part, TestCamera(), brick, OwnerMap::kStep, 0, tile);
    owners.Add(1, tile);
    finder.Find(drawn.View(), owners, X_TC, table, dt);
    ASSERT_EQ(finder.blobs().size(), 1u) << "the part is none, the table is none";
    // What is seen of it: its top and one side.
    EXPECT_LT((finder.blobs()[0].centre - X_TC * hand.translation()).norm(), 0.03);
    EXPECT_GT(finder.blobs()[0].radius, 0.03);
    EXPECT_LT(finder.blobs()[0].radius, 0.09);
    EXPECT_LT(finder.Nearest(finder.blobs()[0].centre), 0.03);
  }
  // 0.5 m/s along x, from centres of a few hundred readings on a grid of 1.1 cm.
  EXPECT_LT((finder.blobs()[0].velocity - Vector3(0.5, 0, 0)).norm(), 0.2);
  const DrawnObservation empty(task, DrawScene(task, {}, 1));
  finder.Find(empty.View(), NoOwners(TestCamera()), X_TC, table, dt);
  EXPECT_TRUE(finder.blobs().empty());
  EXPECT_EQ(finder.Nearest({0, 0, 0}), 10);
}

}  // namespace
}  // namespace coach
