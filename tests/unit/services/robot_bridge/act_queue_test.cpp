#include "services/robot_bridge/act_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

namespace coach {
namespace {

using testing::HasSubstr;

constexpr int64_t kSecond = 1000000;

RobotCommand Act(int64_t id, Priority priority = Priority::kExplanatory, int64_t valid_for = 4 * kSecond) {
  RobotCommand command;
  command.id = id;
  command.session = 1;
  command.priority = priority;
  command.text = "text " + std::to_string(id);
  command.valid_for_us = valid_for;
  return command;
}

std::vector<std::pair<int64_t, ActState>> States(ActQueue& queue) {
  std::vector<std::pair<int64_t, ActState>> states;
  for (const ActChange& change : queue.TakeChanges()) {
    if (!change.repeated) states.emplace_back(change.id, change.state);
  }
  return states;
}

TEST(ActQueueTest, MostImportantFirstThenOldest) {
  ActQueue queue;
  queue.Offer(Act(1, Priority::kReminder), 0);
  queue.Offer(Act(2, Priority::kCorrective), 1);
  queue.Offer(Act(3, Priority::kCorrective), 2);
  std::vector<int64_t> order;
  while (const auto command = queue.StartNext(10)) {
    order.push_back(command->id);
    queue.Finish(ActState::kDone, "");
  }
  EXPECT_EQ(order, (std::vector<int64_t>{2, 3, 1}));
}

TEST(ActQueueTest, OnlyOneRunsAtATime) {
  ActQueue queue;
  queue.Offer(Act(1), 0);
  queue.Offer(Act(2), 0);
  EXPECT_TRUE(queue.StartNext(0));
  EXPECT_FALSE(queue.StartNext(0));
}

TEST(ActQueueTest, RepeatIsAnsweredButNotCarriedOutAgain) {
  ActQueue queue;
  queue.Offer(Act(1), 0);
  queue.StartNext(0);
  queue.Finish(ActState::kDone, "said");
  queue.TakeChanges();
  for (int i = 0; i < 5; ++i) queue.Offer(Act(1), i);
  const auto answers = queue.TakeChanges();
  ASSERT_EQ(answers.size(), 5u);
  for (const ActChange& answer : answers) {
    EXPECT_TRUE(answer.repeated);
    EXPECT_EQ(answer.state, ActState::kDone);
  }
  EXPECT_FALSE(queue.StartNext(10));
}

TEST(ActQueueTest, ExpiresByItsOwnClockWhateverTheSendersSays) {
  ActQueue queue;
  RobotCommand command = Act(1, Priority::kExplanatory, 2 * kSecond);
  command.sent_utime = 60 * kSecond;  // the other host's clock is a minute off
  queue.Offer(command, 100 * kSecond);
  queue.Expire(101 * kSecond);
  EXPECT_EQ(queue.waiting(), 1u);
  queue.Expire(102 * kSecond);
  EXPECT_EQ(queue.waiting(), 0u);
  EXPECT_EQ(States(queue).back(), (std::pair<int64_t, ActState>{1, ActState::kExpired}));
}

TEST(ActQueueTest, CountdownOfARepeatShortensTheDeadlineOfAPacketThatWasHeldUp) {
  ActQueue queue;
  queue.Offer(Act(1, Priority::kExplanatory, 4 * kSecond), 3 * kSecond);
  queue.Offer(Act(1, Priority::kExplanatory, 1 * kSecond), 3 * kSecond + 1000);
  queue.Expire(4 * kSecond + 2000);
  EXPECT_EQ(queue.waiting(), 0u);
}

TEST(ActQueueTest, ReplacingWithdrawsWhatWaitsRunsOrIsStillOnItsWay) {
  ActQueue queue;
  queue.Offer(Act(1), 0);
  RobotCommand second = Act(2);
  second.replaces_id = 1;
  queue.Offer(second, 0);
  EXPECT_EQ(queue.StartNext(0)->id, 2);

  RobotCommand third = Act(3);
  third.replaces_id = 2;
  queue.Offer(third, 0);
  EXPECT_THAT(queue.interrupt(), HasSubstr("withdrawn by command 3"));
  queue.Finish(ActState::kInterrupted, queue.interrupt());

  RobotCommand cancel = Act(5);
  cancel.kind = ActKind::kCancel;
  cancel.replaces_id = 4;
  queue.Offer(cancel, 0);
  queue.Offer(Act(4), 1);
  EXPECT_EQ(queue.StartNext(1)->id, 3);
  queue.Finish(ActState::kDone, "");
  EXPECT_FALSE(queue.StartNext(1));
}

TEST(ActQueueTest, StopEndsAllAndPauseOnlyWhatWaits) {
  ActQueue queue;
  queue.Offer(Act(1), 0);
  queue.StartNext(0);
  queue.Offer(Act(2), 0);
  RobotCommand pause = Act(3);
  pause.kind = ActKind::kPause;
  queue.Offer(pause, 0);
  EXPECT_EQ(queue.waiting(), 0u);
  EXPECT_EQ(queue.interrupt(), "");
  queue.Offer(Act(4), 0);
  RobotCommand stop = Act(5, Priority::kStop);
  stop.kind = ActKind::kStop;
  queue.Offer(stop, 0);
  EXPECT_EQ(queue.waiting(), 0u);
  EXPECT_EQ(queue.interrupt(), "stopped");
}

TEST(ActQueueTest, OnlyTheOperatorOverrulesARunningAct) {
  ActQueue queue;
  queue.Offer(Act(1, Priority::kReminder), 0);
  queue.StartNext(0);
  queue.Offer(Act(2, Priority::kCorrective), 0);
  EXPECT_EQ(queue.interrupt(), "");
  queue.Offer(Act(3, Priority::kOperator), 0);
  EXPECT_THAT(queue.interrupt(), HasSubstr("overruled"));
}

TEST(ActQueueTest, BadCommandsFailWithTheirReason) {
  ActQueue queue;
  RobotCommand command = Act(1);
  command.text = std::string(10000, 'a');
  queue.Offer(command, 0);
  command = Act(2);
  command.point_target = Vector3(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  queue.Offer(command, 0);
  command = Act(3);
  command.valid_for_us = -5;
  queue.Offer(command, 0);
  const auto changes = queue.TakeChanges();
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[0].state, ActState::kFailed);
  EXPECT_THAT(changes[0].reason, HasSubstr("10000 bytes"));
  EXPECT_EQ(changes[1].state, ActState::kFailed);
  EXPECT_THAT(changes[1].reason, HasSubstr("not finite"));
  EXPECT_EQ(changes[2].state, ActState::kExpired);
}

TEST(ActQueueTest, BurstOfAThousandStaysBoundedAndEveryOneEndsOnce) {
  ActQueue queue;
  std::map<int64_t, int> finals;
  const auto count = [&] {
    for (const ActChange& change : queue.TakeChanges()) {
      if (IsFinal(change.state) && !change.repeated) ++finals[change.id];
    }
  };
  for (int64_t id = 1; id <= 1000; ++id) {
    queue.Offer(Act(id), id);
    EXPECT_LE(queue.waiting(), 16u);
    count();
  }
  for (int64_t now = 2000; queue.StartNext(now); now += 300000) {
    queue.Finish(ActState::kDone, "");
    count();
  }
  count();
  EXPECT_EQ(finals.size(), 1000u);
  for (const auto& [id, times] : finals) EXPECT_EQ(times, 1) << id;
}

// Random offers, repeats, stops and finishes: every command has exactly one final state, and nothing starts twice.
TEST(ActQueueTest, PropertyEveryCommandEndsExactlyOnce) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    ActQueue queue;
    std::map<int64_t, int> starts, finals;
    std::set<int64_t> offered;
    int64_t now = 0;
    const auto collect = [&] {
      for (const ActChange& change : queue.TakeChanges()) {
        if (change.repeated) continue;
        if (change.state == ActState::kStarted) ++starts[change.id];
        if (IsFinal(change.state)) ++finals[change.id];
      }
    };
    for (int step = 0; step < 500; ++step) {
      now += static_cast<int64_t>(random() % 300000);
      RobotCommand command = Act(static_cast<int64_t>(random() % 120) + 1, static_cast<Priority>(random() % 5),
                                 static_cast<int64_t>(random() % 3000000) - 100000);
      if (random() % 10 == 0) command.replaces_id = static_cast<int64_t>(random() % 120) + 1;
      if (random() % 40 == 0) command.kind = ActKind::kStop;
      offered.insert(command.id);
      queue.Offer(command, now);
      if (!queue.interrupt().empty()) queue.Finish(ActState::kInterrupted, std::string(queue.interrupt()));
      if (random() % 3 == 0) queue.Finish(ActState::kDone, "");
      if (random() % 2 == 0) queue.StartNext(now);
      collect();
    }
    queue.Finish(ActState::kDone, "");
    queue.WithdrawAll("end");
    collect();
    for (const int64_t id : offered) EXPECT_EQ(finals[id], 1) << "seed " << seed << " id " << id;
    for (const auto& [id, times] : starts) EXPECT_EQ(times, 1) << "seed " << seed << " id " << id;
  }
}

}  // namespace
}  // namespace coach
