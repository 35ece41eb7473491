#include "tools/study/study.h"

#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "tools/study/ablation.h"

namespace coach {
namespace {

using testing::HasSubstr;

class StudyTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove_all(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Result(const std::string& name) {
    ++computed_;
    const int number = std::stoi(name.substr(name.size() - 4));
    return "{\"number\":" + std::to_string(number) +
           ",\"task\":\"square\",\"found\":" + (number % 3 ? "true" : "false") +
           ",\"after\":0.1,\"parts\":4,\"wrong\":[{\"part\":\"long\",\"mm\":1.5,\"degrees\":null,\"visible\":0.6}]}";
  }
  void Run(const std::filesystem::path& folder, const Shard& shard, int jobs = 1) {
    std::ostringstream log;
    EXPECT_EQ(RunUnits(
                  {folder, shard, jobs}, units_, [&](const std::string& n) { return Result(n); }, log),
              0)
        << log.str();
  }
  std::string Report(const std::filesystem::path& folder) {
    std::vector<std::string> missing;
    const auto results = ReadUnits(folder, units_, &missing);
    EXPECT_TRUE(missing.empty());
    return FindExperiment("start").Report(results, folder);
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / "coach_study_test";
  std::vector<std::string> units_ = FindExperiment("start").Units(10);
  std::atomic<int> computed_{0};
};

TEST_F(StudyTest, MergedShardsEqualTheWhole) {
  Run(folder_ / "whole", {});
  for (int i = 0; i < 3; ++i) Run(folder_ / "parts", {i, 3}, 2);
  EXPECT_EQ(computed_, 20);
  EXPECT_EQ(Report(folder_ / "whole"), Report(folder_ / "parts"));
  EXPECT_THAT(Report(folder_ / "whole"), HasSubstr("(3/10"));
  EXPECT_THAT(Report(folder_ / "whole"), HasSubstr("| 9 | square | long | 1.5 | null | 0.6 |"));
}

TEST_F(StudyTest, WhatIsThereIsNotComputedAgain) {
  Run(folder_, {0, 2});
  EXPECT_EQ(computed_, 5);
  Run(folder_, {});
  EXPECT_EQ(computed_, 10);
}

TEST_F(StudyTest, AFailedUnitIsReportedAndMissing) {
  std::ostringstream log;
  const auto unit = [](const std::string& name) -> std::string {
    if (name == "start-0002") throw std::runtime_error("no such luck");
    return "{}";
  };
  EXPECT_EQ(RunUnits({folder_, {}, 1}, units_, unit, log), 1);
  EXPECT_THAT(log.str(), HasSubstr("start-0002: FAILED: no such luck"));
  std::vector<std::string> missing;
  EXPECT_EQ(ReadUnits(folder_, units_, &missing).size(), 9u);
  EXPECT_THAT(missing, testing::ElementsAre("start-0002"));
}

TEST_F(StudyTest, TheAblationAddsRunsUpAndKeepsHeldBackScenesApart) {
  const Experiment& ablation = FindExperiment("ablation");
  const size_t scenes = AblationScenes().size();
  EXPECT_GE(scenes, 12u);
  const auto units = ablation.Units(3);
  EXPECT_EQ(units.size(), 3 * scenes);
  EXPECT_EQ(std::set<std::string>(units.begin(), units.end()).size(), units.size());
  EXPECT_EQ(std::count_if(AblationScenes().begin(), AblationScenes().end(), [](const auto& s) { return s.held_back; }),
            static_cast<long>(scenes / 2));
  const auto unit = [](const std::string& scene, bool held_back, double position, int good) {
    return R"({"scene":")" + scene + R"(","held_back":)" + (held_back ? "true" : "false") +
           R"(,"seed":1,"frames":100,"parts":2,"truth":"abc","rows":{"full":{"position":)" + std::to_string(position) +
           R"(,"rotation":1,"judged":200,"good":)" + std::to_string(good) +
           R"(,"losses":1,"lost_seconds":0.5,"reappearances":2,"recovered":1,"swap_seconds":0.6,"tracked":100,)"
           R"("wrong":2,"ms":2}}})";
  };
  std::filesystem::create_directories(folder_);
  const std::string md = ablation.Report(
      {unit("hidden_still", false, 1, 200), unit("hidden_still", false, 2, 100), unit("fast", true, 9, 0)}, folder_);
  EXPECT_THAT(md, HasSubstr("| full | 1.50 | 1.00 | 75.0 | 2 (1.0) | 2/4 | 2 | 2.00 | 2.00 |"));
  EXPECT_THAT(md, HasSubstr("Scenes held back"));
  EXPECT_THAT(md, HasSubstr("| full | 9.00 | 1.00 | 0.0 | 1 (0.5) | 1/2 | 1 | 2.00 | 2.00 |"));
  EXPECT_THAT(md, HasSubstr("| fast (held back) | car, hasty, 105 | 100 | 2 | `abc` |"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "ablation.csv"));
}

TEST(ShardTest, TextIsChecked) {
  EXPECT_EQ(ParseShard("8/8").index, 7);
  for (const char* bad : {"", "0/4", "5/4", "1", "1/4x", "a/b"})
    EXPECT_THROW(ParseShard(bad), std::invalid_argument) << bad;
}

TEST(IntervalTest, WilsonOfKnownCases) {
  // 0 of 300: the upper end is z^2 / (n + z^2).
  EXPECT_NEAR(WilsonInterval(0, 300).high, 100 * 3.8415 / 303.8415, 1e-3);
  EXPECT_NEAR(WilsonInterval(5, 10).low, 23.66, 0.01);
  EXPECT_NEAR(WilsonInterval(5, 10).high, 76.34, 0.01);
}

TEST(IntervalTest, MedianIsInItsInterval) {
  const Interval i = MedianInterval({1, 2, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_LE(i.low, 5);
  EXPECT_GE(i.high, 5);
  EXPECT_LT(i.high - i.low, 8);
}

}  // namespace
}  // namespace coach
