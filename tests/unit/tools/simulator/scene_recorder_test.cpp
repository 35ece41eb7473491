#include "tools/simulator/scene_recorder.h"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "common/assembly/task_file.h"
#include "common/imaging/scene_folder.h"

namespace coach {
namespace {

using Json = nlohmann::json;

Json Read(const std::filesystem::path& file) { return Json::parse(std::ifstream(file)); }

class SceneRecorderTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove_all(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / "coach_scene_recorder_test";
};

TEST_F(SceneRecorderTest, WritesASceneThatCanBeRead) {
  ScenarioOptions options;
  options.name = "dropped_frames";
  options.seconds = 1;
  const Scenario scenario =
      MakeScenario(LoadTask(COACH_SOURCE_DIR "/deploy/tasks/rectangle_long_medium.yaml"), options);
  RecordScene(scenario, folder_, {}, {});
  const SceneReader reader(folder_);
  ASSERT_EQ(reader.size(), static_cast<int>(scenario.image_ids.size()));
  const Json gt = Read(folder_ / "scene_gt.json"), info = Read(folder_ / "scene_gt_info.json");
  for (int i = 0; i < reader.size(); ++i) {
    EXPECT_EQ(reader.im_id(i), scenario.image_ids[static_cast<size_t>(i)]);
    EXPECT_EQ(gt.at(std::to_string(reader.im_id(i))).size(), 4u);
    EXPECT_EQ(info.at(std::to_string(reader.im_id(i))).size(), 4u);
  }
  const Frame frame = reader.Read(0);
  EXPECT_EQ(frame.colour.cols, 640);
  EXPECT_GT(cv::countNonZero(frame.depth), 640 * 480 / 2);
  // The task can be loaded again, with the colours that the pictures show.
  const Task task = LoadTask(folder_ / "task.yaml");
  EXPECT_EQ(task.parts.size(), 4u);
  EXPECT_EQ(task.connections.size(), scenario.stage.task.connections.size());
  EXPECT_EQ(task.types[0].symmetries.discrete.size(), 2u);
  const auto& hsv = task.types[0].hsv;
  EXPECT_LT(hsv.high[0] - hsv.low[0], 45);
}

TEST_F(SceneRecorderTest, DepthOfAVisiblePartIsItsTrueDepth) {
  ScenarioOptions options;
  options.name = "start";
  options.seconds = 0.1;
  const Scenario scenario =
      MakeScenario(LoadTask(COACH_SOURCE_DIR "/deploy/tasks/rectangle_long_medium.yaml"), options);
  FrameTruth truth;
  const Frame frame = Simulator(scenario.stage, 1).Render(scenario.performance, scenario.camera, 0, &truth);
  for (const PartTruth& part : truth.parts) {
    ASSERT_GT(part.visible_fraction(), 0.5);
    const Eigen::Vector2d pixel = scenario.stage.camera.Project(part.X_CP.translation());
    const double z = 0.001 * frame.depth.at<uint16_t>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()));
    // The surface is 10 to 40 mm before the centre of a brick of 30 mm.
    if (z > 0) {
      EXPECT_NEAR(z, part.X_CP.translation().z() - 0.02, 0.025);
    }
  }
}

}  // namespace
}  // namespace coach
