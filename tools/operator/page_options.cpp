#include "tools/operator/page_options.h"

namespace coach {
namespace {

constexpr size_t kShortestToken = 12;  // characters

}  // namespace

PageOptions ReadPageOptions(const Station& station) {
  PageOptions options;
  const YamlNode page = station.Section("page");
  options.server.address = page.Get<std::string>("address", options.server.address);
  options.server.port = static_cast<int>(page.GetInRange("port", options.server.port, 0, 65535));
  options.server.access.token = page.Get<std::string>("token", "");
  if (!options.server.access.token.empty() && options.server.access.token.size() < kShortestToken) {
    page.At("token").Fail("at least " + std::to_string(kShortestToken) + " characters");
  }
  options.server.access.pictures_over_network = page.Get<bool>("pictures_over_network", false);
  options.lesson.picture_rate = page.GetInRange("picture_rate", options.lesson.picture_rate, 1, 60);
  options.languages = page.Get<std::vector<std::string>>("languages", options.languages);
  const std::string annotations = page.Get<std::string>("annotations", "");
  if (!annotations.empty()) {
    options.annotations = std::filesystem::absolute(station.file).parent_path() / annotations;
  } else if (!station.state_folder.empty()) {
    options.annotations = station.state_folder / "annotations.jsonl";
  }
  page.RejectUnknownKeys();
  return options;
}

}  // namespace coach
