#include "services/detector/hsv_detector.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

namespace coach {
namespace {

const cv::Scalar kBlue(150, 60, 30), kGreen(40, 110, 30), kRed(30, 30, 180), kTable(120, 140, 150);

PartType Type(const char* name, HsvRange hsv, int count = 1) {
  PartType type;
  type.name = name;
  type.hsv = hsv;
  type.count = count;
  return type;
}

Task TwoColours() {
  Task task;
  task.types = {Type("long", {{104, 120, 40}, {124, 255, 255}}, 2), Type("medium", {{45, 80, 40}, {75, 255, 255}}),
                Type("short", {{45, 80, 40}, {75, 255, 255}})};
  return task;
}

TEST(HsvDetector, FindsRegionsByClassLargestFirst) {
  cv::Mat image(480, 640, CV_8UC3, kTable), depth(480, 640, CV_16UC1, cv::Scalar(1000));
  cv::rectangle(image, {100, 100, 60, 20}, kBlue, cv::FILLED);
  cv::rectangle(image, {300, 200, 80, 30}, kBlue, cv::FILLED);
  cv::rectangle(image, {600, 400, 40, 20}, kGreen, cv::FILLED);
  cv::rectangle(depth, {300, 200, 80, 30}, cv::Scalar(900), cv::FILLED);
  cv::rectangle(depth, {600, 400, 40, 20}, cv::Scalar(0), cv::FILLED);
  HsvDetector detector(TwoColours());
  const Detections found = detector.Detect(image, depth, 0.001);
  ASSERT_EQ(found.regions.size(), 3u);
  EXPECT_EQ(found.num_classes, 2);
  const Region &large = found.regions[0], &small = found.regions[1], &green = found.regions[2];
  EXPECT_EQ(large.colour_class, 0);
  EXPECT_EQ(large.candidate_types, 1u);
  EXPECT_EQ(large.area, 80 * 30);
  EXPECT_EQ(large.box, (std::array<int, 4>{300, 200, 80, 30}));
  EXPECT_FLOAT_EQ(large.centroid.x(), 339.5F);
  EXPECT_FLOAT_EQ(large.centroid.y(), 214.5F);
  EXPECT_FLOAT_EQ(large.median_depth, 0.9F);
  EXPECT_FALSE(large.touches_border);
  EXPECT_EQ(small.area, 60 * 20);
  EXPECT_FLOAT_EQ(small.median_depth, 1.0F);
  EXPECT_EQ(green.colour_class, 1);
  EXPECT_EQ(green.candidate_types, 0b110u) << "types of one colour share a class";
  EXPECT_TRUE(green.touches_border);
  EXPECT_EQ(green.median_depth, 0);
  EXPECT_EQ(found.class_map[215 * 640 + 340], 1);
  EXPECT_EQ(found.class_map[410 * 640 + 620], 2);
  EXPECT_EQ(found.class_map[0], 0);
}

TEST(HsvDetector, TheRoomsRangesTakeThePlaceOfTheTasks) {
  Task task = TwoColours();
  task.types[0].colour = "blue";
  task.types[1].colour = task.types[2].colour = "green";
  cv::Mat image(480, 640, CV_8UC3, kTable);
  cv::rectangle(image, {100, 100, 60, 20}, kRed, cv::FILLED);
  HsvDetectorOptions options;
  EXPECT_TRUE(HsvDetector(task, options).Detect(image, {}, 0).regions.empty());
  options.colours["green"] = {{170, 100, 50}, {10, 255, 255}};
  const Detections found = HsvDetector(task, options).Detect(image, {}, 0);
  ASSERT_EQ(found.regions.size(), 1u);
  EXPECT_EQ(found.num_classes, 2);
  EXPECT_EQ(found.regions[0].candidate_types, 0b110u);
  options.colours["long"] = options.colours["green"];
  options.colours.erase("green");
  EXPECT_EQ(HsvDetector(task, options).Detect(image, {}, 0).regions.at(0).candidate_types, 0b001u);
}

TEST(HsvDetector, OverlappingRangesMakeCandidatesOfBoth) {
  Task task;
  task.types = {Type("box", {{165, 80, 60}, {25, 255, 255}}), Type("mug", {{165, 100, 30}, {5, 255, 255}}),
                Type("other", {{100, 80, 60}, {120, 255, 255}})};
  cv::Mat image(240, 320, CV_8UC3, kTable);
  cv::rectangle(image, {50, 50, 60, 60}, kRed, cv::FILLED);
  HsvDetector detector(task);
  const Detections found = detector.Detect(image, {}, 0.001);
  ASSERT_EQ(found.regions.size(), 2u);
  for (const Region& region : found.regions) EXPECT_EQ(region.candidate_types, 0b011u);
}

TEST(HsvDetector, DropsSpecklesAndSurvivesNoise) {
  std::mt19937_64 generator(3);
  cv::Mat image(480, 640, CV_8UC3);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      image.at<cv::Vec3b>(y, x) = {static_cast<uint8_t>(generator()), static_cast<uint8_t>(generator()),
                                   static_cast<uint8_t>(generator())};
    }
  }
  HsvDetectorOptions options;
  options.closing = 0;
  HsvDetector detector(TwoColours(), options);
  const Detections found = detector.Detect(image, {}, 0.001);
  EXPECT_LE(found.regions.size(), 2u * static_cast<size_t>(options.max_regions_per_class));
  for (const Region& region : found.regions) EXPECT_GE(region.area, options.min_area);
}

