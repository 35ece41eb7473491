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
#include "common/configuration/station_edit.h"
#include "services/robot_bridge/nao_robot.h"
#include "services/robot_bridge/robot_options.h"
#include "tools/calibrate_robot/calibration_run.h"

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

std::vector<Setting> SeatSettings(const Pose& X_TR) {
  const Vector3 p = X_TR.translation(), degrees = SeatDegrees(X_TR);
  char position[64], angles[64];
  std::snprintf(position, sizeof position, "[%.4f, %.4f, %.4f]", p.x(), p.y(), p.z());
  std::snprintf(angles, sizeof angles, "[%.2f, %.2f, %.2f]", degrees.x(), degrees.y(), degrees.z());
  return {{{"robot", "position"}, position}, {{"robot", "roll_pitch_yaw"}, angles}};
}

/// One line for each pose that is over since the last call.
void TellPoses(const CalibrationRun& run, size_t* told) {
  for (; *told < run.reports().size(); ++*told) {
    const PoseReport& pose = run.reports()[*told];
    spdlog::info("pose {} of {}: {} in {} frames{}", *told + 1, run.poses(), pose.used ? "seen" : "not seen well",
                 pose.frames, pose.used ? "" : "; left out");
  }
}

void Report(const CalibrationRun& run, const Station& station, bool write) {
  if (run.state() == CalibrationRun::State::kFailed) throw std::runtime_error("no result: " + run.problem());
  const CalibrationResult& result = run.result();
  const auto settings = SeatSettings(result.X_TR);
  std::printf(
      "# from %zu poses: residual %.1f mm, to be expected elsewhere %.1f mm; the part sits %.0f mm from the hand's "
      "point\n%s",
      run.samples().size(), 1e3 * result.residual, 1e3 * result.left_out_residual, 1e3 * result.p_H.norm(),
      WithSettings("", settings).c_str());
  if (result.left_out_residual > kWorstCalibration)
    throw std::runtime_error("not written: an error of over 20 mm is to be expected; did the part move in the hand?");
  if (!write) return;
  ReplaceFile(station.file, WithSettings(station.text, settings));
  std::printf("# written to %s; the old one is %s.1\n", station.file.c_str(), station.file.c_str());
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
        CalibrationRun run(robot, arm_name == "left" ? Arm::kLeft : Arm::kRight, index);
        node.SubscribeNewest<part_poses_t>([&](const part_poses_t& message) { run.See(FromMessage(message)); });
        size_t told = 0;
        node.Run([&] {
          run.Step(Now());
          TellPoses(run, &told);
          if (run.over()) node.Stop();
        });
        if (run.over()) Report(run, context.station, !keep && !context.station.file.empty());
      });
}
