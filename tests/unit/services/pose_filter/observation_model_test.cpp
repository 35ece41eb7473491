#include "services/pose_filter/observation_model.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <numbers>
#include <random>

namespace coach {
namespace {

constexpr double kTail = 0.01 / 6, kWeight = 0.99, kLambda = std::numbers::ln2;

double Sigma(double z) { return 0.003 + 1.4247e-3 * z * z; }
double NormalDensity(double x, double sigma) {
  return std::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * std::numbers::pi));
}

/// Density of the reading of an occluder somewhere in [0, d], by numerical integration of the convolution.
double PaperOccluded(double z, double d) {
  const double sigma = Sigma(z);
  const double low = std::max(0.0, z - 12 * sigma), high = std::min(d, z + 12 * sigma);
  double sum = 0;
  if (low < high) {
    const int n = 4000;  // Simpson's rule
    for (int i = 0; i <= n; ++i) {
      const double t = low + (high - low) * i / n;
      sum += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * kLambda * std::exp(-kLambda * t) * NormalDensity(z - t, sigma);
    }
    sum *= (high - low) / n / 3;
  }
  return kTail + kWeight * sum / (1 - std::exp(-kLambda * d));
}

double FullOccluded(double z, double d) {
  return kTail + kWeight * kLambda * std::exp(-kLambda * z) * 0.5 * std::erfc((z - d) / Sigma(z) / std::numbers::sqrt2);
}

struct Expected {
  double log_ratio, occlusion;
};
Expected Reference(OcclusionForm form, double z, double d, double o) {
  if (z == 0) return {0, o};
  const bool full = form == OcclusionForm::kFull;
  const double visible = kTail + kWeight * NormalDensity(z - d, Sigma(z));
  const double occluded = full ? FullOccluded(z, d) : PaperOccluded(z, d);
  const double background = full ? kTail + kWeight * kLambda * std::exp(-kLambda * z) : PaperOccluded(z, 100);
  const double mixture = (1 - o) * visible + o * occluded;
  const bool hidden = full && z < d - 3 * Sigma(z);
  return {hidden ? 0 : std::log(mixture / background), o * occluded / mixture};
}

CameraModel Camera() {
  CameraModel camera;
  camera.width = 61;
  camera.height = 37;
  camera.fx = camera.fy = 50;
  camera.cx = 30;
  camera.cy = 18;
  return camera;
}

