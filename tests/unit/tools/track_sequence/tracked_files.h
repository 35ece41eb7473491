// Scene folders to track, copies of them with less in them, and what the tracker writes about them.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tools/track_sequence/sequence_tracker.h"

namespace coach {

/// A folder that goes with the object.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / (name + "_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string Contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  return all.str();
}

/// The first `frames` images of a scene with nothing that a live camera does not give: colour, depth, cam_K and
/// depth_scale; and the models and the task.
inline void CopyStripped(const std::filesystem::path& from, const std::filesystem::path& to, int frames) {
  namespace fs = std::filesystem;
  fs::create_directories(to / "rgb");
  fs::create_directories(to / "depth");
  fs::copy(from / "models", to / "models", fs::copy_options::recursive);
  fs::copy(from / "task.yaml", to / "task.yaml");
  std::ifstream in(from / "scene_camera.json");
  const nlohmann::json cameras = nlohmann::json::parse(in);
  nlohmann::json kept;
  for (const auto& [id, camera] : cameras.items()) {
    if (std::stoi(id) >= frames) continue;
    kept[id] = {{"cam_K", camera.at("cam_K")}, {"depth_scale", camera.at("depth_scale")}};
    std::string name(6 - std::min<size_t>(6, id.size()), '0');
    name += id;
    for (const char* file : {"rgb", "depth"}) {
      for (const char* ending : {".png", ".jpg"}) {
        if (fs::exists(from / file / (name + ending)))
          fs::copy(from / file / (name + ending), to / file / (name + ending));
      }
    }
  }
  std::ofstream(to / "scene_camera.json") << kept.dump();
}

/// Poses, states and events of one run, one after the other.
struct TrackedFiles {
  std::string poses, states, events;
  bool operator==(const TrackedFiles&) const = default;
};

inline TrackedFiles Track(const std::filesystem::path& scene, double fps, uint64_t seed = 1, bool paper = false) {
  const ScratchFolder out("coach_tracked");
  SequenceOptions options;
  options.scene = scene;
  options.task = scene / "task.yaml";
  options.poses = out.path() / "poses.csv";
  options.states = out.path() / "states.csv";
  options.events = out.path() / "events.csv";
  options.fps = fps;
  options.seed = seed;
  options.paper = paper;
  TrackSequence(options);
  return {Contents(options.poses), Contents(options.states), Contents(options.events)};
}

}  // namespace coach
