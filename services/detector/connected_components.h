// Connected regions of a binary image by run-length union-find, 8-connected.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/detector/bit_image.h"

namespace coach {

/// Pixels begin..end-1 of row y.
struct PixelRun {
  int y = 0, begin = 0, end = 0;
  int component = 0;  ///< index of the component it belongs to
};

struct Component {
  int area = 0;                        ///< px
  std::array<double, 2> centroid{};    ///< px; x, y
  std::array<int, 4> box{0, 0, 0, 0};  ///< px; x, y, width, height
};

/// Working memory and result in one, so that a frame allocates nothing once sizes have settled.
class ConnectedComponents {
 public:
  void Find(const BitImage& image);

  const std::vector<PixelRun>& runs() const { return runs_; }               ///< row by row
  const std::vector<Component>& components() const { return components_; }  ///< in the order of their first pixel

 private:
  std::vector<PixelRun> runs_;
  std::vector<int> parent_;
  std::vector<Component> components_;
};

}  // namespace coach
