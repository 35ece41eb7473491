// coach-simulate: writes a simulated lesson as a scene folder with ground truth.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>

#include "common/assembly/task_file.h"
#include "tools/simulator/scene_recorder.h"

namespace {

int Run(int argc, char** argv) {
  CLI::App app("Writes a simulated lesson as a scene folder: pictures, depth, ground truth.");
  std::string out, task_file;
  coach::ScenarioOptions options;
  coach::RecordOptions record;
  bool list = false, png = false;
  app.add_option("OUT", out, "folder to write; must not exist");
  app.add_option("--task", task_file, "task file");
  app.add_option("--scenario", options.name, "what happens; see --list")->capture_default_str();
  app.add_option("--seed", options.seed, "room, child and noise; the same seed gives the same bytes")
      ->capture_default_str();
  app.add_option("--fps", options.fps, "Hz")->check(CLI::Range(1.0, 120.0))->capture_default_str();
  app.add_option("--seconds", options.seconds, "length, 0: as long as the scenario takes")
      ->check(CLI::Range(0.0, 3600.0));
  app.add_option("--style", options.style, "of the child: slow, normal, hasty, hesitant")->capture_default_str();
  app.add_option("--depth", options.depth_sensor, "kinect, tof or perfect")->capture_default_str();
  app.add_option("--mistakes", options.mistakes, "wrong connections a lesson")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--width", options.width, "px")->check(CLI::Range(64, 1920))->capture_default_str();
  app.add_option("--height", options.height, "px")->check(CLI::Range(48, 1080))->capture_default_str();
  app.add_option("--jpeg-quality", record.jpeg_quality)->check(CLI::Range(1, 100))->capture_default_str();
  app.add_flag("--png", png, "colour as PNG");
  app.add_flag("--list", list, "prints the scenarios");
  CLI11_PARSE(app, argc, argv);
  if (list) {
    for (const auto& s : coach::ScenarioNames()) std::cout << s.name << ": " << s.description << "\n";
    return 0;
  }
  if (out.empty() || task_file.empty()) throw std::invalid_argument("OUT and --task are needed (--help)");
  if (std::filesystem::exists(out) && !std::filesystem::is_empty(out))
    throw std::invalid_argument(out + ": is not empty");
  record.jpeg = !png;
  const coach::Scenario scenario = coach::MakeScenario(coach::LoadTask(task_file), options);
  const size_t frames = scenario.frame_times.size();
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const auto start = std::chrono::steady_clock::now();
  coach::RecordScene(scenario, out, record, [&](int done) {
    if (!terminal || done % 10 != 0) return;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::cerr << "\r" << done << " of " << frames << " frames, "
              << static_cast<int>(spent / done * static_cast<double>(frames - static_cast<size_t>(done)))
              << " s left   " << std::flush;
  });
  const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (terminal) std::cerr << "\r";
  std::cout << out << ": " << frames << " frames, " << 1000 * spent / static_cast<double>(std::max<size_t>(1, frames))
            << " ms a frame\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "coach-simulate: " << e.what() << "\n";
    return 1;
  }
}
