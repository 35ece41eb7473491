#include "common/configuration/station.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace coach {
namespace {

constexpr std::array kSections{"camera", "detector", "pose_filter", "guidance", "robot", "page", "log"};

bool GoodCharacter(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

std::string HostAsName() {
  char host[33] = "";
  gethostname(host, sizeof host - 1);
  std::string name = host;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !GoodCharacter(c); }, '-');
  return name.empty() ? "station" : name;
}

std::string UrlOf(const YamlNode& bus, const std::string& key, const std::string& otherwise) {
  std::string url = bus.Get<std::string>(key, otherwise);
  if (url.find("://") == std::string::npos) bus.At(key).Fail("an LCM URL such as " + otherwise);
  return url;
}

/// LCM's packets stay on the host unless the URL asks for more.
bool LeavesTheHost(const std::string& url) {
  const size_t ttl = url.find("ttl=");
  return ttl != std::string::npos && std::atoi(url.c_str() + ttl + 4) > 0;
}

}  // namespace

std::string StationNameProblem(const std::string& name) {
  if (!name.empty() && name.size() <= 32 && std::all_of(name.begin(), name.end(), GoodCharacter)) return "";
  return "1 to 32 characters of A-Z a-z 0-9 _ - .";
}

Station DefaultStation() {
  Station station;
  station.name = HostAsName();
  return station;
}

YamlNode Station::Section(const std::string& section) const {
  const std::optional<YamlNode> node = root ? root->Find(section) : std::nullopt;
  return node ? *node : YamlNode::Parse("{}", section);
}

Station ParseStation(const std::string& text, const std::filesystem::path& file) {
  Station station = DefaultStation();
  station.file = file;
  station.text = text;
  YamlNode root = YamlNode::Parse(text, file.string());
  if (root.IsNull()) root = YamlNode::Parse("{}", file.string());
  station.root = root;
  if (!root.IsMap()) root.Fail("a map of settings");
  const auto path = [&](const YamlNode& map, const std::string& key) -> std::filesystem::path {
    const std::string value = map.Get<std::string>(key, std::string());
    return value.empty() ? std::filesystem::path() : std::filesystem::absolute(file).parent_path() / value;
  };
  station.name = root.Get<std::string>("station", station.name);
  if (const std::string expected = StationNameProblem(station.name); !expected.empty())
    root.At("station").Fail(expected);
  station.task = path(root, "task");
  station.state_folder = path(root, "state_folder");
  if (const auto bus = root.Find("bus")) {
    station.table_url = UrlOf(*bus, "table", station.table_url);
    station.robot_url = UrlOf(*bus, "robot", station.robot_url);
    station.key_file = path(*bus, "key_file");
    if (LeavesTheHost(station.robot_url) && station.key_file.empty())
      bus->At("robot").Fail(station.robot_url, "ttl=0, or a `key_file` beside it: what leaves this computer is signed");
    bus->RejectUnknownKeys();
  }
  for (const char* section : kSections) {
    const auto node = root.Find(section);
    if (node && !node->IsMap()) node->Fail("a map of settings");
  }
  root.RejectUnknownKeys();
  return station;
}

Station ReadStation(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file)) throw ConfigurationError(file.string() + ": can't be read");
  return ParseStation({std::istreambuf_iterator<char>(in), {}}, file);
}

}  // namespace coach
