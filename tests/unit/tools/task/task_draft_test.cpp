#include "tools/task/task_draft.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <random>

#include "common/assembly/task_file.h"
#include "common/configuration/yaml_reader.h"
#include "tests/support/test_meshes.h"
#include "tools/operator/assembly_plan.h"
#include "tools/task/learned_poses.h"
#include "tools/task/picture_book.h"
#include "tools/task/task_workshop.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

class TaskDraftTest : public testing::Test {
 protected:
  TaskDraftTest() { fs::create_directories(folder_); }
  ~TaskDraftTest() override { fs::remove_all(folder_); }

  /// The shipped rectangle, put together: each brick a piece with its slot's name.
  std::vector<MeshPiece> FinishedRectangle() const {
    std::vector<MeshPiece> pieces;
    const auto poses = SlotPoses(rectangle_, rectangle_.variants[0]);
    for (size_t s = 0; s < rectangle_.slots.size(); ++s) {
      const PartType& type = rectangle_.types[static_cast<size_t>(rectangle_.slots[s].type)];
      MeshPiece piece{type.name + ".00" + std::to_string(s), type.mesh};
      for (auto& v : piece.mesh.vertices) v = poses[s] * v;
      pieces.push_back(piece);
    }
    return pieces;
  }

  /// How far the structures of two tasks with the same parts in the same slots are from each other, whatever frames and
  /// symmetries their parts have: distances of all slots' corners, sorted.
  static std::vector<double> Distances(const Task& task) {
    const auto poses = SlotPoses(task, task.variants.at(0));
    std::vector<double> distances;
    for (size_t i = 0; i < poses.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        const auto middle = [&](size_t k) {
          return Vector3(poses[k] * Extent(task.types[static_cast<size_t>(task.slots[k].type)].mesh).centre);
        };
        distances.push_back((middle(i) - middle(j)).norm());
      }
    }
    std::sort(distances.begin(), distances.end());
    return distances;
  }

  const fs::path folder_ = fs::temp_directory_path() / ("coach_draft_" + std::to_string(getpid()));
  const Task rectangle_ = LoadTask(fs::path(COACH_SOURCE_DIR) / "deploy/tasks/rectangle_long_medium.yaml");
};

TEST_F(TaskDraftTest, AFinishedModelBecomesTheTaskItShows) {
  const TaskDraft draft = DraftOfModel("my rectangle", FinishedRectangle(), {});
  EXPECT_THAT(Doubts(draft), IsEmpty());
  const Task task = LoadTask(SaveTask(draft, folder_));
  EXPECT_EQ(task.name, "my_rectangle");
  ASSERT_EQ(task.types.size(), 2u) << "equal bricks are one type";
  EXPECT_EQ(task.types[0].count, 2);
  EXPECT_EQ(task.types[0].name, "long");
  EXPECT_EQ(task.types[1].name, "medium");
  EXPECT_EQ(task.types[0].symmetries.discrete.size(), 2u) << "the half turn";
  EXPECT_EQ(task.connections.size(), 4u);
  EXPECT_EQ(task.steps.size(), 3u) << "the last corner closes by itself";
  const auto made = Distances(task), shipped = Distances(rectangle_);
  for (size_t k = 0; k < made.size(); ++k) EXPECT_NEAR(made[k], shipped[k], 1e-4);
}

TEST_F(TaskDraftTest, PiecesOfKnownPartsTakeTheirNamesAndColours) {
  const std::vector<DraftType> known{MakeType("stick", "red", rectangle_.types[0].mesh),
                                     MakeType("bar", "yellow", rectangle_.types[1].mesh),
                                     MakeType("cube", "pink", BoxMesh({0.03, 0.03, 0.03}))};
  const TaskDraft draft = DraftOfModel("r", FinishedRectangle(), known);
  ASSERT_EQ(draft.types.size(), 2u) << "what the model has not is not in the task";
  EXPECT_EQ(draft.types[0].name, "stick");
  EXPECT_EQ(draft.types[1].colour, "yellow");
  EXPECT_THROW(DraftOfModel("r", FinishedRectangle(), {known[0]}), std::runtime_error);
}

