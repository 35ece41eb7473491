#include "tools/track_sequence/sequence_tracker.h"

#include <gtest/gtest.h>

#include "common/imaging/scene_folder.h"
#include "tests/support/test_scene.h"
#include "tracked_files.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 12;

/// Two parts, one of which moves; written once.
class SequenceTracker : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder("coach_sequence_tracker_test");
    const fs::path scene = Scene();
    const Task task =
        TestTask({TestType("l", LMesh(), true, 1), TestType("brick", BoxMesh({0.09, 0.045, 0.03}), false, 1)});
    {
      SceneWriter writer(scene);
      for (int k = 0; k < kFrames; ++k) {
        const TestPicture picture =
            DrawScene(task, {OnTable(-0.1 + 0.005 * k, 0, 0.3), OnTable(0.12, -0.05, 1)}, static_cast<uint64_t>(k));
        Frame frame;
        frame.camera = picture.camera;
        frame.colour = picture.colour;
        frame.depth = picture.depth;
        writer.Write(frame);
      }
    }
    fs::create_directories(scene / "models");
    WritePly(scene / "models" / "l.ply", task.types[0].mesh, 1000);
    WritePly(scene / "models" / "brick.ply", task.types[1].mesh, 1000);
    std::ofstream(scene / "task.yaml") << R"(name: two_parts
units: mm
parts:
  - {type: l, count: 1, mesh: models/l.ply, mesh_units: mm, bop_id: 1, colour: blue, hsv: {low: [104, 120, 40], high: [124, 255, 255]}}
  - {type: brick, count: 1, mesh: models/brick.ply, mesh_units: mm, bop_id: 2, colour: green, hsv: {low: [45, 80, 40], high: [75, 255, 255]}}
slots:
  - {name: a, type: l}
  - {name: b, type: brick}
connections:
  - {name: c1, slots: [a, b], rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], translation: [105, 7.5, 0]}
steps: [c1]
)";
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static fs::path Scene() { return folder_->path() / "000001"; }

  /// The message of the error that tracking ends with; empty: none.
  static std::string Error(const fs::path& scene, const fs::path& task) {
    SequenceOptions options;
    options.scene = scene;
    options.task = task;
    options.poses = folder_->path() / "error.csv";
    try {
      TrackSequence(options);
    } catch (const std::exception& e) {
      return e.what();
    }
    return {};
  }
  static ScratchFolder* folder_;
};
ScratchFolder* SequenceTracker::folder_ = nullptr;

TEST_F(SequenceTracker, OneRowAPartAndFrameAndThePosesAreRight) {
  const TrackedFiles files = Track(Scene(), 30);
  std::istringstream rows(files.poses);
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "scene_id,im_id,obj_id,score,R,t,time");
  int count = 0;
  while (std::getline(rows, row)) {
    std::stringstream fields(row);
    std::string scene, image, object, score, R, t;
    for (std::string* field : {&scene, &image, &object, &score, &R, &t}) std::getline(fields, *field, ',');
    EXPECT_EQ(scene, "1");
    const int k = std::stoi(image);
    EXPECT_EQ(k, count / 2);
    const Vector3 truth = (object == "1" ? OnTable(-0.1 + 0.005 * k, 0, 0.3) : OnTable(0.12, -0.05, 1)).translation();
    std::stringstream numbers(t);
    Vector3 p;
    numbers >> p.x() >> p.y() >> p.z();
    EXPECT_GT(std::stod(score), 0) << row;
    EXPECT_LT((p * 1e-3 - truth).norm(), 0.005) << row;
    ++count;
  }
  EXPECT_EQ(count, 2 * kFrames);
}

TEST_F(SequenceTracker, SameSeedSameFiles) {
  for (const bool paper : {false, true}) {
    const TrackedFiles first = Track(Scene(), 30, 5, paper);
    EXPECT_TRUE(first == Track(Scene(), 30, 5, paper)) << paper;
    // The paper's result is a mean of particles; the full mode's is a refined one, which other particles lead to too.
    if (paper) {
      EXPECT_FALSE(first.poses == Track(Scene(), 30, 6, paper).poses);
    }
  }
}

