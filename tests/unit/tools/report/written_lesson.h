// A lesson written message by message into a recording: one minute at a rectangle of four bricks, with a mistake, a
// late announcement, a false alarm, a restart, a part that is lost, and names that want to be HTML.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/messages.h"
#include "tools/log/log_file.h"

namespace coach {

class WrittenLesson {
 public:
  /// @param station prefix of the channels
  explicit WrittenLesson(const std::filesystem::path& file, std::string station = "CLASS")
      : writer_(file), station_(std::move(station)) {}

  static constexpr int64_t kStart = 1'700'000'000'000'000;  // us since 1970 of the recorder's clock
  static constexpr int64_t kOffset = 20'000;                // us that the recorder hears of a frame after its time

  template <Message M>
  void Write(double seconds, const M& message) {
    std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    WriteBytes(seconds, kChannel<M>, bytes);
  }
  void WriteBytes(double seconds, const std::string& channel, const std::vector<uint8_t>& bytes) {
    writer_.Write(At(seconds) + kOffset, station_ + "/" + channel, bytes);
  }
  static int64_t At(double seconds) { return kStart + static_cast<int64_t>(seconds * 1e6 + 0.5); }

  void Frame(double t, PartStatus third = PartStatus::kTracked) {
    PartPoses poses;
    poses.utime = poses.received_utime = At(t);
    poses.sequence = static_cast<int64_t>(t * 2);
    poses.table_found = true;
    poses.parts.resize(4);
    for (PartEstimate& part : poses.parts) {
      part.status = PartStatus::kTracked;
      part.visible_fraction = 0.9;
      part.confidence = 0.9;
    }
    poses.parts[2].status = third;
    poses.parts[2].visible_fraction = third == PartStatus::kTracked ? 0.8 : 0.1;
    Write(t, ToMessage(poses));
  }

  void Names() {
    task_t task;
    task.name = "rectangle_<b>test</b>";
    task.sha256 = "0123456789abcdef0123456789abcdef";
    task.types = {"long", "medium"};
    task.colours = {"blue", "green"};
    task.parts = {"long_1", "long_2", "medium_1", "medium_2"};
    task.part_types = {0, 0, 1, 1};
    task.connections = {"corner_1", "corner_2", "corner_3", "corner_4"};
    task.mistakes = {"medium_on_medium"};
    task.num_types = 2;
    task.num_parts = task.num_connections = 4;
    task.num_mistakes = 1;
    Write(0, task);
  }

  void Event(double t, double since, const std::string& kind, const std::string& subject,
             const std::string& reason = "", int a = -1, int b = -1, double probability = 0) {
    GuidanceEvent e;
    e.id = ++event_;
    e.utime = At(t);
    e.since = At(since);
    e.kind = kind;
    e.subject = subject;
    e.part_a = a;
    e.part_b = b;
    e.probability = probability;
    e.reason = reason;
    Write(t, ToMessage(e));
  }

  void State(double t, const std::vector<double>& probabilities) {
    AssemblyState state;
    state.utime = At(t);
    state.session = 7;
    state.task = "rectangle_<b>test</b>";
    state.required = 4;
    for (size_t i = 0; i < probabilities.size(); ++i) {
      ConnectionState c;
      c.connection = static_cast<int>(i);
      c.probability = probabilities[i];
      c.part_a = i < 2 ? 0 : 1;
      c.part_b = i % 2 == 0 ? 2 : 3;
      state.connections.push_back(c);
    }
    Write(t, ToMessage(state));
  }

  void Say(double t, double until, const std::string& key, const std::string& text, bool point = false) {
    Event(t, t, "say", key, text);
    RobotCommand command;
    command.id = ++command_;
    command.station = station_;
    command.session = 7;
    command.text = text;
    command.phrase_key = key;
    if (point) command.point_target = command.look_target = Vector3(0.1, 0, 0);
    command.valid_for_us = 4'000'000;
    Write(t, ToMessage(command));
    Status(t + 0.2, ActState::kStarted);
    if (until > t) Status(until, ActState::kDone);
  }
  void Status(double t, ActState state, bool connected = true) {
    RobotStatus status;
    status.utime = 123;  // the robot's clock is its own
    status.station = station_;
    status.session = 7;
    status.command_id = command_;
    status.state = state;
    status.connected = connected;
    status.back_end = "virtual";
    Write(t, ToMessage(status));
  }

  void Health(double t, const std::string& service, int pid, float latency, int state = service_health_t::OK,
              const std::string& message = "") {
    service_health_t m{};
    m.utime = At(t);
    m.station = station_;
    m.service = service;
    m.host = "tablet";
    m.pid = pid;
    m.state = static_cast<int8_t>(state);
    m.message = message;
    m.latency_p50_ms = latency;
    m.latency_p99_ms = 2 * latency;
    m.received = m.answered = static_cast<int64_t>(10 * t);
    m.dropped = t > 30 ? 3 : 0;
    Write(t, m);
  }

