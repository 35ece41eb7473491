// PART_POSES kept in a log, and the table that coach-evaluate-recordings makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "common/assembly/task_file.h"
#include "tools/evaluate_reasoner/pose_script.h"
#include "tools/evaluate_reasoner/recorded_poses.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Kind = ScriptAction::Kind;

constexpr double kRate = 15;  // Hz
const fs::path kTasks = fs::path(COACH_SOURCE_DIR) / "deploy/tasks";

fs::path Folder(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("recordings_" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

/// A corner between parts 0 and 2 after a mistake between parts 2 and 3, which is undone.
ScriptedLesson ShortLesson(const Task& task) {
  int mistake = 0;
  while (task.mistakes[mistake].name != "corner_medium_medium") ++mistake;
  return PlayScript(task, {{Kind::kMistake, mistake, 2, 3}, {Kind::kUndo, mistake, 2, 3}, {Kind::kConnect, 0, 0, 2}},
                    {}, kRate, 4);
}

TEST(RecordedPoses, ReturnAsTheyWere) {
  const Task task = LoadTask(kTasks / "rectangle_long_medium.yaml");
  const ScriptedLesson lesson = ShortLesson(task);
  const fs::path log = Folder("poses") / "poses.lcm";
  WritePartPoses(log, lesson.frames);
  const auto back = ReadPartPoses(log);
  ASSERT_EQ(back.size(), lesson.frames.size());
  for (size_t f = 0; f < back.size(); f += 7) {
    const PartPoses &x = lesson.frames[f], &y = back[f];
    EXPECT_EQ(y.utime, x.utime);
    ASSERT_EQ(y.parts.size(), x.parts.size());
    ASSERT_EQ(y.pairs.size(), x.pairs.size());
    for (size_t p = 0; p < x.parts.size(); ++p) {
      EXPECT_LT((y.parts[p].X_TP.matrix() - x.parts[p].X_TP.matrix()).norm(), 1e-5);
      EXPECT_NEAR(y.parts[p].visible_fraction, x.parts[p].visible_fraction, 1e-5);
      EXPECT_EQ(y.parts[p].status, x.parts[p].status);
    }
    for (size_t p = 0; p < x.pairs.size(); ++p) {
      EXPECT_EQ(y.pairs[p].part_b, x.pairs[p].part_b);
      EXPECT_LT((y.pairs[p].covariance - x.pairs[p].covariance).norm(), 1e-5 * x.pairs[p].covariance.norm());
      EXPECT_NEAR(y.pairs[p].surface_distance, x.pairs[p].surface_distance, 1e-6);
    }
  }
}

TEST(RecordedPoses, WhatIsRepeatedOrOutOfOrderIsLeftOut) {
  const Task task = LoadTask(kTasks / "rectangle_long_medium.yaml");
  auto frames = ShortLesson(task).frames;
  frames.resize(4);
  std::swap(frames[1], frames[2]);
  frames.push_back(frames.back());
  const fs::path log = Folder("order") / "poses.lcm";
  WritePartPoses(log, frames);
  const auto back = ReadPartPoses(log);
  ASSERT_EQ(back.size(), 3u);
  EXPECT_EQ(back[1].utime, frames[1].utime);
  EXPECT_EQ(back[2].utime, frames[3].utime);
}

TEST(RecordedPoses, ALogWithoutPosesOrNoLogIsAnError) {
  const fs::path folder = Folder("none");
  EXPECT_THROW(ReadPartPoses(folder / "missing.lcm"), std::runtime_error);
  std::ofstream(folder / "empty.lcm").flush();
  EXPECT_THROW(ReadPartPoses(folder / "empty.lcm"), std::runtime_error);
}

/// A scene folder with the truth of a scripted lesson, and the poses of it as a recording.
void WriteScene(const fs::path& scene, const fs::path& recordings) {
  fs::copy_file(kTasks / "rectangle_long_medium.yaml", scene / "task.yaml");
  fs::copy(kTasks / "meshes", scene / "meshes");
  const Task task = LoadTask(scene / "task.yaml");
  const ScriptedLesson lesson = ShortLesson(task);
  fs::create_directories(scene / "models");
  Json models, gt, info, parts = Json::array(), events = Json::array(), connections = Json::array();
  const std::map<int, std::string> mesh{{1, "brick_long"}, {2, "brick_medium"}};
  for (const auto& [id, name] : mesh) {
    models[std::to_string(id)] = Json::object();
    fs::copy_file(kTasks / "meshes" / (name + ".ply"), scene / "models" / ("obj_00000" + std::to_string(id) + ".ply"));
  }
  for (size_t f = 0; f < lesson.frames.size(); ++f) {
    Json objects = Json::array(), seen = Json::array();
    for (size_t p = 0; p < task.parts.size(); ++p) {
      objects.push_back({{"obj_id", p < 2 ? 1 : 2},
                         {"cam_R_m2c", std::array{1, 0, 0, 0, 1, 0, 0, 0, 1}},
                         {"cam_t_m2c", std::array{0, 0, 800}}});
      seen.push_back({{"visib_fract", lesson.frames[f].parts[p].visible_fraction}});
    }
    gt[std::to_string(f)] = objects;
    info[std::to_string(f)] = seen;
  }
  for (size_t p = 0; p < task.parts.size(); ++p) parts.push_back({{"name", task.parts[p].name}, {"gt_index", p}});
  for (const Connection& c : task.connections) connections.push_back({{"name", c.name}, {"class", "corner"}});
  for (const TrueEvent& e : lesson.events) {
    const std::string type = e.type == "wrong" ? "wrong_connect" : e.type;
    events.push_back({{"time", static_cast<double>(e.moment - lesson.frames[0].utime) * 1e-6},
                      {"type", type},
                      {"connection", e.names[0]},
                      {"gt", std::array{e.part_a, e.part_b}}});
  }
  std::ofstream(scene / "models/models_info.json") << models;
  std::ofstream(scene / "scene_gt.json") << gt;
  std::ofstream(scene / "scene_gt_info.json") << info;
  std::ofstream(scene / "events.json") << Json{{"events", events}};
  std::ofstream(scene / "assembly.json") << Json{{"fps", kRate}, {"connections", connections}, {"parts", parts}};
  WritePartPoses(recordings / (scene.filename().string() + "_1.lcm"), lesson.frames);
}

/// What the program prints, its errors too, and what it returns.
std::pair<std::string, int> RunProgram(const std::string& arguments) {
  const std::string command = std::string(COACH_BINARY_DIR) + "/bin/coach-evaluate-recordings " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string out;
  std::array<char, 256> buffer{};
  while (fgets(buffer.data(), buffer.size(), pipe) != nullptr) out += buffer.data();
  return {out, pclose(pipe)};
}

TEST(EvaluateRecordings, TheTableOfARecordedSceneSaysWhatWasFound) {
  const fs::path scene = Folder("scene"), recordings = Folder("logs");
  WriteScene(scene, recordings);
  const auto [out, code] = RunProgram(scene.string() + " --replay --fps 15 --recordings " + recordings.string());
  EXPECT_EQ(code, 0) << out;
  // Found, within 1 s, mistakes, undone, false, false undone; the dating error; the end state.
  EXPECT_THAT(out, testing::HasSubstr("| recordings_scene | 1 | 2/2 | 2/2 | 1/1 | 1/1 | 0 | 0 | 0."));
  EXPECT_THAT(out, testing::HasSubstr("| all |  | 2/2 | 2/2 | 1/1 | 1/1 | 0 | 0 | 0."));
  EXPECT_THAT(out, testing::HasSubstr("| yes |"));
}

TEST(EvaluateRecordings, WhatItCanNotDoIsAnErrorWithAReason) {
  const fs::path scene = Folder("bad"), recordings = Folder("bad_logs");
  EXPECT_NE(RunProgram(scene.string() + " --replay").second, 0);
  const auto [out, code] = RunProgram(scene.string() + " --replay --recordings " + recordings.string());
  EXPECT_NE(code, 0);
  EXPECT_THAT(out, testing::HasSubstr("scene_gt.json"));
}

}  // namespace
}  // namespace coach
