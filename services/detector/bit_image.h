// Binary images, 64 pixels a word: what makes morphology and runs cheap.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace coach {

/// Rows of 64-bit words; pixel x of a row is bit x % 64 of word x / 64. Bits beyond the width are always 0.
class BitImage {
 public:
  /// All pixels 0. Keeps its memory if it is large enough.
  void Resize(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  int words() const { return words_; }  ///< a row
  uint64_t* row(int y) { return bits_.data() + static_cast<size_t>(y) * static_cast<size_t>(words_); }
  const uint64_t* row(int y) const { return bits_.data() + static_cast<size_t>(y) * static_cast<size_t>(words_); }
  bool at(int x, int y) const { return row(y)[x / 64] >> (x % 64) & 1; }

 private:
  int width_ = 0, height_ = 0, words_ = 0;
  std::vector<uint64_t> bits_;
};

/// Pixels whose byte in `classes` (width * height) has bit `bit`.
void ExtractBit(const uint8_t* classes, int width, int height, int bit, BitImage& out);

/// Neighbourhood of 3 x 3 pixels. Beyond the image's border is neither foreground for dilation nor background for
/// erosion.
void Dilate(const BitImage& in, BitImage& out);
void Erode(const BitImage& in, BitImage& out);

/// Opening (removes what is thinner than 2 radius + 1 px) in place, with `scratch` as working memory.
void Open(int radius, BitImage& image, BitImage& scratch);
/// Closing (fills gaps of up to 2 radius px) in place.
void Close(int radius, BitImage& image, BitImage& scratch);

/// Calls f(begin, end) for every run [begin, end) of ones in a row.
template <typename F>
void ForEachRun(const BitImage& image, int y, const F& f) {
  const uint64_t* row = image.row(y);
  int begin = -1;  // of the run that is open
  for (int w = 0; w < image.words(); ++w) {
    uint64_t word = row[w];
    if (begin < 0 && word == 0) continue;
    int x = 0;
    while (x < 64) {
      const uint64_t rest = (begin < 0 ? word : ~word) >> x;
      if (rest == 0) break;
      x += std::countr_zero(rest);
      if (begin < 0) {
        begin = 64 * w + x;
      } else {
        f(begin, 64 * w + x);
        begin = -1;
      }
    }
  }
  if (begin >= 0) f(begin, image.width());
}

}  // namespace coach
