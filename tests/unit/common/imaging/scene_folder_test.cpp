#include "common/imaging/scene_folder.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SceneFolder : public testing::Test {
 protected:
  SceneFolder() {
    folder_ = fs::temp_directory_path() / ("coach_scene_" + std::to_string(getpid()) +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  ~SceneFolder() override { fs::remove_all(folder_); }

  static Frame MakeFrame(int number) {
    Frame frame;
    frame.camera = {32, 24, 30.5, 31.5, 15.25, 12.75, {}};
    frame.metres_per_unit = 0.0001;
    frame.colour = cv::Mat(24, 32, CV_8UC3, cv::Scalar(number, 100, 200));
    frame.depth = cv::Mat(24, 32, CV_16UC1, cv::Scalar(1000 + number));
    return frame;
  }
  void WriteScene(int frames) const {
    SceneWriter writer(folder_);
    for (int i = 0; i < frames; ++i) writer.Write(MakeFrame(i));
  }
  void WriteCameras(const std::string& text) const { std::ofstream(folder_ / "scene_camera.json") << text; }
  std::string OpenError() const {
    try {
      SceneReader reader(folder_);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(SceneFolder, WhatIsWrittenIsRead) {
  WriteScene(3);
  const SceneReader reader(folder_, {.fps = 15, .utime_origin = 7});
  ASSERT_EQ(reader.size(), 3);
  for (int i = 0; i < 3; ++i) {
    const Frame expected = MakeFrame(i), frame = reader.Read(i);
    EXPECT_EQ(reader.im_id(i), i);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.received_utime, 0);
    EXPECT_EQ(frame.camera, expected.camera);
    EXPECT_DOUBLE_EQ(frame.metres_per_unit, 0.0001);
    EXPECT_EQ(cv::norm(frame.colour, expected.colour, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(frame.depth, expected.depth, cv::NORM_INF), 0);
  }
  EXPECT_EQ(reader.Read(1).utime, 7 + 66'667);
  EXPECT_EQ(reader.Read(2).utime, 7 + 133'333);
}

TEST_F(SceneFolder, JpegColourIsFoundToo) {
  SceneWriter(folder_, {.jpeg = true}).Write(MakeFrame(5));
  EXPECT_TRUE(fs::exists(folder_ / "rgb/000000.jpg"));
  EXPECT_LT(cv::norm(SceneReader(folder_).Read(0).colour, MakeFrame(5).colour, cv::NORM_INF), 4);
}

TEST_F(SceneFolder, AGapInTheIdsIsAGapInTime) {
  WriteScene(10);
  WriteCameras(
      R"({"9": {"cam_K": [30,0,15,0,30,12,0,0,1]}, "2": {"cam_K": [30,0,15,0,30,12,0,0,1], "depth_scale": 0.1}})");
  const SceneReader reader(folder_, {.fps = 10});
  EXPECT_EQ(reader.im_id(0), 2);
  EXPECT_EQ(reader.im_id(1), 9);
  EXPECT_EQ(reader.utime(1), 700'000);
  EXPECT_DOUBLE_EQ(reader.Read(0).metres_per_unit, 0.0001);
  EXPECT_DOUBLE_EQ(reader.Read(1).metres_per_unit, 0.001);
}

TEST_F(SceneFolder, MissingFolderNamesTheFile) {
  EXPECT_THAT(OpenError(), HasSubstr((folder_ / "scene_camera.json").string()));
}

TEST_F(SceneFolder, BrokenJsonSaysWhere) {
  WriteScene(1);
  WriteCameras("{\"0\": {\"cam_K\": [1, 2,");
  EXPECT_THAT(OpenError(),
              testing::AllOf(HasSubstr("scene_camera.json"), HasSubstr("not valid JSON"), HasSubstr("line 1")));
}

TEST_F(SceneFolder, UnusableCamerasSayWhatWasExpected) {
  WriteScene(1);
  const std::pair<const char*, const char*> cases[] = {
      {"[]", "one entry an image"},
      {"{}", "one entry an image"},
      {R"({"0": 3})", "cam_K"},
      {R"({"x": {"cam_K": [30,0,15,0,30,12,0,0,1]}})", "must be a number"},
      {R"({"-1": {"cam_K": [30,0,15,0,30,12,0,0,1]}})", "must be a number"},
      {R"({"0": {"cam_K": [30,0,15]}})", "9 numbers"},
      {R"({"0": {"cam_K": [30,0,15,0,30,12,0,0,"1"]}})", "cam_K[8]"},
      {R"({"0": {"cam_K": [30,0,15,0,-30,12,0,0,1]}})", "positive"},
      {R"({"0": {"cam_K": [30,1,15,0,30,12,0,0,1]}})", "camera matrix"},
      {R"({"0": {"cam_K": [30,0,1e9,0,30,12,0,0,1]}})", "image \"0\""},
      {R"({"0": {"cam_K": [30,0,15,0,30,12,0,0,1], "depth_scale": 0}})", "depth_scale"},
  };
  for (const auto& [text, expected] : cases) {
    WriteCameras(text);
    EXPECT_THAT(OpenError(), HasSubstr(expected)) << text;
  }
}

TEST_F(SceneFolder, AMissingFrameIsNamed) {
  WriteScene(3);
  fs::remove(folder_ / "depth/000001.png");
  EXPECT_THAT(OpenError(), HasSubstr("000001.png is missing"));
  WriteScene(3);
  fs::remove(folder_ / "rgb/000002.png");
  EXPECT_THAT(OpenError(), HasSubstr("000002.png or 000002.jpg is missing"));
}

TEST_F(SceneFolder, AnImageOfAnotherSizeOrKindIsNamed) {
  WriteScene(3);
  const SceneReader reader(folder_);
  cv::imwrite((folder_ / "rgb/000001.png").string(), cv::Mat(24, 33, CV_8UC3, cv::Scalar(1, 2, 3)));
  cv::imwrite((folder_ / "depth/000002.png").string(), cv::Mat(24, 32, CV_8UC1, cv::Scalar(9)));
  const auto error = [&](int index) -> std::string {
    try {
      reader.Read(index);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error(0), "");
  EXPECT_THAT(error(1), testing::AllOf(HasSubstr("rgb/000001.png"), HasSubstr("33 x 24"), HasSubstr("32 x 24")));
  EXPECT_THAT(error(2), testing::AllOf(HasSubstr("depth/000002.png"), HasSubstr("16-bit")));
  std::ofstream(folder_ / "rgb/000000.png") << "no image";
  EXPECT_THAT(error(0), testing::AllOf(HasSubstr("rgb/000000.png"), HasSubstr("cannot be decoded")));
}

TEST_F(SceneFolder, WriterRefusesHalfFrames) {
  SceneWriter writer(folder_);
  Frame frame = MakeFrame(0);
  frame.depth = cv::Mat();
  EXPECT_THROW(writer.Write(frame), std::invalid_argument);
}

TEST(RecordedScenes, AreRead) {
  const fs::path scenes = fs::path(COACH_SOURCE_DIR).parent_path() / "shared/scenes";
  if (!fs::exists(scenes)) GTEST_SKIP() << scenes << " is not there";
  for (const auto& [name, frames] :
       {std::pair{"assemble_dev", 825}, {"fig4_dev", 420}, {"real_ycbv", 10}, {"real_tabletop", 45}}) {
    const SceneReader reader(scenes / name);
    EXPECT_EQ(reader.size(), frames);
    EXPECT_EQ(reader.Read(0).colour.cols, 640);
  }
}

}  // namespace
}  // namespace coach
