// Stage 1 on 640 x 480, without decoding: the whole detector and its two halves.
#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>

#include "services/detector/hsv_detector.h"

namespace coach {
namespace {

Task TaskWithClasses(int classes) {
  Task task;
  for (int c = 0; c < classes; ++c) {
    PartType type;
    type.hsv = {{20 * c, 120, 40}, {20 * c + 12, 255, 255}};
    task.types.push_back(type);
  }
  return task;
}

/// A noisy table with bricks in the colours of the classes.
cv::Mat Scene(int classes) {
  cv::Mat image(480, 640, CV_8UC3), noise(480, 640, CV_8UC3);
  cv::theRNG().state = 1;
  cv::randu(noise, 0, 40);
  image.setTo(cv::Scalar(120, 140, 150));
  for (int i = 0; i < 3 * classes; ++i) {
    cv::Mat bgr, hsv(1, 1, CV_8UC3, cv::Scalar(20 * (i % classes) + 6, 200, 150));
    cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
    const cv::RotatedRect brick({60.0F + 80.0F * static_cast<float>(i % 7), 60.0F + 90.0F * static_cast<float>(i / 7)},
                                {70, 25}, 37.0F * static_cast<float>(i));
    cv::Point2f corners[4];
    brick.points(corners);
    const std::vector<cv::Point> polygon(corners, corners + 4);
    cv::fillConvexPoly(image, polygon, cv::Scalar(bgr.at<cv::Vec3b>(0, 0)));
  }
  return image + noise;
}

void BM_Detect(benchmark::State& state) {
  const int classes = static_cast<int>(state.range(0));
  const cv::Mat image = Scene(classes), depth(480, 640, CV_16UC1, cv::Scalar(900));
  HsvDetector detector(TaskWithClasses(classes));
  size_t regions = 0;
  for (auto _ : state) regions = detector.Detect(image, depth, 0.001).regions.size();
  state.counters["regions"] = static_cast<double>(regions);
}
BENCHMARK(BM_Detect)->Arg(1)->Arg(2)->Arg(4)->Arg(8)->Unit(benchmark::kMicrosecond);

void BM_DetectBalanced(benchmark::State& state) {
  const cv::Mat image = Scene(2), depth(480, 640, CV_16UC1, cv::Scalar(900));
  HsvDetectorOptions options;
  options.background = Chromaticity{0, 0.1};
  HsvDetector detector(TaskWithClasses(2), options);
  for (auto _ : state) benchmark::DoNotOptimize(detector.Detect(image, depth, 0.001).regions.data());
}
BENCHMARK(BM_DetectBalanced)->Unit(benchmark::kMicrosecond);

void BM_Classify(benchmark::State& state) {
  const cv::Mat image = Scene(4);
  const ColourTable table({{{0, 120, 40}, {12, 255, 255}}, {{60, 120, 40}, {72, 255, 255}}});
  std::vector<uint8_t> classes(image.total());
  for (auto _ : state) {
    table.Classify(image, {1, 1, 1}, classes.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_Classify)->Unit(benchmark::kMicrosecond);

void BM_Regions(benchmark::State& state) {
  const cv::Mat image = Scene(1);
  std::vector<uint8_t> classes(image.total());
  ColourTable(std::vector<HsvRange>{{{0, 120, 40}, {12, 255, 255}}}).Classify(image, {1, 1, 1}, classes.data());
  BitImage bits, scratch;
  ConnectedComponents components;
  for (auto _ : state) {
    ExtractBit(classes.data(), image.cols, image.rows, 0, bits);
    Close(1, bits, scratch);
    components.Find(bits);
    benchmark::DoNotOptimize(components.components().data());
  }
}
BENCHMARK(BM_Regions)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace coach
