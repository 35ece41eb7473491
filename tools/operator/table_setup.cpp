#include "tools/operator/table_setup.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/core.hpp>
#include <set>

#include "common/assembly/task_file.h"
#include "common/configuration/station_edit.h"
#include "common/configuration/task_choice.h"
#include "services/detector/detector_options.h"
#include "services/robot_bridge/robot_options.h"
#include "tools/operator/camera_check.h"
#include "tools/operator/colour_calibration.h"
#include "tools/operator/json_text.h"
#include "tools/operator/page_options.h"
#include "tools/operator/robot_seat.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json RangeJson(const HsvRange& range) { return {{"low", range.low}, {"high", range.high}}; }

Json CameraJson(const std::optional<Frame>& frame, const CameraCheck& check) {
  return {{"alive", frame.has_value()},
          {"problems", frame ? check.problems : std::vector<std::string>{"no_picture"}},
          {"brightness", Rounded(check.brightness, 1)},
          {"depth_share", Rounded(check.depth_share, 100)},
          {"table_share", Rounded(check.table_share, 100)},
          {"residual_mm", Rounded(check.residual * 1000, 10)},
          {"distance_cm", Rounded(check.distance * 100, 1)},
          {"tilt_degrees", Rounded(check.tilt * 180 / std::numbers::pi, 1)}};
}

/// The word by which a type's range is kept in the station file.
std::string ColourKey(const PartType& type) { return type.colour.empty() ? type.name : type.colour; }

/// Colours of a task in the order of its types, each with the types that have it.
std::vector<std::pair<std::string, std::vector<const PartType*>>> ColoursOf(const Task& task) {
  std::vector<std::pair<std::string, std::vector<const PartType*>>> colours;
  for (const auto& type : task.types) {
    auto known =
        std::find_if(colours.begin(), colours.end(), [&](const auto& c) { return c.first == ColourKey(type); });
    if (known == colours.end()) known = colours.insert(known, {ColourKey(type), {}});
    known->second.push_back(&type);
  }
  return colours;
}

/// Other colours of the task whose ranges have something in common with `range`.
Json Overlaps(const Task& task, const std::map<std::string, HsvRange>& own, const std::string& colour,
              const HsvRange& range) {
  Json names = Json::array();
  for (const auto& [name, types] : ColoursOf(task)) {
    if (name != colour && Overlap(range, RangeOf(*types[0], own))) names.push_back(name);
  }
  return names;
}

/// Pixels of the tracked parts of a colour; empty if none is tracked.
PixelMask PartPixels(const Lesson& lesson, const std::string& colour, const cv::Size& size, const cv::Point* at) {
  const auto view = lesson.view();
  const auto task = lesson.task();
  PixelMask all;
  if (!view || !task || !task->task || view->outlines.size() != task->task->parts.size()) return all;
  for (size_t k = 0; k < view->outlines.size(); ++k) {
    const PartEstimate& part = view->poses.parts[k];
    if (ColourKey(task->task->TypeOf(static_cast<int>(k))) != colour || part.status != PartStatus::kTracked) continue;
    const PixelMask inside = InsideOf(view->outlines[k], size);
    if (at && (!cv::Rect({0, 0}, size).contains(*at) || !inside.at<uint8_t>(*at))) continue;
    all = all.empty() ? inside : PixelMask(all | inside);
  }
  return all;
}

/// Whether a service must start again to use what the set-up changes.
bool Concerned(const std::string& service) {
  return service == "detector" || service == "pose-filter" || service == "assembly-reasoner" ||
         service == "robot-bridge";
}

/// Whether a pixel shows something on the table or no further than an arm above it.
bool OnTable(const Frame& frame, const Plane& table, const cv::Point& at) {
  if (!cv::Rect({0, 0}, frame.depth.size()).contains(at)) return false;
  const CameraModel& c = frame.camera;
  const double z = frame.depth.at<uint16_t>(at) * frame.metres_per_unit;
  const double height = table.Height({(at.x - c.cx) / c.fx * z, (at.y - c.cy) / c.fy * z, z});
  return z == 0 || (height > -0.02 && height < 0.25);
}

Json RobotJson(const Station& station) {
  const RobotOptions options = ReadRobotOptions(station.Section("robot"));
  Json json = SeatJson(options.conductor.X_TR);
  json["back_end"] = options.back_end;
  json["volume"] = Rounded(options.volume, 100);
  json["url"] = options.nao.url;
  json["seated"] = station.Section("robot").Has("position");
  return json;
}

