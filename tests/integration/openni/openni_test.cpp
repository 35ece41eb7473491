// A scene folder becomes an OpenNI2 camera, the camera an .oni recording, and the recording frames on the bus.
#include <OpenNI.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <opencv2/core.hpp>

#include "common/bus/bus.h"
#include "common/bus/image_messages.h"
#include "common/imaging/scene_folder.h"
#include "process.h"
#include "services/capture/openni_source.h"
#include "tiny_scene.h"
#include "tools/log_diff/recording.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 30;

class OpenNi : public testing::Test {
 protected:
  OpenNi() : folder_(fs::temp_directory_path() / ("coach_openni_" + std::to_string(getpid()))) {
    WriteTinyScene(folder_, kFrames);
    options_.width = 160;
    options_.height = 120;
  }
  ~OpenNi() override { fs::remove_all(folder_); }

  std::string Uri() const { return "coach-scene:" + folder_.string(); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  /// The first of the scene's frames with this depth image (they repeat after 20); -1: none.
  int FrameOf(const cv::Mat& depth) const {
    const SceneReader scene(folder_);
    for (int i = 0; i < scene.size(); ++i) {
      if (cv::norm(scene.Read(i).depth, depth, cv::NORM_INF) == 0) return i;
    }
    return -1;
  }

  /// Records both streams of a camera.
  static void Record(const std::string& uri, const std::string& file, int frames) {
    ASSERT_EQ(openni::OpenNI::initialize(), openni::STATUS_OK);
    {
      openni::Device device;
      ASSERT_EQ(device.open(uri.c_str()), openni::STATUS_OK) << openni::OpenNI::getExtendedError();
      openni::VideoStream depth, colour;
      ASSERT_EQ(depth.create(device, openni::SENSOR_DEPTH), openni::STATUS_OK);
      ASSERT_EQ(colour.create(device, openni::SENSOR_COLOR), openni::STATUS_OK);
      openni::Recorder recorder;
      ASSERT_EQ(recorder.create(file.c_str()), openni::STATUS_OK);
      recorder.attach(depth, false);
      recorder.attach(colour, false);
      depth.start();
      colour.start();
      recorder.start();
      for (int i = 0; i < frames; ++i) {
        openni::VideoFrameRef frame;
        ASSERT_EQ(depth.readFrame(&frame), openni::STATUS_OK);
      }
      recorder.stop();
      depth.stop();
      colour.stop();
    }
    openni::OpenNI::shutdown();
  }

  fs::path folder_;
  CaptureOptions options_;
};

TEST_F(OpenNi, ACameraGivesRegisteredPairsWithItsIntrinsics) {
  const auto source = OpenOpenNiDevice(Uri(), options_);
  EXPECT_FALSE(source->is_recording());
  EXPECT_EQ(source->complaint(), "");
  int64_t last = 0;
  for (int i = 0; i < 10; ++i) {
    Frame frame;
    ASSERT_EQ(source->Next(frame, 1000), FrameSource::Outcome::kFrame);
    EXPECT_GT(frame.utime, last);
    last = frame.utime;
    EXPECT_NEAR(frame.camera.fx, 130, 0.01);
    EXPECT_NEAR(frame.camera.cx, 79.5, 1e-9);
    EXPECT_EQ(frame.exposure_skew_us, 0);
    const int number = FrameOf(frame.depth);
    ASSERT_GE(number, 0);
    EXPECT_EQ(cv::norm(SceneReader(folder_).Read(number).colour, frame.colour, cv::NORM_INF), 0);
  }
}

TEST_F(OpenNi, TheStationFilesCalibrationWins) {
  options_.intrinsics = CameraModel{160, 120, 131, 132, 80, 60, {0.1, 0, 0, 0, 0}};
  Frame frame;
  ASSERT_EQ(OpenOpenNiDevice(Uri(), options_)->Next(frame, 1000), FrameSource::Outcome::kFrame);
  EXPECT_EQ(frame.camera, *options_.intrinsics);
}

TEST_F(OpenNi, ACameraThatIsNotThereIsLostNotAFailure) {
  EXPECT_THROW(OpenOpenNiDevice("coach-scene:/nowhere", options_), SourceLost);
  options_.width = 9999;
  EXPECT_THROW(OpenOpenNiDevice(Uri(), options_), SourceLost);
}

TEST_F(OpenNi, ARecordingOfTheCameraPlaysThroughCapture) {
  Record(Uri(), Path("lesson.oni"), 25);
  for (const std::string run : {"1", "2"}) {
    Process capture({Program("coach-capture"), "--station", "S", "--source", "oni:" + Path("lesson.oni"), "--lockstep",
                     "--output-url", "file://" + Path(run + ".lcm") + "?mode=w"});
    ASSERT_EQ(capture.Wait(15), 0) << capture.output();
  }
  const Recording recording = ReadRecording(Path("1.lcm"));
  EXPECT_GE(recording.at("S/DEPTH_IMAGE").size(), 20U);
  EXPECT_EQ(recording.at("S/DEPTH_IMAGE").size(), recording.at("S/COLOR_IMAGE").size());
  EXPECT_TRUE(Differences(recording, ReadRecording(Path("2.lcm"))).empty());
  Bus reader("file://" + Path("1.lcm") + "?speed=0", "S");
  int64_t last = -1;
  int last_number = -1;
  reader.Subscribe<depth_image_t>([&](const depth_image_t& m) {
    EXPECT_GT(m.utime, last);
    EXPECT_TRUE(last >= 0 || m.utime == 0);
    last = m.utime;
    const int number = FrameOf(FromMessage(m).depth);
    ASSERT_GE(number, 0) << "lossless";
    if (last_number >= 0) {
      EXPECT_LE((number - last_number + 20) % 20, 2) << "in order";
    }
    last_number = number;
  });
  while (reader.Handle(100) >= 0) {
  }
  EXPECT_EQ(reader.errors(), 0);
}

TEST_F(OpenNi, AChildAtATableIsACamera) {
  std::ofstream(Path("station.yaml")) << "station: S\nbus: {table: 'memq://'}\ntask: " COACH_SOURCE_DIR
                                         "/deploy/tasks/rectangle_long_medium.yaml\n";
  setenv("COACH_OPENNI2_CHILD", "never-listens", 1);
  setenv("COACH_OPENNI2_TRUTH", Path("truth").c_str(), 1);
  CaptureOptions options;
  options.fps = 15;
  {
    const auto source = OpenOpenNiDevice("coach-child:" + Path("station.yaml"), options);
    Frame frame;
    int64_t first = -1;
    for (int i = 0; i < 5; ++i) {
      ASSERT_EQ(source->Next(frame, 2000), FrameSource::Outcome::kFrame);
      if (first < 0) first = frame.utime;
    }
    EXPECT_GT(frame.utime, first);
    EXPECT_EQ(frame.colour.cols, 640);
    EXPECT_GT(cv::countNonZero(frame.depth), 640 * 480 / 2);
    EXPECT_GT(frame.camera.fx, 500);
  }
  unsetenv("COACH_OPENNI2_TRUTH");
  EXPECT_TRUE(fs::exists(Path("truth") + "/events.json"));
  setenv("COACH_OPENNI2_CHILD", "obeys", 1);
  EXPECT_THROW(OpenOpenNiDevice("coach-child:" + Path("station.yaml"), options), SourceLost);
  unsetenv("COACH_OPENNI2_CHILD");
}

TEST_F(OpenNi, ALiveChildIsRecordedAndPlayedThroughCapture) {
  std::ofstream(Path("station.yaml")) << "station: S\nbus: {table: 'memq://'}\ntask: " COACH_SOURCE_DIR
                                         "/deploy/tasks/rectangle_long_medium.yaml\n";
  setenv("COACH_OPENNI2_CHILD", "never-listens", 1);
  Record("coach-child:" + Path("station.yaml"), Path("child.oni"), 15);
  unsetenv("COACH_OPENNI2_CHILD");
  Process capture({Program("coach-capture"), "--station", "S", "--source", "oni:" + Path("child.oni"), "--lockstep",
                   "--output-url", "file://" + Path("child.lcm") + "?mode=w"});
  ASSERT_EQ(capture.Wait(20), 0) << capture.output();
  Bus reader("file://" + Path("child.lcm") + "?speed=0", "S");
  int played = 0;
  int64_t last = -1;
  std::vector<cv::Mat> depth;
  reader.Subscribe<depth_image_t>([&](const depth_image_t& m) {
    EXPECT_GT(m.utime, last);
    last = m.utime;
    depth.push_back(FromMessage(m).depth);
  });
  reader.Subscribe<color_image_t>([&](const color_image_t& m) {
    ++played;
    EXPECT_EQ(m.intrinsics.width, 640);
    EXPECT_EQ(m.intrinsics.height, 480);
  });
  while (reader.Handle(100) >= 0) {
  }
  EXPECT_EQ(reader.errors(), 0);
  ASSERT_GE(depth.size(), 12U);
  EXPECT_EQ(played, static_cast<int>(depth.size()));
  EXPECT_GT(cv::countNonZero(depth.back()), 640 * 480 / 2);
  EXPECT_GT(cv::norm(depth.front(), depth.back(), cv::NORM_L1), 0) << "a camera that lives";
}

TEST_F(OpenNi, AnUnpluggedCameraIsFoundAgain) {
  setenv("COACH_OPENNI2_SCENE", folder_.c_str(), 1);
  setenv("COACH_OPENNI2_UNPLUG", "20", 1);
  std::ofstream(Path("station.yaml")) << "station: S\ncamera: {source: 'openni2:', width: 160, height: 120}\n";
  Process capture({Program("coach-capture"), "--config", Path("station.yaml"), "--output-url",
                   "file://" + Path("live.lcm") + "?mode=w"});
  EXPECT_EQ(capture.Wait(5), std::nullopt) << capture.output();
  capture.Signal(SIGTERM);
  EXPECT_EQ(capture.Wait(2), 0) << capture.output();
  unsetenv("COACH_OPENNI2_UNPLUG");
  unsetenv("COACH_OPENNI2_SCENE");
  EXPECT_THAT(capture.output(), testing::HasSubstr("gone"));
  EXPECT_GT(ReadRecording(Path("live.lcm")).at("S/DEPTH_IMAGE").size(), 30U) << capture.output();
}

}  // namespace
}  // namespace coach
