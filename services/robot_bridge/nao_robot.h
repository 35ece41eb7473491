// A NAO (V4 to V6, NAOqi 2) over its own messaging protocol. A Pepper speaks and lights its eyes, but does not point:
// its arms are not a NAO's.
//
// What it does to the robot, in this order, whenever it connects: version, configuration, limits, languages, battery;
// autonomous life and everything that moves by itself off, collision protection on; seated; only then stiffness of head
// and arms; volume; head touches. A robot that does not sit speaks and does not move.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/robot_bridge/back_end.h"
#include "services/robot_bridge/qi/session.h"
#include "services/robot_bridge/speech_renderer.h"

namespace coach {

struct NaoOptions {
  std::string url = "tcp://nao.local:9559";  ///< tcp://host:port or tcps://host:port
  std::string user, token;                   ///< both empty: no login
  double call_timeout_s = 5;                 ///< s, of short calls; motion gets its own length more
  double largest_volume = 0.8;               ///< 0..1
};

class NaoRobot : public BackEnd {
 public:
  /// @throws std::invalid_argument for a URL that is none
  explicit NaoRobot(const NaoOptions& options, Recordings recordings = {});
  ~NaoRobot() override;

  std::string name() const override { return "nao"; }
  bool physical() const override { return true; }
  std::vector<BackEndEvent> Poll(int64_t now) override;
  BackEndState State() const override;
  std::optional<JointAngles> MeasuredAngles() const override { return measured_; }

  void Say(const SpeechOrder& speech) override;
  void Silence() override;
  void Move(const JointPath& path) override;
  void Freeze() override;
  void SetEyes(const EyeColour& colour) override;
  void Rest() override;
  void Wake() override;
  void SetVolume(double volume) override;

 private:
  struct Step {
    std::string service, method;
    qi::List arguments;
    double timeout_s = 0;                         // 0: the usual
    std::function<void(const qi::Result&)> then;  // before the next step; may be empty
  };
  enum class Stage { kAway, kPreparing, kReady };

  void Begin();
  std::deque<Step> Inquiries();
  std::deque<Step> Quieting();
  std::deque<Step> Seating();
  std::deque<Step> Finishing();
  void RunSteps(int64_t generation);
  void Watch(int64_t now);
  void Tell(const std::string& service, const std::string& method, qi::List arguments, double timeout_s = 0);

  void TakeLimits(size_t joint, const qi::Result& result);
  void TakePosture(const qi::Result& result);
  void SayItself(const SpeechOrder& speech, const std::string& robots_language);
  void PlayRendered(int64_t now);
  void PlayNextChunk(int64_t id);
  void EndSpeech(int64_t id, const std::string& error);

  NaoOptions options_;
  SpeechRenderer renderer_;
  int64_t now_ = 0, generation_ = 0;
  Stage stage_ = Stage::kAway;
  std::deque<Step> steps_;
  bool prepared_ = false;  // since it connected

  std::set<std::string> languages_;  // as the robot calls them
  std::string set_language_;
  bool seated_ = false, pepper_ = false, resting_ = false;
  std::array<std::pair<double, double>, kNumJoints> limits_{};
  double volume_ = 0.6, battery_ = -1;
  std::optional<JointAngles> measured_;
  int64_t next_battery_ = 0, next_angles_ = 0, moving_until_ = 0;
  bool asking_angles_ = false;

  std::optional<SpeechOrder> speech_;
  std::optional<qi::List> chunks_;  // of streamed speech, still to be sent
  int64_t speech_end_ = 0;          // us, of streamed speech; 0: not yet known
  std::vector<BackEndEvent> events_;
  std::vector<JointPath> held_back_;  // moves that wait for the robot to be awake

  qi::Session session_;  // last: its callbacks use all of the above
};

}  // namespace coach
