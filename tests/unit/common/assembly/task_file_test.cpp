#include "common/assembly/task_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/configuration/yaml_reader.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSquareRing = R"(name: ring
units: mm
parts:
  - type: bar
    count: 4
    mesh: bar.ply
    bop_id: 3
    colour: blue
    hsv: {low: [170, 100, 50], high: [10, 255, 255]}
slots:
  - {name: s1, type: bar}
  - {name: s2, type: bar}
  - {name: s3, type: bar}
  - {name: s4, type: bar}
connections:
  - {name: c1, slots: [s1, s2], rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1], translation: [45, 45, 0]}
  - {name: c2, slots: [s2, s3], rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1], translation: [45, 45, 0]}
  - {name: c3, slots: [s3, s4], rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1], translation: [45, 45, 0]}
  - {name: c4, slots: [s4, s1], rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1], translation: [45, 45, 0], closes_by_itself: true}
mistakes:
  - {name: line, types: [bar, bar], rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], translation: [90, 0, 0]}
)";

class TaskFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("task_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    std::ofstream(folder_ / "bar.ply") << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float "
                                          "y\nproperty float z\nelement face 4\nproperty list uchar int "
                                          "vertex_indices\nend_header\n0 0 0\n90 0 0\n0 30 0\n0 0 30\n3 0 2 1\n3 0 1 "
                                          "3\n3 0 3 2\n3 1 2 3\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  Task Load(const std::string& text) {
    std::ofstream(folder_ / "task.yaml") << text;
    return LoadTask(folder_ / "task.yaml");
  }
  /// The error for the ring's file with `from` replaced by `to`, without the folder.
  std::string ErrorWith(const std::string& from, const std::string& to) {
    std::string text = kSquareRing;
    const size_t at = text.find(from);
    if (at == std::string::npos) return "the test's text does not hold " + from;
    text.replace(at, from.size(), to);
    try {
      Load(text);
    } catch (const ConfigurationError& e) {
      return std::string(e.what()).substr(folder_.string().size() + 1);
    }
    return "no error";
  }
  fs::path folder_;
};

TEST_F(TaskFile, ReadsEverything) {
  const Task task = Load(kSquareRing);
  EXPECT_EQ(task.name, "ring");
  ASSERT_EQ(task.parts.size(), 4u);
  EXPECT_EQ(task.parts[3].name, "bar_4");
  EXPECT_EQ(task.types[0].hsv.low[0], 170);
  EXPECT_NEAR(Extent(task.types[0].mesh).high.x(), 0.09, 1e-9);
  EXPECT_NEAR(task.connections[0].X_AB.translation().x(), 0.045, 1e-12);
  EXPECT_THAT(task.steps, testing::ElementsAre(0, 1, 2));  // default: without the one that closes by itself
  ASSERT_EQ(task.variants.size(), 1u);
  EXPECT_THAT(task.variants[0], testing::ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(task.sha256.size(), 64u);
  EXPECT_TRUE(task.types[0].symmetries.trivial());
}

TEST_F(TaskFile, SymmetriesComeFromModelsInfoUnlessGiven) {
  std::ofstream(folder_ / "models_info.json")
      << R"({"3": {"diameter": 90, "symmetries_discrete": [[-1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1]]}})";
  EXPECT_EQ(Load(kSquareRing).types[0].symmetries.discrete.size(), 2u);
  std::string text = kSquareRing;
  text.replace(text.find("    bop_id"), 0, "    symmetries: {discrete: [], continuous: [[0, 0, 2]]}\n");
  const Task given = Load(text);
  EXPECT_EQ(given.types[0].symmetries.discrete.size(), 1u);
  ASSERT_EQ(given.types[0].symmetries.axes.size(), 1u);
  EXPECT_NEAR(given.types[0].symmetries.axes[0].z(), 1, 1e-12);
  std::ofstream(folder_ / "models_info.json") << "{";
  EXPECT_THROW(Load(kSquareRing), ConfigurationError);
}

TEST_F(TaskFile, VariantsAddAcceptedSets) {
  std::string text = kSquareRing;
  text += R"(variants:
  - name: mirrored
    connections:
      - {name: m1, slots: [s1, s2], rotation: [0, 1, 0, -1, 0, 0, 0, 0, 1], translation: [45, -45, 0]}
      - {name: m2, slots: [s2, s3], rotation: [0, 1, 0, -1, 0, 0, 0, 0, 1], translation: [45, -45, 0]}
)";
  const Task task = Load(text);
  ASSERT_EQ(task.variants.size(), 2u);
  EXPECT_THAT(task.variants[1], testing::ElementsAre(4, 5));
  EXPECT_EQ(task.steps.size(), 3u);
}

TEST_F(TaskFile, FreedomOfAJoint) {
  std::string text = kSquareRing;
  const std::string end = "translation: [45, 45, 0]}";
  text.replace(text.find(end), end.size(),
               "translation: [45, 45, 0], freedom: [{axis: [0, 0, 2], point: [10, 0, 0], low: -90, high: 90}]}");
  const Task task = Load(text);
  ASSERT_EQ(task.connections[0].freedom.size(), 1u);
  EXPECT_NEAR(task.connections[0].freedom[0].high, 1.5707963, 1e-6);
  EXPECT_NEAR(task.connections[0].freedom[0].point.x(), 0.01, 1e-12);
}