TEST(HsvDetector, SameImageSameAnswerWhateverCameBefore) {
  cv::Mat image(480, 640, CV_8UC3, kTable), other(240, 320, CV_8UC3, kBlue);
  cv::circle(image, {200, 300}, 40, kBlue, cv::FILLED);
  HsvDetector detector(TwoColours()), fresh(TwoColours());
  detector.Detect(other, {}, 0.001);
  const Detections a = detector.Detect(image, {}, 0.001), b = fresh.Detect(image, {}, 0.001);
  EXPECT_EQ(a.class_map, b.class_map);
  ASSERT_EQ(a.regions.size(), b.regions.size());
  EXPECT_EQ(a.regions[0].area, b.regions[0].area);
  EXPECT_EQ(a.regions[0].centroid, b.regions[0].centroid);
}

TEST(HsvDetector, BadInputGivesNothing) {
  HsvDetector detector(TwoColours());
  EXPECT_EQ(detector.Detect({}, {}, 0.001).width, 0);
  EXPECT_TRUE(detector.Detect(cv::Mat(10, 10, CV_8UC1), {}, 0.001).class_map.empty());
  EXPECT_TRUE(detector.Detect(cv::Mat(10, 10, CV_16UC3), {}, 0.001).regions.empty());
  cv::Mat image(100, 100, CV_8UC3, kBlue);
  for (const cv::Mat& depth : {cv::Mat(), cv::Mat(50, 100, CV_16UC1), cv::Mat(100, 100, CV_32FC1)}) {
    const Detections found = detector.Detect(image, depth, 0.001);
    ASSERT_EQ(found.regions.size(), 1u);
    EXPECT_EQ(found.regions[0].median_depth, 0);
    EXPECT_EQ(found.regions[0].area, 100 * 100);
  }
  const Detections one = detector.Detect(cv::Mat(1, 1, CV_8UC3, kBlue), {}, 0.001);
  EXPECT_EQ(one.class_map.size(), 1u);
}

TEST(HsvDetector, PartOfALargerImage) {
  cv::Mat large(300, 400, CV_8UC3, kTable);
  cv::rectangle(large, {110, 60, 30, 30}, kBlue, cv::FILLED);
  const cv::Mat window = large({100, 50, 100, 100});  // rows are not contiguous
  HsvDetector detector(TwoColours());
  const Detections found = detector.Detect(window, {}, 0.001);
  ASSERT_EQ(found.regions.size(), 1u);
  EXPECT_EQ(found.regions[0].box, (std::array<int, 4>{10, 10, 30, 30}));
}

TEST(HsvDetector, RefusesBadOptions) {
  HsvDetectorOptions options;
  options.shared_colour = 0;
  EXPECT_THROW(HsvDetector(TwoColours(), options), std::invalid_argument);
  options = {};
  options.closing = -1;
  EXPECT_THROW(HsvDetector(TwoColours(), options), std::invalid_argument);
}

}  // namespace
}  // namespace coach
