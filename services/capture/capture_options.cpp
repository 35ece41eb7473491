#include "services/capture/capture_options.h"

#include <algorithm>

namespace coach {
namespace {

CameraModel ReadIntrinsics(const YamlNode& node) {
  CameraModel camera;
  camera.width = node.Get<int>("width");
  camera.height = node.Get<int>("height");
  camera.fx = node.Get<double>("fx");
  camera.fy = node.Get<double>("fy");
  camera.cx = node.Get<double>("cx");
  camera.cy = node.Get<double>("cy");
  if (const auto distortion = node.Find("distortion")) {
    const auto values = distortion->As<std::vector<double>>();
    if (values.size() != camera.distortion.size()) distortion->Fail("5 numbers: k1, k2, p1, p2, k3");
    std::copy(values.begin(), values.end(), camera.distortion.begin());
  }
  node.RejectUnknownKeys();
  if (const std::string problem = camera.Problem(); !problem.empty()) node.Fail(problem, "a usable camera");
  return camera;
}

/// "scene:recordings/a" -> "scene:/etc/coach/recordings/a"
std::string WithAbsolutePath(const std::string& source, const std::filesystem::path& folder) {
  for (const std::string scheme : {"scene:", "oni:"}) {
    if (source.rfind(scheme, 0) == 0 && source.size() > scheme.size())
      return scheme + (folder / source.substr(scheme.size())).lexically_normal().string();
  }
  return source;
}

}  // namespace

CaptureOptions ReadCaptureOptions(const YamlNode& section, const std::filesystem::path& folder) {
  CaptureOptions options;
  options.source = WithAbsolutePath(section.Get<std::string>("source", options.source), folder);
  options.fps = section.GetInRange("fps", options.fps, 0.1, 1000);
  options.width = section.Get<int>("width", options.width);
  options.height = section.Get<int>("height", options.height);
  options.jpeg_quality = static_cast<int>(section.GetInRange("jpeg_quality", options.jpeg_quality, 1, 100));
  if (const auto intrinsics = section.Find("intrinsics")) options.intrinsics = ReadIntrinsics(*intrinsics);
  section.RejectUnknownKeys();
  return options;
}

}  // namespace coach
