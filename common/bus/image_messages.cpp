#include "common/bus/image_messages.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/bus/message_fields.h"

namespace coach {
namespace {

void CheckImage(const cv::Mat& image, const CameraModel& camera) {
  if (image.cols != camera.width || image.rows != camera.height)
    throw std::invalid_argument("image is not of its camera's size");
}

template <class M>
void SetHead(const Frame& frame, M& m) {
  m.utime = frame.utime;
  m.received_utime = frame.received_utime;
  m.sequence = frame.sequence;
  m.intrinsics = ToMessage(frame.camera);
  m.exposure_skew_us = frame.exposure_skew_us;
}

template <class M>
Frame Head(const M& m) {
  if (m.data_size < 0 || static_cast<size_t>(m.data_size) != m.data.size())
    RefuseField("data_size", std::to_string(m.data_size));
  Frame frame;
  frame.utime = m.utime;
  frame.received_utime = m.received_utime;
  frame.sequence = m.sequence;
  frame.camera = FromMessage(m.intrinsics);
  frame.exposure_skew_us = m.exposure_skew_us;
  return frame;
}

}  // namespace

intrinsics_t ToMessage(const CameraModel& camera) {
  intrinsics_t m;
  m.width = static_cast<int16_t>(camera.width);
  m.height = static_cast<int16_t>(camera.height);
  m.fx = camera.fx;
  m.fy = camera.fy;
  m.cx = camera.cx;
  m.cy = camera.cy;
  std::copy(camera.distortion.begin(), camera.distortion.end(), m.distortion);
  return m;
}

CameraModel FromMessage(const intrinsics_t& m) {
  CameraModel camera;
  camera.width = IndexInRange(m.width, 1, kMaxImageSide, "intrinsics.width");
  camera.height = IndexInRange(m.height, 1, kMaxImageSide, "intrinsics.height");
  camera.fx = m.fx;
  camera.fy = m.fy;
  camera.cx = m.cx;
  camera.cy = m.cy;
  for (size_t i = 0; i < 5; ++i) camera.distortion[i] = Finite(m.distortion[i], "intrinsics.distortion");
  if (const std::string problem = camera.Problem(); !problem.empty())
    throw std::invalid_argument("intrinsics: " + problem);
  return camera;
}

color_image_t ToColourMessage(const Frame& frame, ColourEncoding encoding, int jpeg_quality) {
  CheckImage(frame.colour, frame.camera);
  color_image_t m;
  SetHead(frame, m);
  m.encoding = static_cast<int8_t>(encoding);
  m.data = EncodeColour(frame.colour, encoding, jpeg_quality);
  m.data_size = static_cast<int32_t>(m.data.size());
  return m;
}

depth_image_t ToDepthMessage(const Frame& frame, DepthEncoding encoding) {
  CheckImage(frame.depth, frame.camera);
  depth_image_t m;
  SetHead(frame, m);
  m.encoding = static_cast<int8_t>(encoding);
  m.metres_per_unit = static_cast<float>(frame.metres_per_unit);
  m.data = EncodeDepth(frame.depth, encoding);
  m.data_size = static_cast<int32_t>(m.data.size());
  return m;
}

Frame FromMessage(const color_image_t& m) {
  Frame frame = Head(m);
  frame.colour = DecodeColour(m.data, KnownValue(m.encoding, ColourEncoding::kRgb8, "encoding"), frame.camera.width,
                              frame.camera.height);
  return frame;
}

Frame FromMessage(const depth_image_t& m) {
  Frame frame = Head(m);
  // The nearest nanometre: 0.001F becomes 0.001, so that a frame over the bus measures what the frame in memory did.
  frame.metres_per_unit = std::round(InRange(m.metres_per_unit, 1e-6, 1, "metres_per_unit") * 1e9) / 1e9;
  frame.depth = DecodeDepth(m.data, KnownValue(m.encoding, DepthEncoding::kRaw16, "encoding"), frame.camera.width,
                            frame.camera.height);
  return frame;
}

}  // namespace coach
