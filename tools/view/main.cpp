// coach-view: a recorded scene with the tracked parts drawn over it, as pictures or in a window.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/highgui.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "common/assembly/task_file.h"
#include "common/imaging/scene_folder.h"
#include "tools/operator/outline.h"

namespace coach {
namespace {

constexpr size_t kMaxTriangles = 20000;  // of a mesh that is drawn

struct Options {
  std::string scene, task, poses, output;
  int every = 1, from = 0, until = -1;
  bool window = false;
  double fps = 15;
};

constexpr const char* kWindow = "coach-view";

void OpenWindow() { cv::namedWindow(kWindow, cv::WINDOW_AUTOSIZE | cv::WINDOW_GUI_NORMAL); }

/// Whether a window can be opened. Tried in a process of its own: without a screen the window's library ends the
/// process with a page of its own words.
bool HasScreen() {
  const pid_t trial = fork();
  if (trial == 0) {
    const int silent = open("/dev/null", O_WRONLY);
    dup2(silent, STDERR_FILENO);
    OpenWindow();
    _exit(0);
  }
  int status = 1;
  return trial > 0 && waitpid(trial, &status, 0) == trial && status == 0;
}

/// Shows a picture for `milliseconds`; the space bar holds it. @return false if the window was closed, or by Esc or q
bool Show(const cv::Mat& picture, int milliseconds) {
  constexpr int kEscape = 27;
  cv::imshow(kWindow, picture);
  for (int key = cv::waitKey(std::max(1, milliseconds));; key = cv::waitKey(100)) {
    static bool held = false;
    if (key == ' ') held = !held;
    if (key == kEscape || key == 'q' || cv::getWindowProperty(kWindow, cv::WND_PROP_VISIBLE) < 1) return false;
    if (!held) return true;
  }
}

void WritePicture(const std::string& folder, int im_id, const cv::Mat& picture) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d.jpg", im_id);
  const auto file = std::filesystem::path(folder) / name;
  if (!cv::imwrite(file.string(), picture)) throw std::runtime_error(file.string() + ": can't be written");
}

std::vector<cv::Point> Corners(const Polygon& polygon) {
  std::vector<cv::Point> corners;
  for (const auto& p : polygon) corners.emplace_back(cvRound(p.x()), cvRound(p.y()));
  return corners;
}

/// A clear colour of the type's range: blue, green, red.
cv::Scalar ColourOf(const PartType& type) {
  const int span = (type.hsv.high[0] - type.hsv.low[0] + 180) % 180;
  const cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar((type.hsv.low[0] + span / 2) % 180, 230, 255));
  cv::Mat bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  return {static_cast<double>(bgr.data[0]), static_cast<double>(bgr.data[1]), static_cast<double>(bgr.data[2])};
}

void DrawPart(cv::Mat& image, const std::vector<Polygon>& outlines, const cv::Scalar& colour, const std::string& name,
              bool seen) {
  if (outlines.empty()) return;
  for (const auto& polygon : outlines) {
    const std::vector<std::vector<cv::Point>> lines{Corners(polygon)};
    cv::polylines(image, lines, true, cv::Scalar::all(255), seen ? 4 : 2, cv::LINE_AA);
    cv::polylines(image, lines, true, colour, seen ? 2 : 1, cv::LINE_AA);
  }
  const cv::Rect box = cv::boundingRect(Corners(outlines[0]));
  const cv::Point place(box.x + box.width / 2 - static_cast<int>(name.size()) * 4, box.y + box.height / 2 + 4);
  cv::putText(image, name, place, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar::all(0), 3, cv::LINE_AA);
  cv::putText(image, name, place, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar::all(255), 1, cv::LINE_AA);
}

struct DrawnPose {
  Pose X_CP = Pose::Identity();
  double score = 0;
};

/// Poses of every frame, in the order of Task::parts. @throws std::runtime_error "file:line: ..."
std::map<int, std::vector<DrawnPose>> ReadPoses(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": can't be read");
  std::map<int, std::vector<DrawnPose>> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line.starts_with("scene_id")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    int scene_id = 0, im_id = 0, object_id = 0;
    DrawnPose pose;
    Matrix3 R;
    Vector3 t;
    fields >> scene_id >> im_id >> object_id >> pose.score;
    for (int k = 0; k < 9; ++k) fields >> R(k / 3, k % 3);
    fields >> t.x() >> t.y() >> t.z();
    if (!fields)
      throw std::runtime_error(file + ":" + std::to_string(number) + ": expected a row of BOP's results csv");
    pose.X_CP = MakePose(R, t / 1000);
    poses[im_id].push_back(pose);
  }
  return poses;
}

int Draw(const Options& options) {
  const std::filesystem::path own_task = std::filesystem::path(options.scene) / "task.yaml";
  const Task task = LoadTask(options.task.empty() ? own_task : std::filesystem::path(options.task));
  const SceneReader scene(options.scene);
  const auto poses = ReadPoses(options.poses);
  std::vector<TriangleMesh> meshes;
  for (const auto& type : task.types) meshes.push_back(Simplified(type.mesh, kMaxTriangles));
  if (options.output.empty() && !options.window)
    throw std::runtime_error("give a folder for the pictures, or --window");
  if (options.window && !HasScreen())
    throw std::runtime_error("there is no screen for a window; give a folder for the pictures");
  if (options.window) OpenWindow();
  if (!options.output.empty()) std::filesystem::create_directories(options.output);
  int drawn = 0;
  const int end = options.until < 0 ? scene.size() : std::min(scene.size(), options.until + 1);
  for (int index = options.from; index < end; index += options.every) {
    Frame frame = scene.Read(index);
    const auto found = poses.find(scene.im_id(index));
    const size_t parts = found == poses.end() ? 0 : std::min(found->second.size(), task.parts.size());
    for (size_t k = 0; k < parts; ++k) {
      const DrawnPose& pose = found->second[k];
      if (pose.X_CP.translation().z() <= 0) continue;
      const auto type = static_cast<size_t>(task.parts[k].type);
      DrawPart(frame.colour, Silhouette(meshes[type], pose.X_CP, frame.camera), ColourOf(task.types[type]),
               task.parts[k].name, pose.score > 0);
    }
    if (!options.output.empty()) WritePicture(options.output, scene.im_id(index), frame.colour);
    ++drawn;
    if (options.window && !Show(frame.colour, static_cast<int>(1000 / options.fps))) break;
  }
  if (!options.output.empty()) std::printf("%d pictures in %s\n", drawn, options.output.c_str());
  return drawn > 0 ? 0 : 1;
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  coach::Options options;
  CLI::App app(
      "Draws the tracked parts over a recorded scene: full lines where a part is followed, thin ones where it is not.",
      "coach-view");
  app.add_option("SCENE", options.scene, "scene folder")->required();
  app.add_option("POSES", options.poses, "poses of coach-track-sequence (BOP's results csv)")->required();
  app.add_option("OUTPUT", options.output, "folder for the pictures");
  app.add_flag("--window", options.window, "show them in a window: space bar holds, Esc ends");
  app.add_option("--fps", options.fps, "pictures a second in the window")->check(CLI::Range(0.1, 100.0));
  app.add_option("--task", options.task, "task file (default: task.yaml of the scene)");
  app.add_option("--every", options.every, "draw every n-th frame")->check(CLI::PositiveNumber);
  app.add_option("--from", options.from, "first frame")->check(CLI::NonNegativeNumber);
  app.add_option("--until", options.until, "last frame")->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    return coach::Draw(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coach-view: %s\n", e.what());
    return 1;
  }
}
