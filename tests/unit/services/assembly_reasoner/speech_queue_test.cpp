#include "services/assembly_reasoner/speech_queue.h"

#include <gtest/gtest.h>

#include <random>

namespace coach {
namespace {

Utterance Make(const std::string& key, Priority priority, bool solicited, int64_t born) {
  Utterance u;
  u.key = key;
  u.priority = priority;
  u.solicited = solicited;
  u.born = born;
  return u;
}

const SpeechQueue::IsTrue kAlways = [](const Utterance&) { return true; };

TEST(SpeechQueue, TheMostImportantFirst) {
  SpeechQueue queue;
  queue.Offer(Make("hint", Priority::kReminder, true, 1));
  queue.Offer(Make("praise", Priority::kCongratulatory, true, 2));
  queue.Offer(Make("wrong", Priority::kCorrective, true, 3));
  EXPECT_EQ(queue.Next(10, kAlways)->key, "wrong");
}

TEST(SpeechQueue, WhatIsFalseOrStaleIsDroppedWithItsReason) {
  SpeechQueue queue;
  queue.Offer(Make("old", Priority::kCorrective, true, 0));
  queue.Offer(Make("false", Priority::kCorrective, true, 4000000));
  EXPECT_FALSE(queue.Next(4500000, [](const Utterance& u) { return u.key != "false"; }));
  const auto dropped = queue.TakeDropped();
  ASSERT_EQ(dropped.size(), 2u);
  EXPECT_EQ(dropped[0].reason, "waited too long");
  EXPECT_EQ(dropped[1].reason, "no longer true");
}

TEST(SpeechQueue, OnlyFalsehoodAndTheOperatorInterrupt) {
  SpeechQueue queue;
  queue.Began(7, Make("step", Priority::kExplanatory, false, 0), "a sentence of some length", 0);
  queue.Offer(Make("wrong", Priority::kCorrective, true, 100000));
  EXPECT_FALSE(queue.Next(100000, kAlways));
  EXPECT_EQ(queue.Interrupt(kAlways), 0);
  EXPECT_EQ(queue.Interrupt([](const Utterance&) { return false; }), 7);
  EXPECT_EQ(queue.Interrupt([](const Utterance&) { return false; }), 0);  // once
  queue.Offer(Make("operator", Priority::kOperator, true, 100000));
  EXPECT_EQ(queue.Next(100000, kAlways)->key, "operator");
}

TEST(SpeechQueue, CountsCharactersNotBytes) { EXPECT_EQ(CountCharacters("Γεια!"), 5); }

/// Random offers, lengths and robots over many sessions: the rules hold at every utterance.
TEST(SpeechQueue, RulesHoldInThousandsOfSessions) {
  const SpeechOptions options;
  int spoken = 0;
  for (uint64_t session = 0; session < 5000; ++session) {
    std::mt19937_64 random(session);
    const auto chance = [&](double p) { return std::uniform_real_distribution<double>(0, 1)(random) < p; };
    SpeechQueue queue(options);
    bool truth = true, was_spoken = false;
    int64_t id = 0, robot_until = 0, last_unsolicited = 0;
    bool reports = chance(0.8);
    for (int64_t now = 100000; now < 60000000; now += 100000) {
      if (chance(0.02)) truth = !truth;
      if (chance(0.15)) {
        const auto priority = static_cast<Priority>(random() % 4);
        queue.Offer(Make(std::string(1, static_cast<char>('a' + random() % 5)), priority, chance(0.4), now));
      }
      if (id != 0 && reports && robot_until != 0 && now >= robot_until) {
        queue.Ended(id, now);
        robot_until = 0;
      }
      const auto is_true = [&](const Utterance& u) { return truth || u.key != "b"; };
      const auto next = queue.Next(now, is_true);
      if (!next) continue;
      ++spoken;
      ASSERT_LE(now - next->born, 4000000) << "expired, but spoken";
      ASSERT_TRUE(is_true(*next)) << "false, but spoken";
      ASSERT_FALSE(reports && robot_until > now) << "two sentences at once";
      if (!next->solicited) {
        ASSERT_TRUE(!was_spoken || last_unsolicited == 0 || now - last_unsolicited >= 6000000) << "nagging";
        last_unsolicited = now;
      }
      was_spoken = true;
      const std::string text(20 + random() % 80, 'x');
      queue.Began(++id, *next, text, now);
      robot_until = now + static_cast<int64_t>((0.5 + static_cast<double>(text.size()) / 14) * 1e6);
    }
  }
  EXPECT_GT(spoken, 20000);
}

}  // namespace
}  // namespace coach
