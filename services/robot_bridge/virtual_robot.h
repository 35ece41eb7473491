// The virtual robot: a friendly face in the browser instead of a machine.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/assembly/task.h"
#include "services/robot_bridge/back_end.h"
#include "services/robot_bridge/screen_server.h"
#include "services/robot_bridge/speech_renderer.h"

namespace coach {

class VirtualRobot : public BackEnd {
 public:
  /// @param X_TR the robot's place, for the picture of the table
  VirtualRobot(const VirtualRobotOptions& options, const Pose& X_TR, Recordings recordings = {});

  /// What lies on the table: names, colours and shapes of the parts.
  void ShowTask(const Task& task);
  std::string url() const { return server_.url(); }
  int port() const { return server_.port(); }
  int attached() const { return server_.attached(); }

  std::string name() const override { return "virtual"; }
  bool physical() const override { return false; }
  std::vector<BackEndEvent> Poll(int64_t now) override;
  /// Always connected: without a page, sentences last as long as they would take to say.
  BackEndState State() const override { return {true, "", -1}; }

  void Say(const SpeechOrder& speech) override;
  void Silence() override;
  void Move(const JointPath& path) override;
  void Freeze() override;
  void SetEyes(const EyeColour& colour) override;
  void Rest() override;
  void Wake() override;
  void SetVolume(double volume) override;
  void ShowScene(const TableScene& scene) override;
  void ShowTarget(const std::optional<Vector3>& p_T) override;

 private:
  struct Speech {
    SpeechOrder order;
    bool refused = false;  // no voice
    int64_t begun = 0;     // us; 0: still being rendered
    double seconds = 0;
    std::set<std::string> speakers;  // pages that are saying it
    bool heard = false;              // some page has said that it began
  };
  void SendHello();
  void Announce(const RenderedSpeech& rendered, int64_t now);
  bool Over(int64_t now) const;

  Pose X_TR_;
  std::string task_json_ = "null";
  ScreenServer server_;
  SpeechRenderer renderer_;
  std::optional<Speech> speech_;
};

}  // namespace coach
