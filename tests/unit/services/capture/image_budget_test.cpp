#include "services/capture/image_budget.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coach {
namespace {

/// An image whose JPEG has `full` bytes at quality 100 and shrinks as JPEGs do.
int64_t JpegSize(double full, int quality) { return static_cast<int64_t>(full * std::pow(quality / 100.0, 1.5)); }

/// Sends one frame. @returns its size.
int64_t Send(ImageBudget& budget, double full, int64_t depth) {
  for (int tries = 1;; ++tries) {
    EXPECT_LE(tries, 12);
    const int64_t colour = JpegSize(full, budget.quality());
    if (budget.Accept(colour, depth)) return colour + depth;
  }
}

TEST(ImageBudget, SmallFramesKeepTheWantedQuality) {
  ImageBudget budget(95);
  for (int i = 0; i < 10; ++i) Send(budget, 60'000, 90'000);
  EXPECT_EQ(budget.quality(), 95);
  EXPECT_EQ(budget.lowered_frames(), 0);
}

TEST(ImageBudget, EveryFrameFitsAndQualityComesBack) {
  ImageBudget budget(95);
  for (int i = 0; i < 50; ++i) EXPECT_LE(Send(budget, 400'000, 110'000), kFrameBudget);
  EXPECT_LT(budget.quality(), 60);
  EXPECT_EQ(budget.lowered_frames(), 50);
  for (int i = 0; i < 100; ++i) Send(budget, 50'000, 80'000);
  EXPECT_EQ(budget.quality(), 95);
  EXPECT_EQ(budget.oversize_frames(), 0);
}

TEST(ImageBudget, WhatCanNotFitIsSentAtTheLowestQualityAndCounted) {
  ImageBudget budget(90);
  Send(budget, 100'000, kFrameBudget + 1);
  EXPECT_EQ(budget.quality(), ImageBudget::kLowest);
  EXPECT_EQ(budget.oversize_frames(), 1);
}

}  // namespace
}  // namespace coach
