#include "tools/simulator/scenario.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "common/assembly/task_file.h"
#include "tools/simulator/structure.h"

namespace coach {
namespace {

Task Rectangle() { return LoadTask(COACH_SOURCE_DIR "/deploy/tasks/rectangle_long_medium.yaml"); }

Scenario Make(const std::string& name, uint64_t seed, const Task& task = Rectangle()) {
  ScenarioOptions options;
  options.name = name;
  options.seed = seed;
  return MakeScenario(task, options);
}

TEST(MotionTest, MinimumJerkStartsAndEndsAtRest) {
  EXPECT_EQ(MinimumJerk(-1), 0);
  EXPECT_EQ(MinimumJerk(2), 1);
  EXPECT_NEAR(MinimumJerk(0.5), 0.5, 1e-12);
  EXPECT_NEAR((MinimumJerk(0.5 + 1e-5) - MinimumJerk(0.5 - 1e-5)) / 2e-5, 1.875, 1e-6);
}

TEST(LessonTest, EventsAreTrue) {
  for (uint64_t seed = 1; seed < 7; ++seed) {
    const Scenario s = Make("assemble", seed);
    const Task& task = s.stage.task;
    int made = 0;
    for (const TrueEvent& e : s.performance.events) {
      if (e.kind == "connect" || e.kind == "wrong_connect") {
        Pose X_AB = Pose::Identity();
        for (const Connection& c : task.connections) {
          if (c.name == e.connection) X_AB = c.X_AB;
        }
        for (const Mistake& m : task.mistakes) {
          if (m.name == e.connection) X_AB = m.X_AB;
        }
        const ThingTracks& things = s.performance.things;
        const Pose found = things.At(e.parts[0], e.time).inverse() * things.At(e.parts[1], e.time);
        const Pose turned = things.At(e.parts[1], e.time).inverse() * things.At(e.parts[0], e.time);
        // A mistake between types may be named from either part.
        const double off = std::min((found.translation() - X_AB.translation()).norm(),
                                    (turned.translation() - X_AB.translation()).norm());
        EXPECT_LT(off, 1e-6) << e.connection;
        made += e.kind == "connect";
      }
    }
    EXPECT_EQ(made, 4);
  }
}

/// Where the first part passes through another thing or the table: "parts 1 and 2 at 27.9 s"; empty if none does.
std::string Collision(const Scenario& s) {
  const Solids solids(s.meshes);
  const int parts = static_cast<int>(s.stage.task.parts.size());
  for (const double time : s.frame_times) {
    std::vector<Pose> X;
    for (int i = 0; i < s.performance.things.size(); ++i) X.push_back(s.performance.things.At(i, time));
    for (int a = 0; a < parts; ++a) {
      const Pose& X_a = X[static_cast<size_t>(a)];
      const std::string at = " at " + std::to_string(time) + " s";
      if (X_a.translation().z() + solids.Lowest(a, X_a.linear()) < -0.0005)
        return std::to_string(a) + " and table" + at;
      for (int b = a + 1; b < s.performance.things.size(); ++b) {
        if (solids.Overlap(a, X_a, b, X[static_cast<size_t>(b)]))
          return std::to_string(a) + " and " + std::to_string(b) + at;
      }
    }
  }
  return "";
}

class SolidTest : public testing::TestWithParam<const char*> {};

TEST_P(SolidTest, NothingPassesThroughAnything) {
  const Task task = LoadTask(std::string(COACH_SOURCE_DIR "/deploy/tasks/") + GetParam() + ".yaml");
  const char* const styles[] = {"normal", "slow", "hasty", "hesitant"};
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    ScenarioOptions options;
    options.seed = seed;
    options.style = styles[seed % 4];
    EXPECT_EQ(Collision(MakeScenario(task, options)), "") << options.style << " lesson of seed " << seed;
  }
  for (const ScenarioName& name : ScenarioNames()) {
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      EXPECT_EQ(Collision(Make(name.name, seed, task)), "") << name.name << ", seed " << seed;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Tasks, SolidTest,
                         testing::Values("rectangle_long_medium", "rectangle_long_short", "square", "car"));

TEST(ScenarioTest, SameSeedSamePictures) {
  const Scenario a = Make("start", 5), b = Make("start", 5), c = Make("start", 6);
  FrameTruth truth;
  const auto render = [&](const Scenario& s) {
    return Simulator(s.stage, 1).Render(s.performance, s.camera, 0.5, &truth);
  };
  const Frame x = render(a), y = render(b), z = render(c);
  EXPECT_EQ(cv::norm(x.colour, y.colour, cv::NORM_L1), 0);
  EXPECT_EQ(cv::norm(x.depth, y.depth, cv::NORM_L1), 0);
  EXPECT_GT(cv::norm(x.colour, z.colour, cv::NORM_L1), 0);
}

TEST(ScenarioTest, HiddenStillHidesForTwoSeconds) {
  const Scenario s = Make("hidden_still", 2);
  Simulator simulator(s.stage, 1);
  double hidden = 0, longest = 0;
  for (double t = 0; t < s.frame_times.back(); t += 0.25) {
    FrameTruth truth;
    simulator.Render(s.performance, s.camera, t, &truth);
    hidden = truth.parts[0].visible_fraction() < 0.05 ? hidden + 0.25 : 0;
    longest = std::max(longest, hidden);
  }
  EXPECT_GE(longest, 1.75);
}

TEST(ScenarioTest, FastReachesItsSpeed) {
  const Scenario s = Make("fast", 4);
  double fastest = 0;
  for (double t = 0; t < s.frame_times.back(); t += 0.01) {
    fastest = std::max(
        fastest,
        (s.performance.things.At(0, t + 0.01).translation() - s.performance.things.At(0, t).translation()).norm() /
            0.01);
  }
  EXPECT_NEAR(fastest, 1.2, 0.1);
}

TEST(ScenarioTest, EveryScenarioCanBeMade) {
  for (const ScenarioName& name : ScenarioNames()) {
    const Scenario s = Make(name.name, 3);
    EXPECT_GT(s.frame_times.size(), 9u) << name.name;
    EXPECT_EQ(s.frame_times.size(), s.image_ids.size());
    EXPECT_TRUE(std::is_sorted(s.image_ids.begin(), s.image_ids.end()));
  }
}

TEST(ScenarioTest, OtherTasks) {
  for (const char* file : {"rectangle_long_short", "square", "car"}) {
    const Task task = LoadTask(std::string(COACH_SOURCE_DIR "/deploy/tasks/") + file + ".yaml");
    const Scenario s = Make("assemble", 1, task);
    int made = 0;
    for (const TrueEvent& e : s.performance.events) made += e.kind == "connect";
    EXPECT_EQ(made, static_cast<int>(OwnConnections(task).size())) << file;
  }
}

TEST(ScenarioTest, UnknownNamesAreRefused) {
  EXPECT_THROW(Make("nothing", 1), std::invalid_argument);
  ScenarioOptions options;
  options.style = "wild";
  EXPECT_THROW(MakeScenario(Rectangle(), options), std::invalid_argument);
}

}  // namespace
}  // namespace coach