TEST_F(TaskFile, MistakesAreNamedWithTheirPlace) {
  using testing::HasSubstr;
  EXPECT_THAT(ErrorWith("[s2, s3]", "[s2, s9]"),
              HasSubstr("task.yaml:17: connections[1].slots[1]: found 's9', expected "
                        "the name of a slot (s1, s2, s3, s4)"));
  EXPECT_THAT(ErrorWith("name: c2", "name: c1"), HasSubstr("connections[1].name: found 'c1', expected a name that is "
                                                           "not used twice"));
  EXPECT_THAT(ErrorWith("name: line", "name: c1"), HasSubstr("not used twice"));
  EXPECT_THAT(ErrorWith("name: s2", "name: s1"), HasSubstr("not used twice"));
  EXPECT_THAT(ErrorWith("count: 4", "count: 3"), HasSubstr("task.yaml:14: slots[3]"));
  EXPECT_THAT(ErrorWith("count: 4", "count: 0"), HasSubstr("a count from 1 to 100"));
  EXPECT_THAT(ErrorWith("[170, 100, 50]", "[180, 100, 50]"), HasSubstr("task.yaml:9: parts[0].hsv.low: found [180, "
                                                                       "100, 50], expected hue 0..179"));
  EXPECT_THAT(ErrorWith("[10, 255, 255]", "[10, 90, 255]"), HasSubstr("only hue wraps"));
  EXPECT_THAT(ErrorWith("bar.ply", "bor.ply"), HasSubstr("a mesh file beside the task file"));
  EXPECT_THAT(ErrorWith("units: mm", "units: inch"), HasSubstr("one of mm, m"));
  EXPECT_THAT(ErrorWith("colour:", "color:"), HasSubstr("parts[0].color: found an unknown key"));
  EXPECT_THAT(ErrorWith("[0, -1, 0, 1, 0, 0, 0, 0, 1]", "[0, -1, 0, 1, 0, 0, 0, 0, 2]"),
              HasSubstr("a rotation matrix"));
  EXPECT_THAT(ErrorWith("types: [bar, bar]", "types: [bar, rod]"), HasSubstr("the name of a part type (bar)"));
  EXPECT_THAT(ErrorWith("name: line", "name: unknown"), HasSubstr("another name"));
  EXPECT_THAT(ErrorWith("mistakes:", "steps: [c1, c1]\nmistakes:"), HasSubstr("each step once"));
  EXPECT_THAT(ErrorWith("mistakes:", "steps: [c7]\nmistakes:"), HasSubstr("the name of a connection"));
  EXPECT_THAT(ErrorWith("name: ring", "nome: ring"), HasSubstr("name: found nothing"));
}

TEST_F(TaskFile, RingsMustClose) {
  EXPECT_THAT(ErrorWith("[45, 45, 0], closes", "[45, 48, 0], closes"),
              testing::AllOf(testing::HasSubstr("a ring through c"), testing::HasSubstr("misses by 3 mm")));
  EXPECT_THAT(
      ErrorWith("[s4, s1], rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1]", "[s4, s1], rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1]"),
      testing::HasSubstr("90 degrees"));
}

TEST_F(TaskFile, RingMayCloseThroughASymmetryOfThePart) {
  std::string text = kSquareRing;
  text.replace(text.find("    bop_id"), 0, "    symmetries: {discrete: [[-1, 0, 0, 0, 1, 0, 0, 0, -1]]}\n");
  const std::string from = "[s4, s1], rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1]";
  text.replace(text.find(from), from.size(), "[s4, s1], rotation: [0, -1, 0, -1, 0, 0, 0, 0, -1]");
  EXPECT_NO_THROW(Load(text));
}

TEST(TaskFileOfRecordings, AllLoad) {
  const fs::path scenes = fs::path(COACH_SOURCE_DIR) / ".." / "shared" / "scenes";
  if (!fs::exists(scenes)) GTEST_SKIP() << "no recordings at " << scenes;
  int loaded = 0;
  for (const auto& scene : fs::directory_iterator(scenes)) {
    if (!fs::exists(scene.path() / "task.yaml")) continue;
    const Task task = LoadTask(scene.path() / "task.yaml");
    EXPECT_FALSE(task.parts.empty()) << scene.path();
    ++loaded;
  }
  EXPECT_GE(loaded, 3);
}

TEST(TaskFileOfProject, ShippedTasksLoad) {
  const fs::path tasks = fs::path(COACH_SOURCE_DIR) / "deploy" / "tasks";
  int to_build = 0;
  for (const auto& entry : fs::directory_iterator(tasks)) {
    if (entry.path().extension() != ".yaml") continue;
    const Task task = LoadTask(entry.path());
    for (const PartType& type : task.types) EXPECT_GT(SignedVolume(type.mesh), 1e-6) << type.name;
    to_build += !task.connections.empty();
  }
  EXPECT_GE(to_build, 4);
}

}  // namespace
}  // namespace coach
