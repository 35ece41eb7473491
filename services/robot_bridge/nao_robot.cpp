#include "services/robot_bridge/nao_robot.h"

#include <algorithm>
#include <utility>

namespace coach {
namespace {

using qi::List;
using qi::Result;
using qi::Value;

constexpr double kSeatingTime = 40, kAutonomyTime = 30;               // s
constexpr int64_t kBatteryPeriod = 30000000, kAnglesPeriod = 250000;  // us
constexpr size_t kChunkFrames = 16384;                                // what ALAudioDevice takes at once
constexpr size_t kMostPoints = 12;                                    // of a joint's path

qi::SessionOptions SessionOptionsOf(const NaoOptions& options) {
  qi::SessionOptions session;
  session.url = options.url;
  session.user = options.user;
  session.token = options.token;
  session.call_timeout_us = static_cast<int64_t>(options.call_timeout_s * 1e6);
  return session;
}

/// What ALTextToSpeech calls a language; empty for one that no NAO has.
std::string RobotsLanguage(const std::string& code) {
  static const std::map<std::string, std::string> kNames{
      {"ar", "Arabic"},     {"cs", "Czech"},   {"da", "Danish"},  {"de", "German"},    {"el", "Greek"},
      {"en", "English"},    {"es", "Spanish"}, {"fi", "Finnish"}, {"fr", "French"},    {"it", "Italian"},
      {"ja", "Japanese"},   {"ko", "Korean"},  {"nl", "Dutch"},   {"no", "Norwegian"}, {"pl", "Polish"},
      {"pt", "Portuguese"}, {"ru", "Russian"}, {"sv", "Swedish"}, {"tr", "Turkish"},   {"zh", "Chinese"}};
  const auto found = kNames.find(code.substr(0, 2));
  return found == kNames.end() ? "" : found->second;
}

List AllJointNames() {
  List names;
  for (int j = 0; j < kNumJoints; ++j) names.emplace_back(std::string(LimitOf(j).name));
  return names;
}

bool Seated(const std::string& posture) { return posture.starts_with("Sit"); }

/// 16-bit stereo, cut into what the robot takes at once.
List ChunksOf(const RenderedSpeech& speech) {
  List chunks;
  for (size_t first = 0; first < speech.samples.size(); first += kChunkFrames) {
    const size_t frames = std::min(kChunkFrames, speech.samples.size() - first);
    std::string bytes;
    bytes.reserve(4 * frames);
    for (size_t i = first; i < first + frames; ++i) {
      const char* sample = reinterpret_cast<const char*>(&speech.samples[i]);
      bytes.append(sample, 2).append(sample, 2);
    }
    chunks.emplace_back(qi::Raw{std::move(bytes)});
  }
  return chunks;
}

}  // namespace

NaoRobot::NaoRobot(const NaoOptions& options, Recordings recordings)
    : options_(options), renderer_(std::move(recordings)), session_(SessionOptionsOf(options)) {}
NaoRobot::~NaoRobot() = default;

void NaoRobot::Tell(const std::string& service, const std::string& method, List arguments, double timeout_s) {
  session_.Call(
      service, method, std::move(arguments), [](const Result&) {}, static_cast<int64_t>(timeout_s * 1e6));
}

std::deque<NaoRobot::Step> NaoRobot::Inquiries() {
  std::deque<Step> steps{{"ALSystem", "systemVersion", {}, 0, {}},
                         {"ALMotion", "getRobotConfig", {}, 0, [this](const Result& result) {
                            for (const Value& list : result.value.Items()) {
                              for (const Value& item : list.Items()) {
                                pepper_ |= item.Text() == "juliette" || item.Text() == "pepper";
                              }
                            }
                          }}};
  for (size_t j = 0; j < kNumJoints; ++j) {
    const JointLimit& limit = LimitOf(static_cast<int>(j));
    limits_[j] = {limit.low, limit.high};
    steps.push_back({"ALMotion", "getLimits", {std::string(limit.name)}, 0, [this, j](const Result& result) {
                       TakeLimits(j, result);
                     }});
  }
  steps.push_back({"ALTextToSpeech", "getAvailableLanguages", {}, 0, [this](const Result& result) {
                     for (const Value& language : result.value.Items()) languages_.insert(language.Text());
                   }});
  steps.push_back({"ALBattery", "getBatteryCharge", {}, 0, [this](const Result& result) {
                     if (result.ok) battery_ = result.value.Number() / 100;
                   }});
  return steps;
}

std::deque<NaoRobot::Step> NaoRobot::Quieting() {
  std::deque<Step> steps{{"ALAutonomousLife", "setState", {"disabled"}, kAutonomyTime, {}}};
  for (const char* ability : {"BasicAwareness", "BackgroundMovement", "ListeningMovement", "SpeakingMovement"}) {
    steps.push_back({"ALAutonomousLife", "setAutonomousAbilityEnabled", {ability, false}, 0, {}});
  }
  steps.push_back({"ALMotion", "setBreathEnabled", {"Body", false}, 0, {}});
  steps.push_back({"ALMotion", "setIdlePostureEnabled", {"Body", false}, 0, {}});
  steps.push_back({"ALMotion", "setCollisionProtectionEnabled", {"Arms", true}, 0, {}});
  steps.push_back({"ALAnimatedSpeech", "setBodyLanguageModeFromStr", {"disabled"}, 0, {}});
  return steps;
}

std::deque<NaoRobot::Step> NaoRobot::Seating() {
  return {{"ALRobotPosture", "getPosture", {}, 0, [this](const Result& result) { TakePosture(result); }}};
}

void NaoRobot::TakePosture(const Result& result) {
  seated_ = result.ok && Seated(result.value.Text());
  // Put before the steps that follow, in reverse.
  const Step stiff{"ALMotion", "setStiffnesses", {List{"Head", "LArm", "RArm"}, 1.0}, 0, {}};
  if (pepper_) return;
  if (seated_) {
    steps_.push_front(stiff);
    return;
  }
  steps_.push_front({"ALRobotPosture", "getPosture", {}, 0, [this, stiff](const Result& after) {
                       seated_ = after.ok && Seated(after.value.Text());
                       if (seated_) steps_.push_front(stiff);
                     }});
  steps_.push_front({"ALRobotPosture", "goToPosture", {"Sit", 0.5}, kSeatingTime, {}});
}

std::deque<NaoRobot::Step> NaoRobot::Finishing() {
  const auto touched = [this](const Value& value) {
    if (value.Number() > 0.5) events_.push_back({BackEndEvent::Kind::kHelpTouched, 0, ""});
  };
  return {{"ALTextToSpeech", "setVolume", {1.0}, 0, [this, touched](const Result&) {
             SetVolume(volume_);
             for (const char* event : {"FrontTactilTouched", "MiddleTactilTouched", "RearTactilTouched"}) {
               session_.Listen(event, touched, [](const Result&) {});
             }
           }}};
}

void NaoRobot::Begin() {
  generation_ = session_.generation();
  stage_ = Stage::kPreparing;
  languages_.clear();
  set_language_.clear();
  measured_.reset();
  speech_.reset();
  chunks_.reset();
  held_back_.clear();
  seated_ = pepper_ = resting_ = asking_angles_ = false;
  next_battery_ = next_angles_ = moving_until_ = 0;
  steps_ = Inquiries();
  for (const auto& more : {Quieting(), Seating(), Finishing()}) steps_.insert(steps_.end(), more.begin(), more.end());
  prepared_ = false;
  RunSteps(generation_);
}

void NaoRobot::RunSteps(int64_t generation) {
  if (generation != generation_ || stage_ == Stage::kAway) return;
  if (steps_.empty()) {
    prepared_ = true;
    stage_ = Stage::kReady;
    for (const JointPath& path : std::exchange(held_back_, {})) Move(path);
    return;
  }
  const Step step = steps_.front();
  steps_.pop_front();
  // What fails here (a service this robot lacks, a call that hangs) must not keep the rest from being tried.
  session_.Call(
      step.service, step.method, step.arguments,
      [this, generation, then = step.then](const Result& result) {
        if (generation != generation_) return;
        if (then) then(result);
        RunSteps(generation);
      },
      static_cast<int64_t>(step.timeout_s * 1e6));
}

void NaoRobot::TakeLimits(size_t joint, const Result& result) {
  if (!result.ok || result.value.Items().empty()) return;
  const List& row = result.value.Items()[0].Items();  // min, max, speed, torque
  if (row.size() < 2 || row[0].Number() >= row[1].Number()) return;
  limits_[joint].first = std::max(limits_[joint].first, row[0].Number());
  limits_[joint].second = std::min(limits_[joint].second, row[1].Number());
}

BackEndState NaoRobot::State() const {
  BackEndState state;
  state.connected = stage_ != Stage::kAway && prepared_;
  state.battery = battery_;
  if (stage_ == Stage::kAway) {
    state.detail = session_.problem().empty() ? "connecting to " + options_.url : session_.problem();
  } else if (!state.connected) {
    state.detail = "the robot is being prepared";
  } else if (pepper_) {
    state.detail = "a Pepper: it speaks, but does not point";
  } else if (!seated_ && !resting_) {
    state.detail = "the robot does not sit: it speaks, but does not move";
  }
  return state;
}

std::vector<BackEndEvent> NaoRobot::Poll(int64_t now) {
  now_ = now;
  session_.Poll(now);
  if (!session_.connected()) {
    stage_ = Stage::kAway;
    battery_ = -1;
    measured_.reset();
  } else if (session_.generation() != generation_) {
    Begin();
  }
  PlayRendered(now);
  if (stage_ == Stage::kReady) Watch(now);
  return std::exchange(events_, {});
}

void NaoRobot::Watch(int64_t now) {
  if (now >= next_battery_) {
    next_battery_ = now + kBatteryPeriod;
    session_.Call("ALBattery", "getBatteryCharge", {}, [this](const Result& result) {
      if (result.ok) battery_ = result.value.Number() / 100;
    });
  }
  if (!seated_ || resting_ || asking_angles_ || now < next_angles_ || now < moving_until_) return;
  next_angles_ = now + kAnglesPeriod;
  asking_angles_ = true;
  session_.Call("ALMotion", "getAngles", {AllJointNames(), true}, [this](const Result& result) {
    asking_angles_ = false;
    const List& values = result.value.Items();
    if (!result.ok || values.size() != kNumJoints || now_ < moving_until_) return;
    JointAngles angles{};
    for (size_t j = 0; j < angles.size(); ++j) angles[j] = values[j].Number();
    measured_ = ClampToLimits(angles);
  });
}

void NaoRobot::Say(const SpeechOrder& speech) {
  speech_ = speech;
  chunks_.reset();
  speech_end_ = 0;
  const std::string language = RobotsLanguage(speech.language);
  if (renderer_.HasRecording(speech)) {
    renderer_.Order(speech);
  } else if (!language.empty() && languages_.contains(language)) {
    SayItself(speech, language);
  } else if (renderer_.CanSay(speech)) {
    renderer_.Order(speech);
  } else {
    EndSpeech(speech.id, "no voice for the language '" + speech.language + "'");
  }
}

void NaoRobot::SayItself(const SpeechOrder& speech, const std::string& robots_language) {
  const auto say = [this, speech] {
    // The robot answers when it has said it: the conductor knows how long that may take at most.
    session_.Call(
        "ALTextToSpeech", "say", {speech.text},
        [this, id = speech.id](const Result& result) { EndSpeech(id, result.error); }, 120000000);
  };
  if (set_language_ == robots_language) {
    say();
    return;
  }
  session_.Call("ALTextToSpeech", "setLanguage", {robots_language},
                [this, speech, say, robots_language](const Result& result) {
                  if (!speech_ || speech_->id != speech.id) return;
                  if (result.ok) {
                    set_language_ = robots_language;
                    say();
                  } else if (renderer_.CanSay(speech)) {
                    renderer_.Order(speech);
                  } else {
                    EndSpeech(speech.id, "language '" + speech.language + "': " + result.error);
                  }
                });
}

void NaoRobot::EndSpeech(int64_t id, const std::string& error) {
  if (!speech_ || speech_->id != id) return;
  speech_.reset();
  chunks_.reset();
  const auto kind = error.empty() ? BackEndEvent::Kind::kSpeechDone : BackEndEvent::Kind::kSpeechFailed;
  events_.push_back({kind, id, error});
}

void NaoRobot::PlayRendered(int64_t now) {
  for (const RenderedSpeech& rendered : renderer_.Take()) {
    if (!speech_ || speech_->id != rendered.id || stage_ == Stage::kAway) continue;
    if (!rendered.error.empty()) {
      EndSpeech(rendered.id, rendered.error);
      continue;
    }
    speech_end_ = now + static_cast<int64_t>((rendered.seconds() + 0.3) * 1e6);
    chunks_ = ChunksOf(rendered);
    std::reverse(chunks_->begin(), chunks_->end());
    session_.Call("ALAudioDevice", "setParameter", {"outputSampleRate", rendered.sample_rate},
                  [this, id = rendered.id](const Result&) { PlayNextChunk(id); });
  }
  if (speech_ && chunks_ && chunks_->empty() && now >= speech_end_) EndSpeech(speech_->id, "");
}

void NaoRobot::PlayNextChunk(int64_t id) {
  if (!speech_ || speech_->id != id || !chunks_ || chunks_->empty()) return;
  const Value chunk = std::move(chunks_->back());
  chunks_->pop_back();
  const auto frames = static_cast<int64_t>(chunk.Text().size() / 4);
  session_.Call("ALAudioDevice", "sendRemoteBufferToOutput", {frames, chunk}, [this, id](const Result& result) {
    if (result.ok) {
      PlayNextChunk(id);
    } else {
      EndSpeech(id, "the robot's loudspeaker: " + result.error);
    }
  });
}

void NaoRobot::Silence() {
  const bool streamed = chunks_.has_value();
  speech_.reset();
  chunks_.reset();
  Tell("ALTextToSpeech", "stopAll", {});
  if (streamed) Tell("ALAudioDevice", "flushAudioOutputs", {});
}

void NaoRobot::Move(const JointPath& path) {
  if (stage_ == Stage::kPreparing) {
    held_back_.push_back(path);
    return;
  }
  if (stage_ != Stage::kReady || !seated_ || resting_ || path.points.size() < 2) return;
  List names, angles, times;
  const size_t stride = (path.points.size() - 2) / kMostPoints + 1;
  for (size_t j = 0; j < kNumJoints; ++j) {
    if (!path.moves[j]) continue;
    names.emplace_back(std::string(LimitOf(static_cast<int>(j)).name));
    List joint_angles, joint_times;
    for (size_t p = path.points.size() - 1; p >= 1; p -= std::min(stride, p)) {  // the last point always
      joint_angles.emplace_back(std::clamp(path.points[p].angles[j], limits_[j].first, limits_[j].second));
      joint_times.emplace_back(path.points[p].time);
    }
    std::reverse(joint_angles.begin(), joint_angles.end());
    std::reverse(joint_times.begin(), joint_times.end());
    angles.emplace_back(std::move(joint_angles));
    times.emplace_back(std::move(joint_times));
  }
  if (names.empty()) return;
  if (now_ < moving_until_) Tell("ALMotion", "killTasksUsingResources", {names});
  measured_.reset();
  moving_until_ = std::max(moving_until_, now_ + static_cast<int64_t>((path.duration() + 0.3) * 1e6));
  Tell("ALMotion", "angleInterpolation", {names, angles, times, true}, path.duration() + options_.call_timeout_s);
}

void NaoRobot::Freeze() {
  held_back_.clear();
  if (stage_ == Stage::kAway) return;
  Tell("ALMotion", "killTasksUsingResources", {AllJointNames()});
  moving_until_ = now_ + 200000;
  measured_.reset();
}

void NaoRobot::SetEyes(const EyeColour& colour) {
  const int64_t rgb = int64_t{colour.red} << 16 | int64_t{colour.green} << 8 | int64_t{colour.blue};
  Tell("ALLeds", "fadeRGB", {"FaceLeds", rgb, 0.3});
}

void NaoRobot::Rest() {
  resting_ = true;
  held_back_.clear();
  measured_.reset();
  Tell("ALMotion", "rest", {}, kSeatingTime);
}

void NaoRobot::Wake() {
  if (!resting_ || stage_ == Stage::kAway) return;
  resting_ = false;
  if (stage_ == Stage::kPreparing) return;
  stage_ = Stage::kPreparing;
  steps_ = Seating();
  RunSteps(generation_);
}

void NaoRobot::SetVolume(double volume) {
  volume_ = std::clamp(volume, 0.0, options_.largest_volume);
  Tell("ALAudioDevice", "setOutputVolume", {static_cast<int64_t>(100 * volume_ + 0.5)});
}

}  // namespace coach