TEST_F(TaskDraftTest, DoubtsAreSaid) {
  auto pieces = FinishedRectangle();
  for (auto& v : pieces[0].mesh.vertices) v += Vector3(0, 0, 1);
  for (auto& v : pieces[1].mesh.vertices) v += Vector3(0, 0.02, 0);
  const auto doubts = Doubts(DraftOfModel("r", pieces, {}));
  std::string all;
  for (const Remark& doubt : doubts) all += Sentence(doubt) + "; ";
  EXPECT_THAT(all, HasSubstr("touches no other part"));
  EXPECT_THAT(all, HasSubstr("overlap by"));
  TriangleMesh metres = BoxMesh({100, 50, 30});
  const auto of_units = Doubts({"r", {MakeType("a", "beige", metres)}, {}});
  ASSERT_EQ(of_units.size(), 2u);
  EXPECT_THAT(Sentence(of_units[0]), HasSubstr("are the units right"));
  EXPECT_EQ(of_units[1].kind, "colourless");
}

TEST_F(TaskDraftTest, ANameNeverLeadsOutOfTheFolder) {
  const TaskDraft draft{"../evil\nparts: []", {MakeType("a", "blue", BoxMesh({0.1, 0.05, 0.03}))}, {}};
  const auto file = SaveTask(draft, folder_);
  EXPECT_EQ(file.parent_path(), folder_);
  EXPECT_EQ(LoadTask(file).name, "___evil_parts____");
}

