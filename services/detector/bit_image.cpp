#include "services/detector/bit_image.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace coach {
namespace {

/// Ones in the last word of a row that are pixels.
uint64_t LastWord(int width) { return width % 64 == 0 ? ~uint64_t{0} : (uint64_t{1} << (width % 64)) - 1; }

/// Combines each word of three rows with its neighbours one pixel to the left and right. `outside` (0 or all ones) is
/// what lies beyond the border.
template <typename Combine>
void Neighbourhood(const BitImage& in, BitImage& out, uint64_t outside, const Combine& combine) {
  out.Resize(in.width(), in.height());
  const int words = in.words();
  for (int y = 0; y < in.height(); ++y) {
    const uint64_t* middle = in.row(y);
    const uint64_t* above = y > 0 ? in.row(y - 1) : middle;
    const uint64_t* below = y + 1 < in.height() ? in.row(y + 1) : middle;
    uint64_t* target = out.row(y);
    const uint64_t padding = outside & ~LastWord(in.width());
    const auto column = [&](int w) {
      const uint64_t word = combine(combine(above[w], middle[w]), below[w]);
      return w + 1 == words ? word | padding : word;
    };
    uint64_t previous = outside, current = column(0);
    for (int w = 0; w < words; ++w) {
      const uint64_t next = w + 1 < words ? column(w + 1) : outside;
      target[w] = combine(combine(current, current << 1 | previous >> 63), current >> 1 | next << 63);
      previous = current;
      current = next;
    }
    target[words - 1] &= LastWord(in.width());
  }
}

}  // namespace

void BitImage::Resize(int width, int height) {
  width_ = width;
  height_ = height;
  words_ = (width + 63) / 64;
  bits_.assign(static_cast<size_t>(words_) * static_cast<size_t>(height), 0);
}

void ExtractBit(const uint8_t* classes, int width, int height, int bit, BitImage& out) {
  out.Resize(width, height);
  for (int y = 0; y < height; ++y) {
    const uint8_t* row = classes + static_cast<size_t>(y) * static_cast<size_t>(width);
    uint64_t* words = out.row(y);
    int x = 0;
    for (; x + 8 <= width; x += 8) {
      uint64_t bytes;
      std::memcpy(&bytes, row + x, 8);
      if (bytes == 0) continue;  // most of an image is in no class
      bytes = bytes >> bit & 0x0101010101010101;
      // The product moves the lowest bit of byte i to bit 56 + i.
      words[x / 64] |= (bytes * 0x0102040810204080) >> 56 << (x % 64);
    }
    for (; x < width; ++x) words[x / 64] |= static_cast<uint64_t>(row[x] >> bit & 1) << (x % 64);
  }
}

void Dilate(const BitImage& in, BitImage& out) {
  Neighbourhood(in, out, 0, [](uint64_t a, uint64_t b) { return a | b; });
}

void Erode(const BitImage& in, BitImage& out) {
  Neighbourhood(in, out, ~uint64_t{0}, [](uint64_t a, uint64_t b) { return a & b; });
}

void Open(int radius, BitImage& image, BitImage& scratch) {
  for (int i = 0; i < radius; ++i, std::swap(image, scratch)) Erode(image, scratch);
  for (int i = 0; i < radius; ++i, std::swap(image, scratch)) Dilate(image, scratch);
}

void Close(int radius, BitImage& image, BitImage& scratch) {
  for (int i = 0; i < radius; ++i, std::swap(image, scratch)) Dilate(image, scratch);
  for (int i = 0; i < radius; ++i, std::swap(image, scratch)) Erode(image, scratch);
}

}  // namespace coach
