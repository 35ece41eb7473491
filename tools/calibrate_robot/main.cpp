// coach-calibrate-robot: where the robot sits, from a part in its hand that the tracker sees.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "common/assembly/task_file.h"
#include "common/bus/messages.h"
#include "common/bus/service_main.h"
#include "services/robot_bridge/nao_robot.h"
#include "services/robot_bridge/robot_options.h"
#include "tools/calibrate_robot/calibration_run.h"
#include "tools/calibrate_robot/station_file.h"

namespace {

using namespace coach;

int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

int PartNamed(const Task& task, const std::string& name) {
  for (size_t i = 0; i < task.parts.size(); ++i) {
    if (task.parts[i].name == name) return static_cast<int>(i);
  }
  std::string names;
  for (const Part& part : task.parts) names += (names.empty() ? "" : ", ") + part.name;
  throw ConfigurationError("--part: found '" + name + "', expected one of " + names);
}

constexpr double kWorst = 0.02;  // m, beyond which a result is not worth keeping

void Report(const CalibrationResult& result, size_t samples, const std::filesystem::path& station, bool write) {
  if (!result.success) throw std::runtime_error("no result: " + result.problem);
  std::printf(
      "# from %zu poses: residual %.1f mm, to be expected elsewhere %.1f mm; the part sits %.0f mm from the hand's "
      "point\nrobot:\n%s",
      samples, 1e3 * result.residual, 1e3 * result.left_out_residual, 1e3 * result.p_H.norm(),
      StationLines(result.X_TR).c_str());
  if (result.left_out_residual > kWorst)
    throw std::runtime_error("not written: an error of over 20 mm is to be expected; did the part move in the hand?");
  if (!write) return;
  const auto kept = WriteRobotPose(station, result.X_TR);
  std::printf("# written to %s; the old one is %s\n", station.c_str(), kept.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  std::string part, arm_name = "right";
  bool yes = false, keep = false;
  return ServiceMain(
      argc, argv, "calibrate-robot",
      "Finds where the robot sits and writes it into the station file: the robot holds a part in its hand and takes "
      "eight poses while the tracker watches. The robot bridge must not run at the same time.",
      [&](CLI::App& app) {
        app.add_option("--part", part, "the part in the hand, e.g. long_1")->required();
        app.add_option("--arm", arm_name, "left or right")->check(CLI::IsMember({"left", "right"}));
        app.add_flag("--dry-run", keep, "print the result, leave the station file alone");
        app.add_flag("--yes", yes, "do not ask whether the part is in the hand");
      },
      [&](ServiceContext& context) {
        if (context.station.task.empty())
          throw ConfigurationError("no task: give one in the station file or by --task");
        const int index = PartNamed(LoadTask(context.station.task), part);
        const RobotOptions options = ReadRobotOptions(context.station.Section("robot"));
        context.node.period_ms = 10;
        Node node(context.node);
        NaoRobot robot(options.nao);
        if (!yes) {
          std::cout << "Put " << part << " into the robot's " << arm_name
                    << " hand so that the camera sees it, step back, "
                    << "and press Enter." << std::endl;
          std::cin.get();
        }
        CalibrationRun run(robot, arm_name == "left" ? Arm::kLeft : Arm::kRight, index,
                           [](const std::string& line) { spdlog::info("{}", line); });
        node.SubscribeNewest<part_poses_t>([&](const part_poses_t& message) { run.See(FromMessage(message)); });
        const int64_t begun = Now();
        node.Run([&] {
          const int64_t now = Now();
          robot.Poll(now);
          run.Step(now);
          if (!robot.State().connected && now - begun > 60000000) {
            throw DeviceError("no robot: " + robot.State().detail);
          }
          if (run.finished()) node.Stop();
        });
        if (run.finished())
          Report(CalibrateRobot(run.samples()), run.samples().size(), context.station.file,
                 !keep && !context.station.file.empty());
      });
}
