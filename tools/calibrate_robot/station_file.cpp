#include "tools/calibrate_robot/station_file.h"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "common/configuration/station.h"
#include "services/robot_bridge/robot_calibration.h"
#include "services/robot_bridge/robot_options.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr double kSameMetres = 2e-4, kSameRadians = 2e-4;  // what the written digits leave

bool IsBlank(const std::string& line) {
  const size_t first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#';
}

size_t Indent(const std::string& line) { return line.find_first_not_of(' '); }

bool HasKey(const std::string& line, const std::string& key) {
  const size_t first = Indent(line);
  if (first == std::string::npos || line.compare(first, key.size(), key) != 0) return false;
  const size_t colon = line.find_first_not_of(" \t", first + key.size());
  return colon != std::string::npos && line[colon] == ':';
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The two lines, indented by so many blanks.
std::vector<std::string> PoseLines(const Pose& X_TR, size_t indent) {
  std::vector<std::string> lines = Lines(StationLines(X_TR));
  for (std::string& line : lines) line = std::string(indent, ' ') + line.substr(Indent(line));
  return lines;
}

/// Whether the section's line ends with its key, comments aside.
bool OpensABlock(const std::string& line) {
  const size_t rest = line.find_first_not_of(" \t\r", line.find(':') + 1);
  return rest == std::string::npos || line[rest] == '#';
}

void CheckReadBack(const std::string& text, const Pose& X_TR, const std::string& name) {
  const Station station = ParseStation(text, name);
  const Pose read = ReadRobotOptions(station.Section("robot")).conductor.X_TR;
  const double turned = Eigen::AngleAxisd(read.linear().transpose() * X_TR.linear()).angle();
  if ((read.translation() - X_TR.translation()).norm() > kSameMetres || turned > kSameRadians)
    throw ConfigurationError(name + ": the robot's place can't be written into it; put it in by hand");
}

}  // namespace

std::string WithRobotPose(const std::string& station, const Pose& X_TR, const std::string& name) {
  std::vector<std::string> lines = Lines(station);
  size_t begin = 0;
  while (begin < lines.size() && !(Indent(lines[begin]) == 0 && HasKey(lines[begin], "robot"))) ++begin;
  if (begin == lines.size()) {
    lines.push_back("robot:");
  } else if (!OpensABlock(lines[begin])) {
    throw ConfigurationError(name + ":" + std::to_string(begin + 1) +
                             ": robot: found a value on the key's line, expected one key a line below it");
  }
  size_t end = begin + 1;
  while (end < lines.size() && (IsBlank(lines[end]) || Indent(lines[end]) > 0)) ++end;
  size_t indent = 2;
  for (size_t i = begin + 1; i < end; ++i) {
    if (IsBlank(lines[i])) continue;
    indent = Indent(lines[i]);
    break;
  }
  std::vector<std::string> out(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(begin) + 1);
  for (const std::string& line : PoseLines(X_TR, indent)) out.push_back(line);
  for (size_t i = begin + 1; i < lines.size(); ++i) {
    const bool old = i < end && Indent(lines[i]) == indent && !IsBlank(lines[i]) &&
                     (HasKey(lines[i], "position") || HasKey(lines[i], "roll_pitch_yaw"));
    if (!old) out.push_back(lines[i]);
  }
  std::string text;
  for (const std::string& line : out) text += line + "\n";
  CheckReadBack(text, X_TR, name);
  return text;
}

fs::path WriteRobotPose(const fs::path& file, const Pose& X_TR) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream old_text;
  old_text << in.rdbuf();
  if (!in) throw std::runtime_error(file.string() + ": can't be read");
  const std::string text = WithRobotPose(old_text.str(), X_TR, file.string());
  fs::path kept = file.string() + ".old", fresh = file.string() + ".new";
  for (int number = 2; fs::exists(kept); ++number) kept = file.string() + ".old" + std::to_string(number);
  std::ofstream out(fresh, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(fresh.string() + ": can't be written");
  fs::permissions(fresh, fs::status(file).permissions());
  fs::copy_file(file, kept);
  fs::rename(fresh, file);
  return kept;
}

}  // namespace coach
