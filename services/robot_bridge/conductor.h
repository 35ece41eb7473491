// Carries out acts: takes commands in, lets one at a time run on the back end (speech, arm, gaze, eyes together), and
// says what became of each.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/robot_bridge/act_queue.h"
#include "services/robot_bridge/back_end.h"
#include "services/robot_bridge/body.h"

namespace coach {

struct ConductorOptions {
  ActQueueOptions queue;
  GestureOptions gesture;
  Pose X_TR = Pose::Identity();     ///< robot's torso in the table frame
  double shortest_point_s = 1.0;    ///< s, the arm is held up at least that long, also if the sentence is over
  double look_first_s = 1.5;        ///< s, "look then say": how long the sentence waits for the head at most
  double straight_after_s = 1.5;    ///< s without an act until the head is straight again
  double heartbeat_timeout_s = 10;  ///< s without a sign of the guidance until the robot rests
};

/// All times are of one monotonic clock (us), handed in.
class Conductor {
 public:
  Conductor(const ConductorOptions& options, BackEnd& back_end);

  /// A stop acts on the back end before this returns.
  void Offer(const RobotCommand& command, int64_t now);
  /// The operator's stop: as a stop command, without one.
  void Stop(int64_t now);
  void SetScene(const TableScene& scene, int64_t now);
  void SetVolume(double volume) { back_end_.SetVolume(volume); }
  /// The guidance lives. From the first call on, silence of `heartbeat_timeout_s` makes the robot rest.
  void Heartbeat(int64_t now);

  /// Call at 50 Hz or more.
  void Step(int64_t now);

  /// The end: withdraws everything, arms down, rest. Go on with Step() until at_rest() or patience is over.
  void Retire(int64_t now);
  bool at_rest() const { return resting_; }

  std::vector<ActChange> TakeChanges() { return queue_.TakeChanges(); }
  bool speaking() const { return speech_ == Speech::kRunning; }
  bool guidance_lost() const { return guidance_lost_; }
  int64_t help_requests() const { return help_requests_; }
  const std::string& language() const { return language_; }
  const Body& body() const { return body_; }

 private:
  enum class Speech { kNone, kPending, kRunning, kDone };

  void HandleEvents(int64_t now);
  void HaltNow(const std::string& reason, int64_t now);
  void Begin(const RobotCommand& command, int64_t now);
  void StartSpeech(int64_t now);
  void StepAct(int64_t now);
  bool GestureDone(int64_t now) const;
  std::string Remarks() const;
  void End(ActState state, const std::string& reason, int64_t now);
  void StepIdle(int64_t now);
  void WatchGuidance(int64_t now);

  ConductorOptions options_;
  BackEnd& back_end_;
  ActQueue queue_;
  Body body_;
  Speech speech_ = Speech::kNone;
  std::string text_, language_ = "en";
  int64_t begun_ = 0, speech_limit_ = 0, held_since_ = 0, ended_ = 0;
  bool straight_ = true, connected_ = false;
  bool rest_wanted_ = false, resting_ = false, retiring_ = false;
  std::optional<int64_t> heartbeat_;
  bool guidance_lost_ = false;
  int64_t help_requests_ = 0;
};

}  // namespace coach