  void Note(double t, const std::string& kind, const std::string& subject, const std::string& value = "",
            int64_t id = 0, int64_t replaces = 0) {
    annotation_t a;
    a.utime = At(t);
    a.id = id != 0 ? id : ++annotation_;
    a.annotator = "Μαρία & co";
    a.kind = kind;
    a.subject = subject;
    a.value = value;
    a.replaces_id = replaces;
    Write(t, a);
  }

  void Configuration(double t, const std::string& service) {
    Write(t, config_t{service, "0.1.0", "fedcba9876543210", "station: CLASS\nnote: \"<script>alert(1)</script>\"\n"});
  }

  /// Sixty seconds of it.
  void Play() {
    Names();
    Configuration(0.1, "pose-filter");
    Configuration(0.1, "assembly-reasoner");
    for (int k = 0; k < 120; ++k) {
      const double t = 0.5 * k;
      Frame(t, t >= 20 && t < 23   ? PartStatus::kLost
               : t >= 30 && t < 35 ? PartStatus::kOccluded
                                   : PartStatus::kTracked);
      if (k % 4 == 0) {
        const auto p = [&](double made) { return t >= made ? 0.97 : 0.05; };
        State(t, {p(12.4), p(26.5), t < 30 ? 0.05 : p(38.9), p(52)});
        Health(t, "pose-filter", t < 40 ? 100 : 200, 15 + static_cast<float>(k % 3));
        Health(t, "assembly-reasoner", 101, 18, t >= 44 && t < 48 ? service_health_t::DEGRADED : service_health_t::OK,
               t >= 44 && t < 48 ? "the disk <is> full" : "");
      }
      Moments(t);
    }
  }

 private:
  /// What happens at full and half seconds.
  void Moments(double t) {
    const auto at = [&](double moment) { return t == moment; };
    if (at(2)) Event(2, 2, "operator", "start");
    if (at(2)) Event(2, 2, "phase", "introduction", "the task begins");
    if (at(2.5)) Say(2.5, 6, "introduction", "Hello, builder! Let's put the pieces together.");
    if (at(7)) Event(7, 7, "phase", "announce", "the next step");
    if (at(7.5)) Say(7.5, 11, "step", "Please take the blue brick & join it.", true);
    if (at(12)) Note(12.1, "connect", "corner_2");  // the observer's name for an equal corner
    if (at(12.5)) Event(12.5, 12.2, "connect", "corner_1", "", 0, 2, 0.97);
    if (at(13)) Event(13, 13, "phase", "correct", "made");
    if (at(13)) Say(13, 15, "praise", "Well done!");
    if (at(18)) Note(18, "wrong", "medium_on_medium");
    if (at(20.5)) Event(20.5, 18.6, "wrong", "medium_on_medium", "", 2, 3, 0.9);
    if (at(21)) Event(21, 21, "phase", "wrong", "a mistake");
    if (at(21.5)) Say(21.5, 24.5, "wrong", "Hm, these two don't go together like this.", true);
    if (at(24)) Note(24, "disconnect", "medium_on_medium");
    if (at(24.5)) Event(24.5, 24.1, "disconnect", "medium_on_medium", "", 2, 3, 0.9);
    if (at(26)) Note(26, "connect", "corner_1");
    if (at(26.5)) Event(26.5, 26.1, "connect", "corner_2", "", 0, 3, 0.96);
    if (at(28)) Event(28, 27, "connect", "corner_3", "", 1, 2, 0.9);  // it is not
    if (at(29)) Event(29, 28.6, "disconnect", "corner_3", "", 1, 2, 0.9);
    if (at(32)) Note(32, "connect", "corner_3");  // under the hand until 35 s
    if (at(35.5)) Event(35.5, 34, "connect", "corner_3", "", 1, 2, 0.93);
    if (at(40)) Note(40.2, "note", "", "the <child> laughs");
    if (at(42)) Event(42, 42, "operator", "say", "Take your time");
    if (at(45)) Status(45, ActState::kDone, false);
    if (at(48)) Status(48, ActState::kDone, true);
    if (at(50)) Note(50, "connect", "corner_4", "", 900);
    if (at(51)) Note(51.4, "connect", "corner_4", "", 901, 900);
    if (at(52)) Event(52, 51.5, "connect", "corner_4", "", 1, 3, 0.99);
    if (at(52)) Event(52, 52, "phase", "complete", "all is made");
    if (at(52.5)) Say(52.5, 55, "complete", "Look at what you have built!");
    if (at(56)) Note(56, "questionnaire", "0", "5 c1");
    if (at(56)) Note(56.1, "questionnaire", "1", "3 c1");
  }

  LogWriter writer_;
  std::string station_;
  int64_t event_ = 0, command_ = 0, annotation_ = 0;
};

}  // namespace coach
