#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "common/assembly/task_file.h"
#include "common/bus/command_signature.h"
#include "common/bus/service_main.h"
#include "services/robot_bridge/log_back_end.h"
#include "services/robot_bridge/nao_robot.h"
#include "services/robot_bridge/robot_bridge_service.h"
#include "services/robot_bridge/robot_options.h"
#include "services/robot_bridge/virtual_robot.h"

namespace {

using namespace coach;

std::unique_ptr<BackEnd> MakeBackEnd(const RobotOptions& options, const Station& station) {
  if (options.back_end == "log") {
    return std::make_unique<LogBackEnd>([](const std::string& line) { spdlog::info("robot: {}", line); });
  }
  Recordings recordings;
  if (!options.recordings.empty()) {
    recordings = Recordings(std::filesystem::absolute(station.file).parent_path() / options.recordings);
    spdlog::info("{} recorded sentences", recordings.size());
  }
  if (options.back_end == "nao") return std::make_unique<NaoRobot>(options.nao, std::move(recordings));
  auto robot = std::make_unique<VirtualRobot>(options.virtual_robot, options.conductor.X_TR, std::move(recordings));
  if (!station.task.empty()) robot->ShowTask(LoadTask(station.task));
  spdlog::info("virtual robot: {}", robot->url());
  return robot;
}

}  // namespace

int main(int argc, char** argv) {
  std::string back_end_name;
  int port = -1;
  return ServiceMain(
      argc, argv, "robot-bridge", "Coach's robot bridge: has a robot say, point and look what the guidance decides.",
      [&](CLI::App& app) {
        app.add_option("--back-end", back_end_name, "virtual, nao or log instead of the station file's")
            ->check(CLI::IsMember({"virtual", "nao", "log"}));
        app.add_option("--port", port, "port of the virtual robot's page, 0: any free one")
            ->check(CLI::Range(0, 65535));
      },
      [&](ServiceContext& context) {
        RobotOptions options = ReadRobotOptions(context.station.Section("robot"));
        if (!back_end_name.empty()) options.back_end = back_end_name;
        if (port >= 0) options.virtual_robot.port = port;
        context.node.url = context.station.robot_url;
        context.node.period_ms = 10;
        Node node(context.node);
        const std::unique_ptr<BackEnd> back_end = MakeBackEnd(options, context.station);
        back_end->SetVolume(options.volume);
        Conductor conductor(options.conductor, *back_end);
        RobotBridgeService(node, conductor, *back_end, ReadKey(context.station.key_file)).Run();
      });
}
