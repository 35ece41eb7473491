#include "tools/operator/command_outbox.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace coach {
namespace {

constexpr int64_t kStart = 1'000'000'000;
constexpr int64_t kSecond = 1'000'000;

TEST(CommandOutbox, RepeatsUntilEveryServiceConcernedHasEchoed) {
  CommandOutbox outbox({}, "T1");
  const int64_t id = outbox.Post(OperatorKind::kStop, "", kStart);
  const auto due = outbox.Due(kStart);
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(due[0].station, "T1");
  EXPECT_TRUE(outbox.Due(kStart + 100'000).empty()) << "not faster than the repeat time";
  EXPECT_EQ(outbox.Due(kStart + 200'000).size(), 1u);
  outbox.Echo("assembly-reasoner", id);
  EXPECT_EQ(outbox.Due(kStart + 400'000).size(), 1u) << "the robot has not answered";
  outbox.Echo("robot-bridge", id - 1);
  EXPECT_EQ(outbox.Due(kStart + 600'000).size(), 1u) << "an older command is no answer";
  outbox.Echo("robot-bridge", id);
  EXPECT_TRUE(outbox.Due(kStart + 800'000).empty());
  EXPECT_EQ(outbox.Recent().back().fate, CommandOutbox::Fate::kDone);
}

TEST(CommandOutbox, ALaterEchoAnswersEarlierCommandsToo) {
  CommandOutbox outbox({}, "T1");
  outbox.Post(OperatorKind::kPause, "", kStart);
  const int64_t second = outbox.Post(OperatorKind::kResume, "", kStart + 1);
  outbox.Echo("assembly-reasoner", second);
  EXPECT_TRUE(outbox.Due(kStart + 1).empty());
}

TEST(CommandOutbox, GivesUpAndSaysWhoDidNotAnswer) {
  CommandOutbox outbox({}, "T1");
  outbox.Post(OperatorKind::kStart, "", kStart);
  outbox.Due(kStart + 7 * kSecond);
  const auto entry = outbox.Recent().back();
  EXPECT_EQ(entry.fate, CommandOutbox::Fate::kUnanswered);
  EXPECT_EQ(entry.waiting_for, std::vector<std::string>{"assembly-reasoner"});
  outbox.Post(OperatorKind::kStop, "", kStart);
  EXPECT_EQ(outbox.Due(kStart + 30 * kSecond).size(), 1u) << "a stop is tried longer";
}

TEST(CommandOutbox, FiftyClicksASecondAreAFewCommands) {
  CommandOutbox outbox({}, "T1");
  std::vector<int64_t> ids;
  for (int click = 0; click < 50; ++click) ids.push_back(outbox.Post(OperatorKind::kSkip, "", kStart + click * 20'000));
  std::sort(ids.begin(), ids.end());
  EXPECT_LE(std::unique(ids.begin(), ids.end()) - ids.begin(), 4);
  EXPECT_NE(outbox.Post(OperatorKind::kSay, "a", kStart), outbox.Post(OperatorKind::kSay, "b", kStart))
      << "different words are different commands";
}

TEST(CommandOutbox, RefusesWhenTooManyWaitButNeverAStop) {
  CommandOutbox::Options options;
  options.max_pending = 5;
  CommandOutbox outbox(options, "T1");
  for (int k = 0; k < 5; ++k) EXPECT_NE(outbox.Post(OperatorKind::kSay, std::to_string(k), kStart), 0);
  EXPECT_EQ(outbox.Post(OperatorKind::kSay, "one more", kStart), 0);
  EXPECT_NE(outbox.Post(OperatorKind::kStop, "", kStart), 0);
}

TEST(CommandOutbox, IdsGrowThoughTheClockIsSetBack) {
  CommandOutbox outbox({}, "T1");
  const int64_t first = outbox.Post(OperatorKind::kPause, "", kStart);
  EXPECT_GT(outbox.Post(OperatorKind::kResume, "", kStart - 3600 * kSecond), first);
}

TEST(CommandOutbox, RemembersOnlyTheLastOnes) {
  CommandOutbox outbox({}, "T1");
  for (int k = 0; k < 100; ++k) {
    outbox.Echo("assembly-reasoner", outbox.Post(OperatorKind::kSay, std::to_string(k), kStart + k));
  }
  outbox.Due(kStart + 100);
  EXPECT_EQ(outbox.Recent().size(), 16u);
  EXPECT_EQ(outbox.Recent().back().command.argument, "99");
}

}  // namespace
}  // namespace coach