/// A station that offers the shipped tasks.
Station Shipped(const fs::path& folder) {
  Station station = DefaultStation();
  if (!folder.empty()) station.task = folder / "none.yaml";
  return station;
}

/// Settings of {"low": [..], "high": [..]} by colour, with those that the station has already.
std::string ColoursValue(const Station& station, const Json& changes) {
  Json all = Json::object();
  for (const auto& [name, range] : ReadDetectorOptions(station.Section("detector")).colours)
    all[name] = RangeJson(range);
  for (const auto& [name, range] : changes.items()) {
    if (range.is_null()) {
      all.erase(name);
    } else {
      all[name] = range;
    }
  }
  return Dump(all);
}

/// The NAO's section with another address.
std::string NaoValue(const NaoOptions& nao, const std::string& url) {
  Json json{{"url", url}, {"call_timeout", nao.call_timeout_s}, {"largest_volume", nao.largest_volume}};
  if (!nao.user.empty()) json.update({{"user", nao.user}, {"token", nao.token}});
  return Dump(json);
}

void AddRobot(const Json& robot, const Station& now, std::vector<Setting>& settings) {
  for (const char* key : {"back_end", "volume", "position", "roll_pitch_yaw"}) {
    if (robot.contains(key)) settings.push_back({{"robot", key}, Dump(robot.at(key))});
  }
  const NaoOptions nao = ReadRobotOptions(now.Section("robot")).nao;
  const std::string url = robot.value("url", nao.url);
  if (url != nao.url) settings.push_back({{"robot", "nao"}, NaoValue(nao, url)});
}

/// As every service will read it. @throws ConfigurationError
void Check(const Station& station) {
  ReadDetectorOptions(station.Section("detector"));
  ReadRobotOptions(station.Section("robot"));
  ReadPageOptions(station);
}

}  // namespace

TableSetup::TableSetup(Sources sources) : sources_(std::move(sources)) {}

Station TableSetup::station() const {
  if (sources_.file.empty()) return DefaultStation();
  try {
    return ReadStation(sources_.file);
  } catch (const ConfigurationError&) {
    return DefaultStation();
  }
}

void TableSetup::OnConfiguration(const std::string& service, const std::string& yaml) {
  const std::lock_guard lock(mutex_);
  running_[service] = yaml;
}

fs::path TableSetup::FileOfTask(const Station& station, const std::string& name) const {
  const auto own = TaskNames(station);
  const bool known = std::find(own.begin(), own.end(), name) != own.end();
  return TaskFileNamed(known ? station : Shipped(sources_.shipped_tasks), name);
}

std::shared_ptr<const Task> TableSetup::TaskOf(const Station& station, std::string& problem) const {
  if (station.task.empty()) return nullptr;
  std::error_code error;
  const auto time = fs::last_write_time(station.task, error);
  const std::lock_guard lock(mutex_);
  if (task_ && task_file_ == station.task && task_time_ == time && !error) return task_;
  try {
    task_ = std::make_shared<const Task>(LoadTask(station.task, {.read_meshes = false}));
    task_file_ = station.task;
    task_time_ = time;
    return task_;
  } catch (const std::exception& e) {
    problem = e.what();
    return nullptr;
  }
}

std::string TableSetup::Status() const {
  const Station now = station();
  const std::optional<Frame> frame = sources_.frame();
  const CameraCheck camera = frame ? CheckCamera(*frame) : CameraCheck();
  std::string task_problem;
  const auto task = TaskOf(now, task_problem);
  Json json{{"file", sources_.file.string()}, {"camera", CameraJson(frame, camera)}, {"robot", RobotJson(now)}};
  std::set<std::string> tasks;
  for (const Station& offering : {now, Shipped(sources_.shipped_tasks)}) {
    for (const auto& name : TaskNames(offering)) tasks.insert(name);
  }
  json["tasks"] = tasks;
  json["task"] = {{"choice", now.task.stem().string()}, {"problem", task_problem}};
  json["colours"] = Json::array();
  const auto own = ReadDetectorOptions(now.Section("detector")).colours;
  const PixelMask table = frame && camera.table ? TablePixels(*frame, *camera.table) : PixelMask();
  for (const auto& [name, types] : task ? ColoursOf(*task) : decltype(ColoursOf(*task)){}) {
    const HsvRange range = RangeOf(*types[0], own);
    Json colour{{"name", name},
                {"range", RangeJson(range)},
                {"own", own.contains(name) || own.contains(types[0]->name)},
                {"overlaps", Overlaps(*task, own, name, range)},
                {"types", Json::array()}};
    for (const auto* type : types) colour["types"].push_back(type->name);
    if (frame) {
      colour["table_share"] = Rounded(ShareIn(range, frame->colour, table), 1000);
      const PixelMask part = PartPixels(*sources_.lesson, name, frame->colour.size(), nullptr);
      if (!part.empty()) colour["part_share"] = Rounded(ShareIn(range, frame->colour, part), 100);
    }
    json["colours"].push_back(std::move(colour));
  }
  json["old"] = Json::array();
  const std::lock_guard lock(mutex_);
  for (const auto& [service, yaml] : running_) {
    if (yaml != now.text && Concerned(service)) json["old"].push_back(service);
  }
  return Dump(json);
}