// Ground truth and whatever else lies beside the images changes nothing.
TEST_F(SequenceTracker, AStrippedSceneGivesTheSameBytes) {
  const fs::path rich = folder_->path() / "rich" / "000001", stripped = folder_->path() / "stripped" / "000001";
  CopyStripped(Scene(), stripped, kFrames);
  CopyStripped(Scene(), rich, kFrames);
  nlohmann::json cameras = nlohmann::json::parse(Contents(rich / "scene_camera.json")), truth;
  for (auto& [id, camera] : cameras.items()) {
    camera["cam_R_w2c"] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    camera["cam_t_w2c"] = {1.0 * std::stoi(id), 2, 3};
    truth[id] = {{{"cam_R_m2c", {1, 0, 0, 0, 1, 0, 0, 0, 1}}, {"cam_t_m2c", {0, 0, 700}}, {"obj_id", 1}}};
  }
  std::ofstream(rich / "scene_camera.json") << cameras.dump();
  std::ofstream(rich / "scene_gt.json") << truth.dump();
  std::ofstream(rich / "scene_gt_info.json") << "{}";
  std::ofstream(rich / "events.json") << "[]";
  EXPECT_TRUE(Track(rich, 30) == Track(stripped, 30));
}

TEST_F(SequenceTracker, TheFutureChangesNothing) {
  const fs::path half = folder_->path() / "half" / "000001";
  CopyStripped(Scene(), half, kFrames / 2);
  const TrackedFiles whole = Track(Scene(), 30), first = Track(half, 30);
  EXPECT_GT(first.poses.size(), whole.poses.size() / 3);
  EXPECT_TRUE(whole.poses.starts_with(first.poses));
  EXPECT_TRUE(whole.states.starts_with(first.states));
  EXPECT_TRUE(whole.events.starts_with(first.events));
}

TEST_F(SequenceTracker, BadInputsAreNamed) {
  const fs::path task = Scene() / "task.yaml";
  EXPECT_NE(Error(folder_->path() / "nowhere", task).find("nowhere"), std::string::npos);
  EXPECT_NE(Error(Scene(), folder_->path() / "no_task.yaml").find("no_task.yaml"), std::string::npos);

  const fs::path bad = folder_->path() / "bad" / "000001";
  const auto renew = [&] {
    fs::remove_all(bad);
    CopyStripped(Scene(), bad, 3);
  };
  renew();
  fs::remove(bad / "depth" / "000002.png");
  EXPECT_NE(Error(bad, task).find("000002"), std::string::npos);
  renew();
  std::ofstream(bad / "rgb" / "000001.png") << "no picture";
  EXPECT_NE(Error(bad, task).find("000001.png"), std::string::npos);
  renew();
  std::ofstream(bad / "scene_camera.json") << "{\"0\": {";
  EXPECT_NE(Error(bad, task).find("scene_camera.json"), std::string::npos);
  renew();
  fs::remove(bad / "models" / "brick.ply");
  EXPECT_NE(Error(bad, bad / "task.yaml").find("brick.ply"), std::string::npos);
  renew();
  std::ofstream(bad / "task.yaml", std::ios::app) << "colour_of_the_moon: 3\n";
  const std::string message = Error(bad, bad / "task.yaml");
  EXPECT_NE(message.find("task.yaml"), std::string::npos) << message;
  EXPECT_NE(message.find("colour_of_the_moon"), std::string::npos) << message;

  SequenceOptions options;
  options.scene = Scene();
  options.task = task;
  options.poses = folder_->path() / "no_folder" / "poses.csv";
  try {
    TrackSequence(options);
    ADD_FAILURE() << "wrote into a folder that is not there";
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find("poses.csv"), std::string::npos);
  }
  options.poses.clear();
  options.initial_poses_from_gt = true;
  try {
    TrackSequence(options);
    ADD_FAILURE() << "there is no ground truth";
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find("scene_gt.json"), std::string::npos);
  }
}

}  // namespace
}  // namespace coach