TEST_F(TaskDraftTest, ATaskThatIsThereIsOnlyReplacedWhenAsked) {
  const TaskDraft draft{"box", {MakeType("box", "blue", BoxMesh({0.1, 0.05, 0.03}))}, {}};
  SaveTask(draft, folder_);
  EXPECT_THROW(SaveTask(draft, folder_), std::runtime_error);
  EXPECT_EQ(LoadTask(SaveTask(draft, folder_, true)).types.size(), 1u);
  EXPECT_THROW(SaveTask({"none", {}, {}}, folder_), std::runtime_error);
  EXPECT_THROW(SaveTask({"two", {draft.types[0], draft.types[0]}, {}}, folder_), ConfigurationError)
      << "one name twice";
  EXPECT_FALSE(fs::exists(folder_ / "two.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / ".two.new"));
}

TEST_F(TaskDraftTest, AStructureIsLearnedFromTheTable) {
  const auto poses = SlotPoses(rectangle_, rectangle_.variants[0]);
  const Pose X_TF = MakePose(ExpRotation(Vector3(0, 0, 0.7)), Vector3(0.05, -0.1, 0.015));
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 1);
  LearnedPoses learned;
  PartPoses seen;
  for (int frame = 0; frame < 100; ++frame) {
    seen.utime = frame * 33'333;
    seen.parts.clear();
    // Parts are listed by type: long_1, long_2, medium_1, medium_2; slots left, front, right, back.
    for (const size_t slot : {0u, 2u, 1u, 3u}) {
      Vector6 error;
      for (int k = 0; k < 6; ++k) error[k] = noise(random) * (k < 3 ? 0.0008 : 0.008);
      Pose X = Perturb(X_TF * poses[slot], error);
      if (frame % 3 == 0) X = X * MakePose(rectangle_.types[0].symmetries.discrete[1], Vector3::Zero());
      if (frame % 20 == 7) X.translation().x() += 0.05;
      PartEstimate part;
      part.X_TP = X;
      part.status = PartStatus::kTracked;
      seen.parts.push_back(part);
    }
    learned.Add(seen);
  }
  const auto mean = learned.Mean(rectangle_);
  ASSERT_THAT(mean.problems, IsEmpty());
  const TaskDraft draft = DraftOfTable("learned", rectangle_, mean.X_TP);
  const Task task = LoadTask(SaveTask(draft, folder_, false, {.touching = learned.options().touching}));
  EXPECT_EQ(task.connections.size(), 4u);
  EXPECT_EQ(task.steps.size(), 3u);
  const auto made = Distances(task), shipped = Distances(rectangle_);
  for (size_t k = 0; k < made.size(); ++k) EXPECT_NEAR(made[k], shipped[k], 0.001);

  seen.parts[1].status = PartStatus::kLost;
  for (int frame = 0; frame < 200; ++frame) {
    seen.utime += 33'333;
    seen.parts[0].X_TP.translation().x() += 0.001;
    learned.Add(seen);
  }
  const auto problems = learned.Mean(rectangle_).problems;
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(Sentence(problems[0]), "long_1 does not lie still");
  EXPECT_EQ(Sentence(problems[1]), "long_2 is not seen well");
}

TEST_F(TaskDraftTest, ThePictureBookHasAPageAStep) {
  const auto pages = PictureBook(rectangle_);
  ASSERT_EQ(pages.size(), 5u) << "cover, three steps, the whole";
  EXPECT_EQ(pages[1].name, "step_1");
  for (const auto& page : pages) EXPECT_THAT(page.svg, HasSubstr("data:image/png;base64,")) << page.name;
  const auto poses = SlotPoses(rectangle_, rectangle_.variants[0]);
  const cv::Mat pale = DrawParts(rectangle_, {{0, poses[0], false}, {1, poses[1], true}}, 400);
  EXPECT_EQ(pale.cols, 400);
  int blue = 0, green = 0;
  for (int y = 0; y < pale.rows; ++y) {
    for (int x = 0; x < pale.cols; ++x) {
      const auto& c = pale.at<cv::Vec3b>(y, x);
      blue += c[0] > c[1] + 20 && c[0] > c[2] + 20;
      green += c[1] > c[0] + 40 && c[1] > c[2] + 40;
    }
  }
  EXPECT_GT(blue, 2000);
  EXPECT_GT(green, 2000) << "the new one is strong";
  const Task car = LoadTask(fs::path(COACH_SOURCE_DIR) / "deploy/tasks/car.yaml");
  EXPECT_EQ(PictureBook(car).size(), car.steps.size() + 2);
}

TEST_F(TaskDraftTest, TheWorkshopTakesFilesAndMakesATask) {
  TaskWorkshop workshop([this] { return folder_; });
  std::string model;
  int first = 1;
  for (const auto& piece : FinishedRectangle()) {
    model += "o " + piece.name + "\n";
    for (const auto& v : piece.mesh.vertices)
      model += std::string("v ") + std::to_string(v.x() * 1000) + " " + std::to_string(v.y() * 1000) + " " +
               std::to_string(v.z() * 1000) + "\n";
    for (const auto& t : piece.mesh.triangles)
      model += std::string("f ") + std::to_string(t[0] + first) + " " + std::to_string(t[1] + first) + " " +
               std::to_string(t[2] + first) + "\n";
    first += static_cast<int>(piece.mesh.vertices.size());
  }
  const Json added = Json::parse(workshop.AddMesh("rectangle.obj", model));
  EXPECT_EQ(added["pieces"].size(), 4u);
  EXPECT_EQ(added["pieces"][0]["name"], "long.000");
  Json asked{{"name", "<script>alert(1)</script>"},
             {"units", "mm"},
             {"model", "rectangle.obj"},
             {"colours", {{"long", "red"}}}};
  Json made = Json::parse(workshop.Make(asked.dump(), nullptr));
  EXPECT_EQ(made["joints"], 4);
  EXPECT_EQ(made["file"], "");
  EXPECT_EQ(made["parts"][0]["colour"], "red");
  EXPECT_THAT(made["picture"].get<std::string>(), testing::Not(HasSubstr("<script>")));
  asked["save"] = true;
  made = Json::parse(workshop.Make(asked.dump(), nullptr));
  EXPECT_EQ(made["file"], "_script_alert_1___script_");
  EXPECT_EQ(LoadTask(folder_ / "_script_alert_1___script_.yaml").types[0].hsv, ColourWords().at("red"));
  EXPECT_THAT(BookOf(folder_ / "_script_alert_1___script_.yaml"), HasSubstr("<svg"));

  EXPECT_THROW(workshop.AddMesh("../evil.obj", model), std::invalid_argument);
  EXPECT_THROW(workshop.AddMesh("broken.stl", "nonsense"), std::invalid_argument);
  EXPECT_THROW(workshop.Make(R"({"name": "x", "model": "missing.obj"})", nullptr), std::invalid_argument);
  EXPECT_THROW(workshop.Make(R"({"name": "x", "table": true})", nullptr), std::invalid_argument);
  EXPECT_THROW(workshop.Make(asked.dump(), nullptr), std::invalid_argument) << "there is one of this name";
}

}  // namespace
}  // namespace coach