class Form : public testing::TestWithParam<std::tuple<OcclusionForm, int64_t>> {
 protected:
  void SetUp() override {
    const int64_t target = std::get<1>(GetParam());
    if ((hwy::SupportedTargets() & target) == 0) GTEST_SKIP() << "not on this processor";
    hwy::SetSupportedTargetsForTest(target);
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
  OcclusionForm form() const { return std::get<0>(GetParam()); }
};

TEST_P(Form, EachPointAgreesWithTheEquations) {
  const ObservationModel model({}, form());
  const PixelGrid grid = SampledGrid(Camera(), 1);
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  cv::Mat depth(37, 61, CV_16UC1, cv::Scalar(0));
  DepthEvidence evidence;
  RenderedDepth tile;
  tile.Reset({7, 9, 1, 1});
  for (int k = 0; k < 600; ++k) {
    const double d = 0.3 + 2.5 * uniform(generator), o = uniform(generator);
    double z = d + (k % 3 == 0 ? uniform(generator) - 0.5 : 8 * (uniform(generator) - 0.5) * Sigma(d));
    if (k % 50 == 0 || z < kNearPlane) z = 0;
    const auto raw = static_cast<uint16_t>(std::lround(z * 1e4));
    z = raw * 1e-4;
    depth.at<uint16_t>(9, 7) = raw;
    model.Prepare(depth, 1e-4, grid, evidence);
    tile.row(0)[0] = static_cast<float>(d);
    const Expected expected = Reference(form(), z, tile.row(0)[0], static_cast<float>(o));
    if (std::abs(z - (d - 3 * Sigma(z))) < 1e-5) continue;  // beside the step of the full form
    std::vector<float> map(evidence.z.size(), static_cast<float>(o));
    // Far from the prediction a density is a difference of nearly equal numbers: 1e-4 covers all.
    EXPECT_NEAR(model.LogLikelihood(evidence, tile, map.data()), expected.log_ratio, 1e-4) << z << " " << d << " " << o;
    EXPECT_NEAR(model.LogLikelihood(evidence, tile, static_cast<float>(o)), expected.log_ratio, 1e-4);
    model.UpdateOcclusion(evidence, tile, map.data());
    const size_t at = static_cast<size_t>(9 * evidence.stride + 7);
    EXPECT_NEAR(map[at], expected.occlusion, 1e-4) << z << " " << d << " " << o;
    map[at] = static_cast<float>(o);
    for (const float value : map) ASSERT_EQ(value, static_cast<float>(o)) << "other points keep theirs";
  }
}

TEST_P(Form, SumsOverTheTile) {
  const ObservationModel model({}, form());
  const PixelGrid grid = SampledGrid(Camera(), 1);
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  cv::Mat depth(37, 61, CV_16UC1);
  for (int y = 0; y < 37; ++y) {
    for (int x = 0; x < 61; ++x) {
      depth.at<uint16_t>(y, x) = static_cast<uint16_t>(uniform(generator) < 0.1 ? 0 : 700 + 200 * uniform(generator));
    }
  }
  DepthEvidence evidence;
  model.Prepare(depth, 0.001, grid, evidence);
  for (const GridRectangle area : {GridRectangle{0, 0, 61, 37}, {40, 20, 21, 17}, {3, 5, 17, 9}, {60, 36, 1, 1}}) {
    RenderedDepth tile;
    tile.Reset(area);
    double expected = 0;
    PointCounts counts;
    for (int j = 0; j < area.height; ++j) {
      for (int i = 0; i < area.width; ++i) {
        if (uniform(generator) < 0.3) continue;
        const auto d = static_cast<float>(0.7 + 0.2 * uniform(generator));
        tile.row(j)[i] = d;
        const double z = depth.at<uint16_t>(area.y + j, area.x + i) * 0.001;
        expected += Reference(form(), z, d, 0.1).log_ratio;
        ++counts.predicted;
        const double t = (d - z) / Sigma(z);
        ++(z == 0 ? counts.missing : t > 3 ? counts.hidden : t < -3 ? counts.beyond : counts.agreeing);
      }
    }
    EXPECT_NEAR(model.LogLikelihood(evidence, tile, 0.1F), expected, 1e-5 * counts.predicted + 1e-4);
    const PointCounts found = CountPoints(evidence, tile);
    EXPECT_EQ(found.predicted, counts.predicted);
    EXPECT_EQ(found.missing, counts.missing);
    EXPECT_EQ(found.agreeing, counts.agreeing);
    EXPECT_EQ(found.hidden, counts.hidden);
    EXPECT_EQ(found.beyond, counts.beyond);
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, Form,
                         testing::Combine(testing::Values(OcclusionForm::kPaper, OcclusionForm::kFull),
                                          testing::Values<int64_t>(HWY_SSE4, HWY_AVX2, HWY_AVX3)));

TEST(ObservationModel, ParticlesOfAFullyHiddenPartWeighTheSame) {
  const ObservationModel model({}, OcclusionForm::kFull);
  const PixelGrid grid = SampledGrid(Camera(), 1);
  const cv::Mat hand(37, 61, CV_16UC1, cv::Scalar(600));
  DepthEvidence evidence;
  model.Prepare(hand, 0.001, grid, evidence);
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int k = 0; k < 100; ++k) {
    RenderedDepth tile;
    tile.Reset({k % 20, k % 10, 30, 20});
    for (int j = 0; j < 20; ++j) {
      for (int i = 0; i < 30; ++i) tile.row(j)[i] = 0.65F + 0.3F * uniform(generator);
    }
    EXPECT_NEAR(model.LogLikelihood(evidence, tile, uniform(generator)), 0, 1e-9);
  }
}

// The defect that the full form cures.
TEST(ObservationModel, PaperFormRewardsAHiddenPartForComingNearer) {
  const ObservationModel model({}, OcclusionForm::kPaper);
  const PixelGrid grid = SampledGrid(Camera(), 1);
  DepthEvidence evidence;
  model.Prepare(cv::Mat(37, 61, CV_16UC1, cv::Scalar(600)), 0.001, grid, evidence);
  RenderedDepth far, near;
  far.Reset({5, 5, 20, 20}, 0.9F);
  near.Reset({5, 5, 20, 20}, 0.7F);
  EXPECT_GT(model.LogLikelihood(evidence, near, 0.9F), model.LogLikelihood(evidence, far, 0.9F) + 10);
}

TEST(ObservationModel, NoDepthNoEvidence) {
  const ObservationModel model({}, OcclusionForm::kFull);
  const PixelGrid grid = SampledGrid(Camera(), 2);
  DepthEvidence evidence;
  RenderedDepth tile;
  tile.Reset({0, 0, 20, 10}, 0.8F);
  for (const cv::Mat& depth : {cv::Mat(), cv::Mat(37, 61, CV_16UC1, cv::Scalar(0))}) {
    model.Prepare(depth, 0.001, grid, evidence);
    EXPECT_EQ(model.LogLikelihood(evidence, tile, 0.1F), 0);
    EXPECT_EQ(CountPoints(evidence, tile).missing, 200);
  }
}

TEST(ObservationModel, FarReadingsAreBackground) {
  const ObservationModel model({}, OcclusionForm::kFull);
  DepthEvidence evidence;
  model.Prepare(cv::Mat(37, 61, CV_16UC1, cv::Scalar(65535)), 0.001, SampledGrid(Camera(), 1), evidence);
  RenderedDepth tile;
  tile.Reset({0, 0, 20, 10}, 0.8F);
  EXPECT_LT(model.LogLikelihood(evidence, tile, 0.1F), -200);
  EXPECT_EQ(CountPoints(evidence, tile).beyond, 200);
}

}  // namespace
}  // namespace coach
