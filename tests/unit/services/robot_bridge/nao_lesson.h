// A NAO with a conductor, against the fake robot, in real time.
#pragma once

#include <algorithm>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "fake_qi_server.h"
#include "services/robot_bridge/conductor.h"
#include "services/robot_bridge/nao_robot.h"
#include "services/robot_bridge/robot_options.h"

namespace coach {

inline NaoOptions OptionsFor(const FakeQiServer& server) {
  NaoOptions options;
  options.url = server.url();
  options.call_timeout_s = 0.5;
  return options;
}

/// A robot with a conductor, followed in real time; the table is seen, and no hand is there.
class Lesson {
 public:
  explicit Lesson(const FakeQiServer& server) : Lesson(OptionsFor(server)) {}
  explicit Lesson(const NaoOptions& nao) : robot(nao) {
    ConductorOptions options;
    options.X_TR = MakePose(ExpRotation(Vector3(0, 0, -std::numbers::pi / 2)), Vector3(0, 0.5, 0.08));
    conductor.emplace(options, robot);
  }
  void Step() {
    conductor->SetScene(scene, SteadyNow());
    conductor->Step(SteadyNow());
    for (const ActChange& change : conductor->TakeChanges()) {
      if (!change.repeated) changes.push_back(change);
    }
  }
  bool Wait(double seconds, const std::function<bool()>& condition) {
    return Until(
        seconds, [this] { Step(); }, condition);
  }
  bool WaitReady() {
    return Wait(15, [this] { return robot.State().connected; });
  }
  void Act(int64_t id, const std::string& text, bool point = false, const std::string& language = "en") {
    RobotCommand command;
    command.id = id;
    command.session = 1;
    command.text = text;
    command.language = language;
    command.eye_colour = "blue";
    command.valid_for_us = 8000000;
    if (point) command.point_target = command.look_target = Vector3(0.15, 0.05, 0.02);
    conductor->Offer(command, SteadyNow());
  }
  bool Ended(int64_t id) const {
    return std::any_of(changes.begin(), changes.end(),
                       [id](const ActChange& change) { return change.id == id && IsFinal(change.state); });
  }
  ActState Last(int64_t id) const {
    ActState state = ActState::kNone;
    for (const ActChange& change : changes) state = change.id == id ? change.state : state;
    return state;
  }
  std::string Reason(int64_t id) const {
    std::string reason;
    for (const ActChange& change : changes) reason = change.id == id ? change.reason : reason;
    return reason;
  }

  TableScene scene;
  NaoRobot robot;
  std::optional<Conductor> conductor;
  std::vector<ActChange> changes;
};

}  // namespace coach
