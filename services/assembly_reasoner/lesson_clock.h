// The lesson's time.
#pragma once

#include <cstdint>

namespace coach {

/// Runs with the utime of the poses, but neither a camera that was started again nor a clock that was set moves it:
/// after a step back by more than a second, or on by more than ten minutes, it goes on where it was.
class LessonClock {
 public:
  /// @param utime us, of the poses at hand @returns us; not after the last one where `utime` is not (by up to a second)
  int64_t ToLesson(int64_t utime) {
    const int64_t step = utime - last_;
    if (started_ && (step < -kBack || step > kOn)) shift_ += kFrame - step;
    started_ = true;
    last_ = utime;
    return utime + shift_;
  }

 private:
  static constexpr int64_t kBack = 1'000'000, kOn = 600'000'000, kFrame = 33'333;  // us
  bool started_ = false;
  int64_t last_ = 0, shift_ = 0;
};

}  // namespace coach
