// Keeps the two images of a frame together under what the network delivers.
#pragma once

#include <cstdint>

namespace coach {

/// Largest size of both images of a frame, bytes: larger messages are lost whole on a kernel with stock buffers.
constexpr int64_t kFrameBudget = 180'000;

/// Chooses the JPEG quality: falls at once when a frame is too large, and climbs back by one step a frame while there
/// is room.
class ImageBudget {
 public:
  static constexpr int kLowest = 10;  ///< quality below which nothing is gained any more

  /// @param wanted quality, 1..100
  explicit ImageBudget(int wanted) : wanted_(wanted), quality_(wanted) {}

  int quality() const { return quality_; }
  /// Tells the sizes (bytes) that quality() led to. @returns true if the frame is small enough, or can't be made
  /// smaller; false: encode again with the new quality().
  bool Accept(int64_t colour_bytes, int64_t depth_bytes);

  int64_t lowered_frames() const { return lowered_frames_; }    ///< sent with less than the wanted quality
  int64_t oversize_frames() const { return oversize_frames_; }  ///< sent though too large

 private:
  int wanted_, quality_;
  int64_t lowered_frames_ = 0, oversize_frames_ = 0;
};

}  // namespace coach
