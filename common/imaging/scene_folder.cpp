#include "common/imaging/scene_folder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "common/imaging/image_codec.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

[[noreturn]] void Fail(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

std::string ImageName(int im_id, const char* extension) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d%s", im_id, extension);
  return name;
}

/// A whole number written in decimal digits only, else -1.
int ParseId(const std::string& text) {
  if (text.empty() || text.size() > 9 ||
      !std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; }))
    return -1;
  return std::stoi(text);
}

json ReadJson(const fs::path& file) {
  std::ifstream in(file);
  if (!in) Fail(file, "cannot be opened (a scene folder holds rgb/, depth/ and scene_camera.json)");
  try {
    return json::parse(in);
  } catch (const json::exception& e) {
    Fail(file, std::string("is not valid JSON: ") + e.what());
  }
}

/// A value as a message shows it. What is nested is named only: writing it out takes stack for every level.
std::string Shown(const json& value) {
  const bool nested =
      value.is_structured() && std::any_of(value.begin(), value.end(), [](const json& v) { return v.is_structured(); });
  return nested ? std::string("a nested ") + value.type_name() : value.dump();
}

double Number(const fs::path& file, const std::string& place, const json& value) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    Fail(file, place + ": a number expected, found " + Shown(value));
  return value.get<double>();
}

CameraModel ParseCamera(const fs::path& file, const std::string& place, const json& entry) {
  if (!entry.is_object() || !entry.contains("cam_K")) Fail(file, place + ": an object with cam_K expected");
  const json& K = entry["cam_K"];
  if (!K.is_array() || K.size() != 9) Fail(file, place + ".cam_K: 9 numbers expected, found " + Shown(K));
  const auto at = [&](size_t i) { return Number(file, place + ".cam_K[" + std::to_string(i) + "]", K[i]); };
  CameraModel camera;
  camera.fx = at(0);
  camera.cx = at(2);
  camera.fy = at(4);
  camera.cy = at(5);
  if (at(1) != 0 || at(3) != 0 || at(6) != 0 || at(7) != 0 || at(8) != 1)
    Fail(file, place + ".cam_K: a camera matrix [fx 0 cx, 0 fy cy, 0 0 1] expected, found " + Shown(K));
  if (camera.fx <= 0 || camera.fy <= 0) Fail(file, place + ".cam_K: focal lengths must be positive, found " + Shown(K));
  return camera;
}

double ParseDepthScale(const fs::path& file, const std::string& place, const json& entry) {
  if (!entry.contains("depth_scale")) return 0.001;
  const double scale = Number(file, place + ".depth_scale", entry["depth_scale"]);
  if (scale <= 0) Fail(file, place + ".depth_scale: mm per unit expected, found " + Shown(entry["depth_scale"]));
  return scale / 1000;
}

fs::path FindImage(const fs::path& folder, int im_id, const std::vector<const char*>& extensions) {
  for (const char* extension : extensions) {
    fs::path file = folder / ImageName(im_id, extension);
    if (fs::exists(file)) return file;
  }
  std::string names;
  for (const char* extension : extensions) names += (names.empty() ? "" : " or ") + ImageName(im_id, extension);
  Fail(folder, names + " is missing, though scene_camera.json lists image " + std::to_string(im_id));
}

cv::Mat ReadImage(const fs::path& file, int flags, int type, const char* expected) {
  cv::Mat image;
  try {
    image = cv::imread(file.string(), flags);
  } catch (const cv::Exception& e) {
    Fail(file, std::string("cannot be decoded: ") + e.what());
  }
  if (image.empty()) Fail(file, "cannot be decoded");
  if (image.type() != type) Fail(file, std::string("is no ") + expected + " image");
  return image;
}

void CheckSize(const fs::path& file, const cv::Mat& image, const CameraModel& camera) {
  if (image.cols == camera.width && image.rows == camera.height) return;
  Fail(file, "is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                 " px, but the scene's first image is " + std::to_string(camera.width) + " x " +
                 std::to_string(camera.height));
}

}  // namespace

