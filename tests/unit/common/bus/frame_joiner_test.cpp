#include "common/bus/frame_joiner.h"

#include <gmock/gmock.h>

#include <random>

namespace coach {
namespace {

using testing::ElementsAre;

struct Depth {
  int64_t utime = 0;
};
struct Regions {
  int64_t utime = 0;
};
struct Colour {
  int64_t utime = 0;
};
using Joiner = FrameJoiner<Depth, Regions>;

/// utime of the next frame; negative if it goes without regions; 0: none is due.
int64_t Next(Joiner& joiner) {
  const auto joined = joiner.Next();
  if (!joined) return 0;
  EXPECT_EQ(joined->complete, std::get<0>(joined->companions) != nullptr);
  if (joined->complete) {
    EXPECT_EQ(std::get<0>(joined->companions)->utime, joined->primary.utime);
  }
  return joined->complete ? joined->primary.utime : -joined->primary.utime;
}

TEST(FrameJoiner, AFrameIsDueWhenItIsComplete) {
  Joiner joiner;
  joiner.Add(Depth{10});
  EXPECT_EQ(Next(joiner), 0);
  joiner.Add(Regions{10});
  EXPECT_EQ(Next(joiner), 10);
  EXPECT_EQ(Next(joiner), 0);
  joiner.Add(Regions{20});
  EXPECT_EQ(Next(joiner), 0);
  joiner.Add(Depth{20});
  EXPECT_EQ(Next(joiner), 20);
  EXPECT_EQ(joiner.dropped(), 0);
  EXPECT_EQ(joiner.incomplete(), 0);
}

TEST(FrameJoiner, WhatIsMissingIsNotWaitedForOnceTheNextFrameHasCome) {
  Joiner joiner;
  joiner.Add(Depth{10});
  joiner.Add(Depth{20});
  EXPECT_EQ(Next(joiner), -10);
  EXPECT_EQ(Next(joiner), 0);
  joiner.Add(Regions{10});  // too late
  EXPECT_EQ(Next(joiner), 0);
  joiner.Add(Regions{20});
  EXPECT_EQ(Next(joiner), 20);
  EXPECT_EQ(joiner.incomplete(), 1);
  EXPECT_EQ(joiner.dropped(), 0);
}

TEST(FrameJoiner, ASlowReaderGetsTheNewestCompleteFrame) {
  Joiner joiner;
  for (const int64_t t : {10, 20, 30, 40}) joiner.Add(Depth{t});
  for (const int64_t t : {10, 20, 30}) joiner.Add(Regions{t});
  EXPECT_EQ(Next(joiner), 30);
  EXPECT_EQ(joiner.dropped(), 2);
  joiner.Add(Regions{40});
  EXPECT_EQ(Next(joiner), 40);
}

TEST(FrameJoiner, WithoutAnyRegionsTheNewestDueFrameGoes) {
  Joiner joiner;
  for (const int64_t t : {10, 20, 30, 40}) joiner.Add(Depth{t});
  EXPECT_EQ(Next(joiner), -30);
  EXPECT_EQ(joiner.dropped(), 2);
}

TEST(FrameJoiner, EveryCompanionCounts) {
  FrameJoiner<Depth, Regions, Colour> joiner;
  joiner.Add(Depth{10});
  joiner.Add(Regions{10});
  EXPECT_FALSE(joiner.Next());
  joiner.Add(Depth{20});
  const auto joined = joiner.Next();
  ASSERT_TRUE(joined);
  EXPECT_FALSE(joined->complete);
  EXPECT_TRUE(std::get<std::unique_ptr<Regions>>(joined->companions));
  EXPECT_FALSE(std::get<std::unique_ptr<Colour>>(joined->companions));
}

TEST(FrameJoiner, TimeOnlyGrows) {
  Joiner joiner;
  for (const int64_t t : {100, 100, 90}) joiner.Add(Depth{t});
  joiner.Add(Regions{100});
  EXPECT_EQ(Next(joiner), 100);
  joiner.Add(Depth{90});
  joiner.Add(Regions{90});
  EXPECT_EQ(Next(joiner), 0);
  EXPECT_EQ(joiner.dropped(), 3);
}

TEST(FrameJoiner, ASourceThatWasStartedAgainIsFollowed) {
  Joiner joiner;
  joiner.Add(Depth{50'000'000});
  joiner.Add(Regions{50'000'000});
  EXPECT_EQ(Next(joiner), 50'000'000);
  for (const int64_t t : {1, 2, 3}) {
    joiner.Add(Depth{t});
    joiner.Add(Regions{t});
  }
  const auto joined = joiner.Next();
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->primary.utime, 3);
  EXPECT_TRUE(joined->restarted);
  joiner.Add(Depth{4});
  joiner.Add(Regions{4});
  EXPECT_FALSE(joiner.Next()->restarted);
}

TEST(FrameJoiner, OfTwoSourcesOnOneChannelOneIsFollowedAndTheOtherDropped) {
  Joiner joiner;
  std::vector<int64_t> frames;
  for (int64_t t = 1; t <= 30; ++t) {
    for (const int64_t utime : {90'000'000 + t, t}) {
      joiner.Add(Depth{utime});
      joiner.Add(Regions{utime});
      if (const int64_t frame = Next(joiner)) frames.push_back(frame);
    }
  }
  EXPECT_EQ(frames.size(), 30U);
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end()));
  EXPECT_EQ(joiner.dropped(), 30);
}

TEST(FrameJoiner, EveryPrimaryIsAFrameOrDroppedWhateverTheOrder) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    Joiner joiner;
    int64_t added = 0, frames = 0, last = 0;
    for (int i = 0; i < 200; ++i) {
      const int64_t t = 1 + i / 2 + static_cast<int64_t>(random() % 3);
      if (random() % 2) {
        joiner.Add(Depth{t});
        ++added;
      } else {
        joiner.Add(Regions{t});
      }
      if (random() % 3) continue;
      if (const int64_t frame = std::abs(Next(joiner))) {
        ++frames;
        EXPECT_GT(frame, last);
        last = frame;
      }
    }
    EXPECT_LE(added - frames - joiner.dropped(), 8);
    EXPECT_GE(added - frames - joiner.dropped(), 0);
  }
}

}  // namespace
}  // namespace coach
