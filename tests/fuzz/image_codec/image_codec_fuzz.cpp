// Fuzzes the decoders of images: byte 0 chooses one, bytes 1 and 2 the size that the image is said to have.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "common/imaging/class_map.h"
#include "common/imaging/image_codec.h"

using namespace coach;

namespace {

void Use(uint8_t choice, int width, int height, std::span<const uint8_t> bytes) {
  switch (choice % 5) {
    case 0:
      DecodeColour(bytes, ColourEncoding::kJpeg, width, height);
      break;
    case 1:
      DecodeColour(bytes, ColourEncoding::kRgb8, width, height);
      break;
    case 2:
    case 3: {  // lossless: what was decoded comes back from its own code
      const cv::Mat image =
          DecodeDepth(bytes, choice % 5 == 2 ? DepthEncoding::kZstd : DepthEncoding::kRaw16, width, height);
      const cv::Mat again = DecodeDepth(EncodeDepth(image, DepthEncoding::kZstd), DepthEncoding::kZstd, width, height);
      if (std::memcmp(image.data, again.data, image.total() * 2) != 0) std::abort();
      break;
    }
    default: {
      const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
      const auto map = DecodeClassMap(bytes, pixels);
      if (!map.empty() && DecodeClassMap(EncodeClassMap(map), pixels).size() != pixels) std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 3) return 0;
  try {
    Use(data[0], data[1], data[2], {data + 3, size - 3});
  } catch (const std::invalid_argument&) {
    // the only answer to bytes that are wrong
  }
  return 0;
}
