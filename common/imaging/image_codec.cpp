#include "common/imaging/image_codec.h"

#include <turbojpeg.h>
#include <zstd.h>

#include <bit>
#include <cstring>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace coach {
namespace {

static_assert(std::endian::native == std::endian::little, "16-bit depth travels as it lies in memory");

[[noreturn]] void Refuse(const std::string& what) { throw std::invalid_argument(what); }

void CheckSides(int width, int height) {
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
    Refuse("image of " + std::to_string(width) + " x " + std::to_string(height) + " px");
}

void CheckBytes(const char* what, size_t found, size_t expected) {
  if (found != expected)
    Refuse(std::string(what) + " of " + std::to_string(found) + " bytes, " + std::to_string(expected) + " expected");
}

using Jpeg = std::unique_ptr<void, int (*)(tjhandle)>;

cv::Mat DecodeJpeg(std::span<const uint8_t> bytes, int width, int height) {
  const Jpeg jpeg(tjInitDecompress(), tjDestroy);
  const auto size = static_cast<unsigned long>(bytes.size());
  int found_width = 0, found_height = 0, sampling = 0, colours = 0;
  if (tjDecompressHeader3(jpeg.get(), bytes.data(), size, &found_width, &found_height, &sampling, &colours) != 0)
    Refuse(std::string("JPEG header: ") + tjGetErrorStr2(jpeg.get()));
  if (found_width != width || found_height != height)
    Refuse("JPEG of " + std::to_string(found_width) + " x " + std::to_string(found_height) + " px, " +
           std::to_string(width) + " x " + std::to_string(height) + " expected");
  cv::Mat image(height, width, CV_8UC3);
  if (tjDecompress2(jpeg.get(), bytes.data(), size, image.data, width, static_cast<int>(image.step), height, TJPF_BGR,
                    TJFLAG_STOPONWARNING) != 0)
    Refuse(std::string("JPEG: ") + tjGetErrorStr2(jpeg.get()));
  return image;
}

}  // namespace

std::vector<uint8_t> EncodeJpeg(const cv::Mat& image, int quality) {
  if (image.type() != CV_8UC3 || quality < 1 || quality > 100)
    Refuse("JPEG needs an 8-bit colour image and a quality of 1..100");
  CheckSides(image.cols, image.rows);
  const Jpeg jpeg(tjInitCompress(), tjDestroy);
  std::vector<uint8_t> bytes(tjBufSize(image.cols, image.rows, TJSAMP_444));
  unsigned char* data = bytes.data();
  unsigned long size = bytes.size();
  if (tjCompress2(jpeg.get(), image.data, image.cols, static_cast<int>(image.step), image.rows, TJPF_BGR, &data, &size,
                  TJSAMP_444, quality, TJFLAG_NOREALLOC) != 0)
    Refuse(std::string("JPEG: ") + tjGetErrorStr2(jpeg.get()));
  bytes.resize(size);
  return bytes;
}

std::vector<uint8_t> EncodeColour(const cv::Mat& image, ColourEncoding encoding, int quality) {
  if (encoding == ColourEncoding::kJpeg) return EncodeJpeg(image, quality);
  if (image.type() != CV_8UC3) Refuse("an 8-bit colour image expected");
  CheckSides(image.cols, image.rows);
  std::vector<uint8_t> bytes(image.total() * 3);
  cv::Mat rgb(image.rows, image.cols, CV_8UC3, bytes.data());
  cv::cvtColor(image, rgb, cv::COLOR_BGR2RGB);
  return bytes;
}

cv::Mat DecodeColour(std::span<const uint8_t> bytes, ColourEncoding encoding, int width, int height) {
  CheckSides(width, height);
  if (encoding == ColourEncoding::kJpeg) return DecodeJpeg(bytes, width, height);
  if (encoding != ColourEncoding::kRgb8)
    Refuse("unknown colour encoding " + std::to_string(static_cast<int>(encoding)));
  cv::Mat image(height, width, CV_8UC3);
  CheckBytes("rgb8 image", bytes.size(), image.total() * 3);
  std::memcpy(image.data, bytes.data(), bytes.size());
  cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
  return image;
}

std::vector<uint8_t> EncodeDepth(const cv::Mat& image, DepthEncoding encoding, int level) {
  if (image.type() != CV_16UC1) Refuse("a 16-bit depth image expected");
  CheckSides(image.cols, image.rows);
  const cv::Mat packed = image.isContinuous() ? image : image.clone();
  const size_t size = packed.total() * 2;
  if (encoding == DepthEncoding::kRaw16) return {packed.data, packed.data + size};
  std::vector<uint8_t> bytes(ZSTD_compressBound(size));
  const size_t written = ZSTD_compress(bytes.data(), bytes.size(), packed.data, size, level);
  if (ZSTD_isError(written)) Refuse(std::string("zstd: ") + ZSTD_getErrorName(written));
  bytes.resize(written);
  return bytes;
}

cv::Mat DecodeDepth(std::span<const uint8_t> bytes, DepthEncoding encoding, int width, int height) {
  CheckSides(width, height);
  cv::Mat image(height, width, CV_16UC1);
  const size_t size = image.total() * 2;
  if (encoding == DepthEncoding::kRaw16) {
    CheckBytes("raw16 image", bytes.size(), size);
    std::memcpy(image.data, bytes.data(), size);
  } else if (encoding == DepthEncoding::kZstd) {
    const size_t written = ZSTD_decompress(image.data, size, bytes.data(), bytes.size());
    if (ZSTD_isError(written)) Refuse(std::string("zstd depth: ") + ZSTD_getErrorName(written));
    CheckBytes("zstd depth", written, size);
  } else {
    Refuse("unknown depth encoding " + std::to_string(static_cast<int>(encoding)));
  }
  return image;
}

}  // namespace coach
