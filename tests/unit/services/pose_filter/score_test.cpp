#include "services/pose_filter/score.h"

#include <gtest/gtest.h>

#include "services/pose_filter/depth_renderer.h"
#include "services/pose_filter/point_score.h"
#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

PixelEvidence Judge(double d, double z, bool has_colour, bool own, bool on_table = false, double likely = 0) {
  return JudgePixel(
      static_cast<float>(d), static_cast<float>(z), static_cast<float>(DepthSigma(d)), has_colour, own,
      [&] { return on_table; }, [&] { return static_cast<float>(likely); });
}

TEST(JudgePixel, SomethingClearlyNearerIsWorthExactlyNothing) {
  for (double d = 0.3; d < 2; d += 0.1) {
    for (double nearer = 0.007 + 3 * DepthSigma(d); nearer < d - 0.1; nearer += 0.05) {
      for (const bool own : {false, true}) {
        const PixelEvidence e = Judge(d, d - nearer, true, own);
        EXPECT_EQ(e.verdict, PixelVerdict::kHidden);
        EXPECT_EQ(e.log_likelihood, 0.0f);
      }
    }
  }
}

TEST(JudgePixel, TheTableHidesNothing) {
  const PixelEvidence e = Judge(0.8, 0.7, true, false, true);
  EXPECT_EQ(e.verdict, PixelVerdict::kSeeThrough);
  EXPECT_LT(e.log_likelihood, -4);
}

TEST(JudgePixel, WrongColourGetsNoGainForItsDepth) {
  const double d = 0.7, gate = 0.006 + 3 * DepthSigma(d);
  for (double r = -gate + 1e-4; r < gate; r += 1e-4) {
    EXPECT_LE(Judge(d, d + r, true, false).log_likelihood, 0) << r;
    EXPECT_NE(Judge(d, d + r, true, false).verdict, PixelVerdict::kInlier) << r;
  }
  EXPECT_LE(Judge(d, 0, true, false).log_likelihood, 0);
  EXPECT_GT(Judge(d, 0, true, true).log_likelihood, 0);
  EXPECT_EQ(Judge(d, 0, false, false).log_likelihood, 0);
}

TEST(JudgePixel, WithoutAReadingWhatLooksLikeSomethingInFrontHides) {
  const double d = 0.7;
  EXPECT_EQ(Judge(d, 0, true, false, false, d - 0.1).verdict, PixelVerdict::kHidden);
  EXPECT_EQ(Judge(d, 0, true, false, false, d - 0.1).log_likelihood, 0);
  EXPECT_EQ(Judge(d, 0, true, true, false, d - 0.1).verdict, PixelVerdict::kNoReading) << "its own colour";
  for (const double likely : {0.0, d, d + 0.1})
    EXPECT_EQ(Judge(d, 0, true, false, false, likely).verdict, PixelVerdict::kWrongColour) << likely;
}

TEST(JudgePixel, MatchingDepthFallsWithTheResidual) {
  const double d = 0.7, sigma = DepthSigma(d);
  // A Gaussian: the log-likelihood at one sigma is half a nat below the best, at two sigmas two.
  const double best = Judge(d, d, false, false).log_likelihood;
  EXPECT_NEAR(best - Judge(d, d + sigma, false, false).log_likelihood, 0.5, 1e-3);
  EXPECT_NEAR(best - Judge(d, d - 2 * sigma, false, false).log_likelihood, 2, 1e-3);
  EXPECT_GT(Judge(d, d, true, true).log_likelihood, best);
  EXPECT_LT(Judge(d, d + 0.1, true, true).log_likelihood, -4);
  EXPECT_LT(Judge(d, d + 0.1, true, false).log_likelihood, Judge(d, d + 0.1, true, true).log_likelihood);
}

class ScoreTileTest : public ::testing::Test {
 protected:
  Score At(const DrawnObservation& drawn, const Pose& X_CP, const OwnerMap& owners) {
    DepthTile tile;
    RenderTile(model_, TestCamera(), X_CP, OwnerMap::kStep, 0, tile);
    return ScoreTile(tile, drawn.View(), owners, 0, 1);
  }
  Task task_ = TestTask({TestType("l", LMesh(), true, 1)});
  PartModel model_ = MakePartModel(task_.types[0]);
  OwnerMap none_ = NoOwners(TestCamera());
  std::mt19937_64 generator_{3};
};

TEST_F(ScoreTileTest, AFullyHiddenPartScoresExactlyZeroWhateverItsPose) {
  const DrawnObservation drawn(task_, DrawScene(task_, {OnTable(0, 0, 0)}, 1, 1, 0, 640, 0.3));
  for (int k = 0; k < 100; ++k) {
    const Pose X = MakePose(RandomRotation(generator_), Vector3(0, 0, 0.7) + RandomVector(generator_, 0.15));
    const Score score = At(drawn, X, none_);
    ASSERT_GT(score.covered, 0);
    EXPECT_EQ(score.log_likelihood, 0.0);
    EXPECT_EQ(score.hidden, score.covered);
    EXPECT_EQ(score.agreement(), 0.0);
  }
}

