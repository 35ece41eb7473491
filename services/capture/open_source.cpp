#include "services/capture/open_source.h"

#include "services/capture/openni_source.h"
#include "services/capture/scene_source.h"

namespace coach {
namespace {

/// What follows `scheme` in the address, if it begins with it.
std::optional<std::string> After(const std::string& address, const std::string& scheme) {
  if (address.rfind(scheme, 0) != 0) return std::nullopt;
  return address.substr(scheme.size());
}

}  // namespace

void CheckSource(const CaptureOptions& options) {
  const auto scene = After(options.source, "scene:"), oni = After(options.source, "oni:");
  if ((scene && !scene->empty()) || (oni && !oni->empty()) || After(options.source, "openni2:")) return;
  throw ConfigurationError("camera source: found '" + options.source +
                           "', expected openni2:, openni2:DEVICE, oni:FILE or scene:FOLDER");
}

std::unique_ptr<FrameSource> OpenSource(const CaptureOptions& options) {
  if (const auto folder = After(options.source, "scene:")) return std::make_unique<SceneSource>(*folder, options.fps);
  if (const auto file = After(options.source, "oni:")) return OpenOniFile(*file, options);
  return OpenOpenNiDevice(After(options.source, "openni2:").value_or(""), options);
}

}  // namespace coach