SceneReader::SceneReader(fs::path folder, const Options& options) : folder_(std::move(folder)), options_(options) {
  if (!std::isfinite(options_.fps) || options_.fps <= 0)
    throw std::runtime_error("scene " + folder_.string() + ": frame rate must be positive, found " +
                             std::to_string(options_.fps));
  const fs::path file = folder_ / "scene_camera.json";
  const json cameras = ReadJson(file);
  if (!cameras.is_object() || cameras.empty()) Fail(file, "an object with one entry an image expected");
  for (const auto& [key, value] : cameras.items()) {
    const std::string place = "image \"" + key + "\"";
    Entry entry;
    entry.im_id = ParseId(key);
    if (entry.im_id < 0) Fail(file, place + ": the key must be a number");
    entry.camera = ParseCamera(file, place, value);
    entry.metres_per_unit = ParseDepthScale(file, place, value);
    entry.colour = FindImage(folder_ / "rgb", entry.im_id, {".png", ".jpg"});
    entry.depth = FindImage(folder_ / "depth", entry.im_id, {".png"});
    entries_.push_back(std::move(entry));
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.im_id < b.im_id; });
  scene_id_ = std::max(0, ParseId(fs::weakly_canonical(folder_).filename().string()));
  const cv::Mat first = ReadImage(entries_[0].depth, cv::IMREAD_UNCHANGED, CV_16UC1, "16-bit grey");
  for (Entry& entry : entries_) {
    entry.camera.width = first.cols;
    entry.camera.height = first.rows;
    if (const std::string problem = entry.camera.Problem(); !problem.empty())
      Fail(file, "image \"" + std::to_string(entry.im_id) + "\": " + problem);
  }
}

int64_t SceneReader::utime(int index) const {
  return options_.utime_origin + std::llround((im_id(index) - im_id(0)) * period_us());
}

Frame SceneReader::Read(int index) const {
  const Entry& entry = At(index);
  Frame frame;
  frame.utime = utime(index);
  frame.sequence = index;
  frame.camera = entry.camera;
  frame.metres_per_unit = entry.metres_per_unit;
  frame.colour = ReadImage(entry.colour, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION, CV_8UC3, "8-bit colour");
  frame.depth = ReadImage(entry.depth, cv::IMREAD_UNCHANGED, CV_16UC1, "16-bit grey");
  CheckSize(entry.colour, frame.colour, entry.camera);
  CheckSize(entry.depth, frame.depth, entry.camera);
  return frame;
}

SceneWriter::SceneWriter(fs::path folder, const Options& options) : folder_(std::move(folder)), options_(options) {
  std::error_code error;
  for (const char* sub : {"rgb", "depth"}) {
    fs::create_directories(folder_ / sub, error);
    if (error) Fail(folder_ / sub, "cannot be made: " + error.message());
  }
  cameras_.open(folder_ / "scene_camera.json");
  if (!cameras_) Fail(folder_ / "scene_camera.json", "cannot be written");
}

SceneWriter::~SceneWriter() { cameras_ << (last_im_id_ >= 0 ? "\n}\n" : "{}\n"); }

void SceneWriter::Write(const Frame& frame, int im_id) {
  const cv::Size size(frame.camera.width, frame.camera.height);
  if (frame.colour.type() != CV_8UC3 || frame.depth.type() != CV_16UC1 || frame.colour.size() != size ||
      frame.depth.size() != size)
    throw std::invalid_argument("scene writer: a frame needs 8-bit colour and 16-bit depth of the camera's size");
  if (im_id <= last_im_id_)
    throw std::invalid_argument("scene writer: found im_id " + std::to_string(im_id) + " after " +
                                std::to_string(last_im_id_) + ", expected a greater one");
  const fs::path colour = folder_ / "rgb" / ImageName(im_id, options_.jpeg ? ".jpg" : ".png");
  const fs::path depth = folder_ / "depth" / ImageName(im_id, ".png");
  if (options_.jpeg) {
    const std::vector<uint8_t> bytes = EncodeJpeg(frame.colour, options_.jpeg_quality);
    std::ofstream out(colour, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) Fail(colour, "cannot be written");
  } else if (!cv::imwrite(colour.string(), frame.colour)) {
    Fail(colour, "cannot be written");
  }
  if (!cv::imwrite(depth.string(), frame.depth)) Fail(depth, "cannot be written");
  const CameraModel& c = frame.camera;
  const json entry = {{"cam_K", {c.fx, 0., c.cx, 0., c.fy, c.cy, 0., 0., 1.}},
                      {"depth_scale", frame.metres_per_unit * 1000}};
  cameras_ << (last_im_id_ >= 0 ? ",\n" : "{\n") << '"' << im_id << "\": " << entry.dump() << std::flush;
  if (!cameras_) Fail(folder_ / "scene_camera.json", "cannot be written");
  last_im_id_ = im_id;
}

}  // namespace coach
