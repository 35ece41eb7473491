#include "tools/operator/table_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "services/robot_bridge/robot_options.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Straight down on a grey table 70 cm away with a blue block on it.
Frame TableWithBlock() {
  Frame frame;
  frame.camera = {640, 480, 570, 570, 319.5, 239.5, {}};
  frame.colour = cv::Mat(480, 640, CV_8UC3, cv::Scalar(140, 160, 170));
  frame.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(700));
  cv::rectangle(frame.colour, {300, 200, 60, 30}, cv::Scalar(190, 90, 20), cv::FILLED);
  cv::rectangle(frame.depth, {300, 200, 60, 30}, cv::Scalar(670), cv::FILLED);
  return frame;
}

class TableSetupTest : public testing::Test {
 protected:
  TableSetupTest() {
    fs::create_directories(folder_);
    Write("");
  }
  ~TableSetupTest() override { fs::remove_all(folder_); }

  void Write(const std::string& text) const { std::ofstream(file_) << text; }
  std::string Read(const fs::path& file) const {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  Json Status() const { return Json::parse(setup_.Status()); }

  const fs::path folder_ = fs::temp_directory_path() / ("coach_setup_" + std::to_string(getpid()));
  const fs::path file_ = folder_ / "station.yaml";
  std::optional<Frame> frame_ = TableWithBlock();
  Lesson lesson_{{}};
  TableSetup setup_{
      {file_, folder_ / "state", fs::path(COACH_SOURCE_DIR) / "deploy/tasks", [this] { return frame_; }, &lesson_}};
};

TEST_F(TableSetupTest, AnEmptyStationFileBecomesACompleteOne) {
  const Json before = Status();
  EXPECT_EQ(before["task"]["choice"], "");
  EXPECT_THAT(before["tasks"].get<std::vector<std::string>>(), Contains("square"));
  EXPECT_THAT(before["camera"]["problems"].get<std::vector<std::string>>(), IsEmpty());
  EXPECT_EQ(before["camera"]["distance_cm"], 70);

  Json after = Json::parse(setup_.Save(R"({"task": "two_bricks"})"));
  EXPECT_EQ(after["task"]["choice"], "two_bricks");
  ASSERT_FALSE(after["colours"].empty());
  EXPECT_FALSE(after["colours"][0]["own"]);
  const std::string colour = after["colours"][0]["name"];

  const Json suggested = Json::parse(setup_.SuggestColour(Json{{"x", 330}, {"y", 215}, {"colour", colour}}.dump()));
  EXPECT_GT(suggested["pixels"], 1000);
  EXPECT_EQ(suggested["table_share"], 0);
  after = Json::parse(setup_.Save(Json{{"colours", {{colour, suggested["range"]}}}}.dump()));
  EXPECT_TRUE(after["colours"][0]["own"]);
  EXPECT_EQ(after["colours"][0]["range"], suggested["range"]);
  setup_.Save(R"({"robot": {"volume": 0.4, "position": [0, 0.45, 0.1], "roll_pitch_yaw": [0, 0, -90]}})");

  const Station station = ReadStation(file_);
  EXPECT_EQ(station.task, (fs::path(COACH_SOURCE_DIR) / "deploy/tasks/two_bricks.yaml").lexically_normal());
  EXPECT_EQ(station.state_folder, folder_ / "state");
  EXPECT_DOUBLE_EQ(station.Section("robot").Get<double>("volume"), 0.4);
  EXPECT_TRUE(fs::is_directory(folder_ / "state"));
  EXPECT_TRUE(fs::exists(folder_ / "station.yaml.1"));
  EXPECT_THAT(Read(folder_ / "station.yaml.1"), HasSubstr("colours")) << "the version before the last";

  after = Json::parse(setup_.Save(Json{{"colours", {{colour, nullptr}}}}.dump()));
  EXPECT_FALSE(after["colours"][0]["own"]) << "back to the task's own range";
}

TEST_F(TableSetupTest, SaysWhichServicesRunWithOlderSettings) {
  setup_.OnConfiguration("detector", "");
  EXPECT_THAT(Status()["old"].get<std::vector<std::string>>(), IsEmpty());
  setup_.Save(R"({"task": "square"})");
  setup_.OnConfiguration("operator", "");
  setup_.OnConfiguration("capture", "");
  EXPECT_THAT(Status()["old"].get<std::vector<std::string>>(), ElementsAre("detector"));
  setup_.OnConfiguration("detector", Read(file_));
  EXPECT_THAT(Status()["old"].get<std::vector<std::string>>(), IsEmpty());
}

TEST_F(TableSetupTest, WhatTheServicesWouldRefuseIsNotSaved) {
  setup_.Save(R"({"task": "square"})");
  const std::string good = Read(file_);
  for (const char* bad :
       {R"({"task": "../../etc/passwd"})", R"({"task": "castle"})", R"({"robot": {"volume": 7}})",
        R"({"robot": {"back_end": "tank"}})", R"({"robot": {"position": [1, 2]}})", R"({"robot": {"url": "http://x"}})",
        R"({"colours": {"blue": {"low": [0, 300, 0], "high": [1, 2, 3]}}})", R"({"colours": {"blue": 5}})"}) {
    EXPECT_THROW(setup_.Save(bad), ConfigurationError) << bad;
    EXPECT_EQ(Read(file_), good) << bad;
  }
  EXPECT_THROW(setup_.Save("nonsense"), Json::exception);
}

TEST_F(TableSetupTest, AnUnusableStationFileOrTaskIsSaidAndNothingBreaks) {
  Write("nonsense: [1");
  EXPECT_EQ(Status()["task"]["choice"], "");
  EXPECT_THROW(setup_.Save(R"({"task": "square"})"), ConfigurationError);
  Write("task: missing.yaml");
  EXPECT_THAT(Status()["task"]["problem"].get<std::string>(), HasSubstr("missing.yaml"));
}

TEST_F(TableSetupTest, WithoutACameraOrATaskColoursCannotBeChosen) {
  EXPECT_THROW(setup_.SuggestColour(R"({"x": 1, "y": 1, "colour": "blue"})"), std::invalid_argument);
  setup_.Save(R"({"task": "square"})");
  cv::rectangle(frame_->depth, {0, 0, 640, 50}, cv::Scalar(2000), cv::FILLED);
  EXPECT_THROW(setup_.SuggestColour(R"({"x": 9, "y": 9, "colour": "blue"})"), std::invalid_argument) << "a far wall";
  frame_.reset();
  EXPECT_THROW(setup_.SuggestColour(R"({"x": 1, "y": 1, "colour": "blue"})"), std::invalid_argument);
  EXPECT_THAT(Status()["camera"]["problems"].get<std::vector<std::string>>(), ElementsAre("no_picture"));
  EXPECT_THROW(setup_.SuggestSeat(R"({"near": 0, "far": 1, "ahead": 0.15, "height": 0.1})"), std::invalid_argument);
}

TEST_F(TableSetupTest, AnotherAddressKeepsTheRobotsLogin) {
  Write("robot:\n  nao: {url: \"tcps://a:9503\", user: nao, token: secret}  # ours\n");
  setup_.Save(R"({"robot": {"back_end": "nao", "url": "tcps://a:9503"}})");
  EXPECT_THAT(Read(file_), HasSubstr("  nao: {url: \"tcps://a:9503\", user: nao, token: secret}  # ours\n"));
  setup_.Save(R"({"robot": {"back_end": "nao", "url": "tcps://b:9503"}})");
  const NaoOptions nao = ReadRobotOptions(ReadStation(file_).Section("robot")).nao;
  EXPECT_EQ(nao.url, "tcps://b:9503");
  EXPECT_EQ(nao.user, "nao");
  EXPECT_EQ(nao.token, "secret");
}

TEST_F(TableSetupTest, TheSeatComesFromTheTrackedParts) {
  PartPoses poses;
  poses.parts.resize(2);
  poses.parts[0].X_TP.translation() = Vector3(0, 0.3, 0.015);
  poses.parts[1].X_TP.translation() = Vector3(0, 0.1, 0.015);
  for (auto& part : poses.parts) part.status = PartStatus::kTracked;
  lesson_.OnPoses(poses);
  const Json seat = Json::parse(setup_.SuggestSeat(R"({"near": 0, "far": 1, "ahead": 0.15, "height": 0.1})"));
  EXPECT_EQ(seat["position"], Json({0.0, 0.45, 0.1}));
  EXPECT_EQ(seat["roll_pitch_yaw"], Json({0.0, 0.0, -90.0}));
  EXPECT_THROW(setup_.SuggestSeat(R"({"near": 0, "far": 0, "ahead": 0.15, "height": 0.1})"), std::invalid_argument);
}

}  // namespace
}  // namespace coach