std::string TableSetup::SuggestColour(const std::string& request) const {
  const Json asked = Json::parse(request);
  const std::string colour = asked.at("colour");
  const cv::Point at(asked.at("x").get<int>(), asked.at("y").get<int>());
  const Station now = station();
  std::string problem;
  const auto task = TaskOf(now, problem);
  if (!task) throw std::invalid_argument("no_task");
  const std::optional<Frame> frame = sources_.frame();
  if (!frame || frame->colour.empty()) throw std::invalid_argument("no_picture");
  const CameraCheck camera = CheckCamera(*frame);
  if (camera.table && !OnTable(*frame, *camera.table, at)) throw std::invalid_argument("not_on_table");
  const PixelMask table = camera.table ? TablePixels(*frame, *camera.table) : PixelMask();
  PixelMask pixels = PartPixels(*sources_.lesson, colour, frame->colour.size(), &at);
  const bool part = !pixels.empty();
  if (!part) pixels = ClickedRegion(*frame, camera.table, at.x, at.y);
  const auto range = SuggestRange(frame->colour, pixels, table);
  if (!range) throw std::invalid_argument("few_pixels");
  const auto own = ReadDetectorOptions(now.Section("detector")).colours;
  return Dump({{"range", RangeJson(*range)},
               {"pixels", cv::countNonZero(pixels)},
               {"part", part},
               {"part_share", Rounded(ShareIn(*range, frame->colour, pixels), 1000)},
               {"table_share", Rounded(ShareIn(*range, frame->colour, table), 1000)},
               {"overlaps", Overlaps(*task, own, colour, *range)}});
}

std::string TableSetup::SuggestSeat(const std::string& request) const {
  const Json asked = Json::parse(request);
  const auto view = sources_.lesson->view();
  const auto place = [&](const char* key) {
    const size_t part = asked.at(key).get<size_t>();
    if (!view || part >= view->poses.parts.size() || view->poses.parts[part].status != PartStatus::kTracked)
      throw std::invalid_argument("unseen");
    return Vector3(view->poses.parts[part].X_TP.translation());
  };
  const RobotSeat seat =
      SeatFromMarks(place("near"), place("far"), asked.at("ahead").get<double>(), asked.at("height").get<double>());
  if (!seat.problem.empty()) throw std::invalid_argument(seat.problem);
  return Dump(SeatJson(seat.X_TR));
}

std::string TableSetup::Save(const std::string& request) {
  const Json asked = Json::parse(request);
  {
    const std::lock_guard lock(saving_);
    if (sources_.file.empty())
      throw ConfigurationError("this page was started without a station file: start it with --config FILE");
    const Station now = ReadStation(sources_.file);
    std::vector<Setting> settings;
    if (asked.contains("task")) {
      const fs::path file = fs::absolute(FileOfTask(now, asked.at("task"))).lexically_normal();
      LoadTask(file);
      settings.push_back({{"task"}, Dump(file.string())});
    }
    if (asked.contains("colours"))
      settings.push_back({{"detector", "colours"}, ColoursValue(now, asked.at("colours"))});
    if (asked.contains("robot")) AddRobot(asked.at("robot"), now, settings);
    if (now.state_folder.empty() && !sources_.state_folder.empty() && !settings.empty())
      settings.push_back({{"state_folder"}, Dump(sources_.state_folder.string())});
    const std::string text = WithSettings(now.text, settings);
    const Station changed = ParseStation(text, sources_.file);
    Check(changed);
    if (!changed.state_folder.empty()) fs::create_directories(changed.state_folder);
    ReplaceFile(sources_.file, text);
  }
  return Status();
}

fs::path ShippedTasks() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (fs::is_directory(folder / "../share/coach/tasks", error))
    return (folder / "../share/coach/tasks").lexically_normal();
  for (fs::path above = folder; above != above.parent_path(); above = above.parent_path()) {
    if (fs::is_directory(above / "deploy/tasks", error)) return above / "deploy/tasks";
  }
  return {};
}

}  // namespace coach