TEST_F(ScoreTileTest, BehindAnotherPartIsHiddenToo) {
  const Pose X = OnTable(0, 0, 0.3);
  const DrawnObservation drawn(task_, DrawScene(task_, {X}, 1, 0));
  OwnerMap owners = none_;
  Pose nearer = X;
  nearer.translation() *= 0.8;
  nearer.translation().z() = 0.8 * X.translation().z();
  const PartModel wall = MakePartModel(TestType("wall", BoxMesh({0.5, 0.5, 0.01}), true, 1));
  DepthTile tile;
  RenderTile(wall, TestCamera(), MakePose(Matrix3::Identity(), nearer.translation()), OwnerMap::kStep, 0, tile);
  owners.Add(1, tile);
  const Score score = At(drawn, X, owners);
  EXPECT_EQ(score.hidden, score.covered);
  EXPECT_EQ(score.log_likelihood, 0.0);
  // Its own entry hides nothing.
  OwnerMap own = none_;
  own.Add(0, tile);
  EXPECT_GT(At(drawn, X, own).log_likelihood, 0);
}

TEST_F(ScoreTileTest, BehindTheTableIsImpossible) {
  const DrawnObservation drawn(task_, DrawScene(task_, {}, 1, 0));
  Pose under = OnTable(0, 0, 0.3, -0.1);
  const Score score = At(drawn, under, none_);
  EXPECT_EQ(score.see_through, score.covered);
  EXPECT_LT(score.log_likelihood, -5.0 * 4 * score.covered);
}

TEST_F(ScoreTileTest, TheTruePoseIsTheLikeliest) {
  const Pose truth = OnTable(0.02, 0.03, 1.1);
  const DrawnObservation drawn(task_, DrawScene(task_, {truth}, 1));
  const Score best = At(drawn, truth, none_);
  EXPECT_GT(best.agreement(), 0.9);
  // Every pixel counts, whatever the step: about 7 nats an inlier.
  EXPECT_NEAR(best.log_likelihood, 7.0 * 4 * best.inlier, 0.2 * 7.0 * 4 * best.inlier);
  const PointSet points = MakePointSet(model_, 110);
  const float best_points = ScorePoints(points, drawn.View(), none_, 0, 1, truth);
  EXPECT_GT(best_points, 0);
  for (int k = 0; k < 50; ++k) {
    Vector6 xi;
    xi << RandomVector(generator_, 0.02), RandomVector(generator_, 0.3);
    EXPECT_LT(At(drawn, Perturb(truth, xi), none_).log_likelihood, best.log_likelihood);
    EXPECT_LT(ScorePoints(points, drawn.View(), none_, 0, 1, Perturb(truth, xi)), best_points);
  }
}

TEST_F(ScoreTileTest, ParticleScoreRanksLikeTheFullOne) {
  const Pose truth = OnTable(0.02, 0.03, 1.1);
  const DrawnObservation drawn(task_, DrawScene(task_, {truth}, 1));
  std::vector<int> visible;
  for (int i = 0; i < static_cast<int>(model_.surface.size()); ++i) {
    const SurfacePoint& s = model_.surface[static_cast<size_t>(i)];
    if ((truth.linear() * s.n).dot(truth * s.p) < 0) visible.push_back(i);
  }
  VisiblePoints points;
  SelectVisible(model_, truth, visible, 40, points);
  ASSERT_LE(points.x.size(), 40u);
  ASSERT_GE(points.x.size(), 20u);
  const float best = ScoreVisible(points, drawn.View(), none_, 0, 1, truth);
  for (int k = 0; k < 50; ++k) {
    Vector6 xi;
    xi << RandomVector(generator_, 0.03), RandomVector(generator_, 0.4);
    EXPECT_LT(ScoreVisible(points, drawn.View(), none_, 0, 1, Perturb(truth, xi)), best);
  }
}

TEST_F(ScoreTileTest, TilesAgreeWithTheOtherRasteriser) {
  const RenderMesh mesh(task_.types[0].mesh);
  const PixelGrid grid = SampledGrid(TestCamera(), 2);
  for (int k = 0; k < 40; ++k) {
    const Pose X = MakePose(RandomRotation(generator_), Vector3(0, 0, 0.6) + RandomVector(generator_, 0.3));
    DepthTile tile;
    RenderTile(model_, TestCamera(), X, 2, 0, tile);
    RenderedDepth drawn;
    RenderDepth(mesh, grid, X, drawn);
    int both = 0, one = 0;
    for (int j = 0; j < drawn.area.height; ++j) {
      for (int i = 0; i < drawn.area.width; ++i) {
        const float z = drawn.row(j)[i];
        const float t = tile.AtPixel(2 * (drawn.area.x + i), 2 * (drawn.area.y + j));
        if (t > 0 && z < RenderedDepth::kEmpty) {
          ++both;
          EXPECT_NEAR(t, z, 1e-4 * z);
        } else {
          one += (t > 0) != (z < RenderedDepth::kEmpty);
        }
      }
    }
    EXPECT_LE(one, 2 + both / 100);
    EXPECT_LE(std::abs(tile.covered - both), one);
  }
}

TEST_F(ScoreTileTest, OutOfTheImage) {
  DepthTile tile;
  Pose X = OnTable(0, 0, 0);
  X.translation().x() = 3;
  RenderTile(model_, TestCamera(), X, 2, 6, tile);
  EXPECT_EQ(tile.covered, 0);
  EXPECT_EQ(InImageFraction(model_, TestCamera(), X), 0);
  X.translation() << 0, 0, -1;
  RenderTile(model_, TestCamera(), X, 2, 6, tile);
  EXPECT_EQ(tile.covered, 0);
  // Half of it beyond the left edge.
  const PartModel box = MakePartModel(TestType("box", BoxMesh({0.1, 0.1, 0.01}), true, 1));
  X = MakePose(Matrix3::Identity(), {-320.0 / 570 * 0.5, 0, 0.505});
  EXPECT_NEAR(InImageFraction(box, TestCamera(), X), 0.5, 0.06);
}

}  // namespace
}  // namespace coach
