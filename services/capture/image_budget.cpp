#include "services/capture/image_budget.h"

#include <algorithm>

namespace coach {

bool ImageBudget::Accept(int64_t colour_bytes, int64_t depth_bytes) {
  const int64_t total = colour_bytes + depth_bytes;
  if (total > kFrameBudget && quality_ > kLowest) {
    // Size falls a little slower than quality does, so a second try is rare.
    const double share =
        static_cast<double>(std::max<int64_t>(kFrameBudget - depth_bytes, 0)) / static_cast<double>(colour_bytes);
    quality_ = std::max(kLowest, std::min(quality_ - 3, static_cast<int>(quality_ * share)));
    return false;
  }
  oversize_frames_ += total > kFrameBudget;
  lowered_frames_ += quality_ < wanted_;
  if (total < kFrameBudget * 9 / 10) quality_ = std::min(wanted_, quality_ + 1);
  return true;
}

}  // namespace coach
