// Runs the virtual robot without a bus, for tests of its page: one JSON order a line on standard input, the page's URL
// and then every change of an act's state and every call for help on standard output.
//
//   {"act": {"id": 1, "language": "en", "text": "...", "point": [x, y, z], "look": [x, y, z], "eyes": "blue",
//            "replaces": 0, "look_first": false}}
//   {"scene": {"parts": [[x, y, yaw], ...], "hands": [[x, y, z, radius], ...]}}
//   {"act": {"id": 2, "rest": true}}  {"stop": true}
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/assembly/task_file.h"
#include "services/robot_bridge/robot_options.h"
#include "services/robot_bridge/virtual_robot.h"

namespace {

using namespace coach;
using nlohmann::json;

int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Vector3 VectorOf(const json& list) {
  return Vector3(list[0].get<double>(), list[1].get<double>(), list[2].get<double>());
}

RobotCommand CommandOf(const json& act) {
  RobotCommand command;
  command.id = act["id"];
  command.session = 1;
  command.text = act.value("text", "");
  command.language = act.value("language", "en");
  command.eye_colour = act.value("eyes", "");
  command.valid_for_us = 20000000;
  command.priority = Priority::kExplanatory;
  command.replaces_id = act.value("replaces", 0);
  if (act.value("look_first", false)) command.order = ActOrder::kLookThenSay;
  if (act.contains("point")) command.point_target = VectorOf(act["point"]);
  if (act.contains("look")) command.look_target = VectorOf(act["look"]);
  if (act.value("rest", false)) command.kind = ActKind::kRest;
  return command;
}

TableScene SceneOf(const json& order) {
  TableScene scene;
  for (const json& part : order["parts"]) {
    TableScene::TablePart at;
    at.part = static_cast<int>(scene.parts.size());
    at.status = PartStatus::kTracked;
    at.X_TP = MakePose(Eigen::AngleAxisd(part[2].get<double>(), Vector3::UnitZ()).toRotationMatrix(),
                       Vector3(part[0].get<double>(), part[1].get<double>(), 0.015));
    scene.parts.push_back(at);
  }
  for (const json& hand : order.value("hands", json::array())) {
    scene.foreign.push_back({VectorOf(hand), hand[3].get<double>(), Vector3::Zero()});
  }
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  RobotOptions options = ReadRobotOptions(YamlNode::Parse("{}", "defaults"));
  options.virtual_robot.port = 0;
  VirtualRobot robot(options.virtual_robot, options.conductor.X_TR);
  robot.ShowTask(LoadTask(argv[1]));
  Conductor conductor(options.conductor, robot);
  std::cout << robot.url() << std::endl;
  TableScene scene;
  int64_t help = 0;
  std::string buffer;
  for (;;) {
    pollfd input{0, POLLIN, 0};
    if (poll(&input, 1, 10) > 0) {
      char bytes[4096];
      const ssize_t got = read(0, bytes, sizeof bytes);
      if (got <= 0) return 0;
      buffer.append(bytes, static_cast<size_t>(got));
    }
    for (size_t end = buffer.find('\n'); end != std::string::npos; end = buffer.find('\n')) {
      const json order = json::parse(buffer.substr(0, end));
      buffer.erase(0, end + 1);
      if (order.contains("act")) conductor.Offer(CommandOf(order["act"]), Now());
      if (order.contains("scene")) scene = SceneOf(order["scene"]);
      if (order.contains("stop")) conductor.Stop(Now());
    }
    conductor.SetScene(scene, Now());
    conductor.Step(Now());
    for (const ActChange& change : conductor.TakeChanges()) {
      std::cout << change.id << ' ' << ToString(change.state) << ' ' << change.reason << std::endl;
    }
    if (conductor.help_requests() != help) std::cout << "help " << (help = conductor.help_requests()) << std::endl;
  }
}
