#include "tools/report/timeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "tools/report/numbers.h"
#include "tools/report/svg.h"

namespace coach {
namespace {

constexpr double kWidth = 1080, kLeft = 150, kRight = 12;
constexpr double kLane = 26, kThin = 11, kGap = 6;
constexpr int64_t kAfter = 8000000;       // us shown after the end, for the last words
constexpr int64_t kUnknownEnd = 1500000;  // us drawn of a sentence whose end was not recorded

class Drawing {
 public:
  Drawing(const Trial& trial, const Session& session)
      : trial_(trial), session_(session), names_(NamesOf(session, trial.span.task)), begin_(trial.span.begin) {
    end_ = std::max(trial.span.end, trial.until);
    if (trial.span.completed) end_ = std::max(end_, std::min(session.end, end_ + kAfter));
    if (end_ <= begin_) end_ = begin_ + 1000000;
  }

  std::string Svg() {
    y_ = 24;
    Phases();
    Connections();
    Mistakes();
    Robot();
    Operator();
    Parts();
    const std::string axis = Axis();
    return svg::Picture(kWidth, y_ + 4, "Timeline of trial " + std::to_string(trial_.number), axis + out_);
  }

 private:
  double X(int64_t utime) const {
    const double share = static_cast<double>(utime - begin_) / static_cast<double>(end_ - begin_);
    return kLeft + std::clamp(share, 0.0, 1.0) * (kWidth - kLeft - kRight);
  }
  bool Shown(int64_t utime) const { return utime >= begin_ && utime <= end_; }
  std::string At(int64_t utime) const { return Clock(static_cast<double>(utime - begin_) / 1e6, true); }

  std::string PartName(int part) const {
    if (part < 0) return "";
    if (names_ && part < static_cast<int>(names_->parts.size())) return names_->parts[static_cast<size_t>(part)];
    return "part " + std::to_string(part + 1);
  }
  std::string Parts(int a, int b) const {
    if (a < 0 && b < 0) return "";
    return " (" + PartName(a) + (a >= 0 && b >= 0 ? ", " : "") + PartName(b) + ")";
  }

  void Label(const std::string& text, double height, const char* style = "label") {
    out_ += svg::Text(kLeft - 8, y_ + height / 2 + 4, svg::Shortened(text, 22), style);
  }
  void Ground(double height) { out_ += svg::Rect(kLeft, y_, kWidth - kLeft - kRight, height, "ground"); }
  void Next(double height, double gap = kGap) { y_ += height + gap; }

  std::string Axis() const {
    std::string marks;
    const double seconds = static_cast<double>(end_ - begin_) / 1e6;
    const double step = svg::RoundTimeStep(seconds, 14);
    for (double t = 0; t <= seconds + 1e-9; t += step) {
      const double x = X(begin_ + static_cast<int64_t>(t * 1e6));
      marks += svg::Line(x, 18, x, y_, "grid") + svg::Text(x, 13, Clock(t), "tick");
    }
    if (trial_.span.completed) marks += svg::Line(X(trial_.span.end), 18, X(trial_.span.end), y_, "finish");
    return marks;
  }

  void Phases() {
    static const std::map<std::string, std::string> titles{{"introduction", "introduction"},
                                                           {"announce", "next step"},
                                                           {"wait", "the child builds"},
                                                           {"correct", "well done"},
                                                           {"wrong", "a mistake"},
                                                           {"idle", "hints"},
                                                           {"away", "nobody builds"},
                                                           {"tracking_lost", "parts hard to see"},
                                                           {"paused", "paused"},
                                                           {"complete", "complete"}};
    Label("phase", kThin);
    int64_t from = begin_;
    std::string phase = "introduction";
    const auto close = [&](int64_t until) {
      const auto title = titles.find(phase);
      if (until > from && title != titles.end())
        out_ += svg::Rect(X(from), y_, X(until) - X(from), kThin, "phase-" + phase,
                          At(from) + " – " + At(until) + " " + title->second);
      from = until;
    };
    for (const GuidanceEvent& e : trial_.events) {
      if (e.kind != "phase") continue;
      close(std::max(e.utime, from));
      phase = e.subject;
    }
    close(end_);
    Next(kThin);
  }

  /// Connections in the task's order, then those that only occur.
  std::vector<std::string> ConnectionNames() const {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    std::set<int> required;
    for (const AssemblyState& s : session_.states) {
      if (!Shown(s.utime)) continue;
      for (const ConnectionState& c : s.connections) required.insert(c.connection);
    }
    for (size_t i = 0; names_ && i < names_->connections.size(); ++i) {
      if (required.empty() || required.contains(static_cast<int>(i))) add(names_->connections[i]);
    }
    for (const DetectedEvent& d : trial_.detected) {
      if (d.event.kind == "connect") add(d.event.subject);
    }
    for (const TrueEvent& t : trial_.truth) {
      if (t.annotation.kind == "connect") add(t.annotation.subject);
    }
    return names;
  }

  void Connections() {
    for (const std::string& name : ConnectionNames()) {
      Label(name, kLane);
      Ground(kLane);
      Probability(name);
      Events(name, false);
      Next(kLane, 3);
    }
    Next(0);
  }

  void Probability(const std::string& name) {
    if (!names_) return;
    const auto index =
        std::find(names_->connections.begin(), names_->connections.end(), name) - names_->connections.begin();
    std::vector<std::pair<double, double>> points;
    double last_x = -1, last_y = y_ + kLane;
    for (const AssemblyState& s : session_.states) {
      if (!Shown(s.utime) || s.utime > trial_.span.end) continue;
      for (const ConnectionState& c : s.connections) {
        if (c.connection != index) continue;
        const double x = X(s.utime), y = y_ + kLane * (1 - std::clamp(c.probability, 0.0, 1.0));
        if (points.empty()) points.emplace_back(x, y_ + kLane);
        if (std::abs(y - last_y) < 0.3 && x - last_x < 40) continue;  // nothing new to see
        points.emplace_back(x, last_y);
        points.emplace_back(x, y);
        last_x = x;
        last_y = y;
      }
    }
    if (points.empty()) return;
    const double end = X(trial_.span.end);
    points.emplace_back(end, last_y);
    points.emplace_back(end, y_ + kLane);
    out_ += svg::Path(points, true, "probability");
  }

  /// True and announced moments on the present lane.
  void Events(const std::string& name, bool wrong) {
    const double middle = y_ + kLane / 2;
    for (const DetectedEvent& d : trial_.detected) {
      const GuidanceEvent& e = d.event;
      if (e.subject != name || (e.kind == "connect") == wrong || (e.kind == "disconnect" && IsWrong(name) != wrong))
        continue;
      const bool undone = e.kind == "disconnect", false_alarm = trial_.annotated && !d.truth;
      out_ += svg::Line(X(e.since), middle, X(e.utime), middle, "dated");
      const std::string title = At(e.utime) + " announced: " + e.kind + " " + e.subject + Parts(e.part_a, e.part_b) +
                                ", dated " + At(e.since) + ", p " + Fixed(e.probability, 2) +
                                (false_alarm ? ", not noted by the observer" : "");
      out_ += undone ? svg::Rect(X(e.utime) - 4.5, middle - 4.5, 9, 9, false_alarm ? "false" : "undone", title)
                     : svg::Circle(X(e.utime), middle, 5.5,
                                   false_alarm ? "false"
                                   : wrong     ? "mistake"
                                               : "made",
                                   title);
    }
    for (const TrueEvent& t : trial_.truth) {
      if (LaneOf(t) != name || (t.annotation.kind == "connect") == wrong) continue;
      if (t.annotation.kind == "disconnect" && IsWrong(name) != wrong) continue;
      const double x = X(t.annotation.utime);
      out_ += svg::Path({{x, middle - 11}, {x + 5, middle - 4}, {x, middle + 3}, {x - 5, middle - 4}}, true,
                        t.detected ? "truth" : "missed",
                        At(t.annotation.utime) + " in truth: " + t.annotation.kind + " " + t.annotation.subject +
                            (t.detected ? ", announced " + Fixed(t.delay, 1) + " s later" : ", never announced"));
    }
  }

  /// Where it was detected, which for equal parts may be under another name.
  std::string LaneOf(const TrueEvent& t) const {
    return t.detected ? trial_.detected[*t.detected].event.subject : t.annotation.subject;
  }
  bool IsWrong(const std::string& name) const {
    for (const DetectedEvent& d : trial_.detected) {
      if (d.event.kind == "wrong" && d.event.subject == name) return true;
    }
    for (const TrueEvent& t : trial_.truth) {
      if (t.annotation.kind == "wrong" && t.annotation.subject == name) return true;
    }
    return false;
  }

  void Mistakes() {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const DetectedEvent& d : trial_.detected) {
      if (d.event.kind == "wrong") add(d.event.subject);
    }
    for (const TrueEvent& t : trial_.truth) {
      if (t.annotation.kind == "wrong") add(LaneOf(t));
    }
    for (const std::string& name : names) {
      Label(name, kLane, "label wrong");
      Ground(kLane);
      Events(name, true);
      Next(kLane, 3);
    }
    if (!names.empty()) Next(0);
  }

  static std::string SpeechStyle(const std::string& key, Priority priority) {
    if (key.starts_with("wrong") || key == "hedge" || key == "repair" || priority == Priority::kCorrective)
      return "say-corrective";
    if (key == "praise" || key == "complete" || priority == Priority::kCongratulatory) return "say-praise";
    if (key.starts_with("idle") || key == "lost" || priority == Priority::kReminder) return "say-hint";
    if (key == "operator" || priority == Priority::kOperator) return "say-operator";
    return "say-explain";
  }

  void Sentence(int64_t from, int64_t until, const std::string& style, const std::string& text,
                const std::string& title) {
    const double x = X(from), width = std::max(2.0, X(until) - x);
    out_ += svg::Rect(x, y_ + 2, width, kLane - 4, style, title);
    const auto room = static_cast<size_t>(std::max(0.0, (width - 8) / 5.2));
    if (room >= 6) out_ += svg::Text(x + 4, y_ + kLane / 2 + 3.5, svg::Shortened(text, room), "words");
  }

  void Robot() {
    Label("robot says", kLane);
    Ground(kLane);
    const double gesture_y = y_ + kLane + 3;
    std::string gestures;
    bool acts = false;
    for (const RobotAct& act : session_.acts) {
      if (act.command.kind != ActKind::kAct || !Shown(act.sent)) continue;
      acts = true;
      const int64_t from = act.started != 0 ? act.started : act.sent;
      const int64_t until = act.ended != 0 && act.started != 0 ? act.ended : from + kUnknownEnd;
      const bool done = act.state == ActState::kDone || act.state == ActState::kStarted;
      std::string title =
          At(from) + " " + act.command.text + " [" + act.command.phrase_key + ", " + ToString(act.state);
      if (!act.reason.empty()) title += ": " + act.reason;
      title += "]";
      if (!act.command.text.empty())
        Sentence(from, until, SpeechStyle(act.command.phrase_key, act.command.priority) + (done ? "" : " broken"),
                 act.command.text, title);
      if (act.command.look_target)
        gestures += svg::Rect(X(from), gesture_y, std::max(2.0, X(until) - X(from)), 5, "look",
                              At(from) + " looks" + (act.gaze_clamped ? ", not far enough" : ""));
      if (act.command.point_target)
        gestures += svg::Rect(X(from), gesture_y + 6, std::max(2.0, X(until) - X(from)), 5,
                              act.point_clamped ? "point broken" : "point",
                              At(from) + " points" + (act.point_clamped ? ", not far enough" : ""));
    }
    for (const GuidanceEvent& e : trial_.events) {
      if (acts || e.kind != "say") continue;  // the event log alone knows no more
      Sentence(e.utime, e.utime + kUnknownEnd, SpeechStyle(e.subject, Priority::kExplanatory), e.reason,
               At(e.utime) + " " + e.reason);
    }
    Next(kLane, 3);
    if (!gestures.empty()) {
      Label("looks, points", kThin);
      Ground(kThin);
      out_ += gestures;
      Next(kThin);
    }
  }

  void Operator() {
    std::string marks;
    const double middle = y_ + kThin / 2;
    for (const GuidanceEvent& e : trial_.events) {
      if (e.kind == "operator")
        marks += svg::Path({{X(e.utime), middle - 5}, {X(e.utime) + 8, middle}, {X(e.utime), middle + 5}}, true,
                           "order", At(e.utime) + " operator: " + e.subject + (e.reason.empty() ? "" : " " + e.reason));
      if (e.kind == "repair")
        marks +=
            svg::Circle(X(e.utime), middle, 4.5, "false", At(e.utime) + " taken back: " + e.subject + " " + e.reason);
    }
    for (const Annotation& a : session_.annotations) {
      if (a.kind == "note" && Shown(a.utime))
        marks += svg::Rect(X(a.utime) - 3, middle - 5, 6, 10, "note", At(a.utime) + " " + a.annotator + ": " + a.value);
    }
    if (marks.empty()) return;
    Label("operator, notes", kThin);
    Ground(kThin);
    out_ += marks;
    Next(kThin);
  }

  void Parts() {
    constexpr std::array<const char*, 5> kStyles{"tracked", "occluded", "outside", "lost", "absent"};
    constexpr std::array<const char*, 5> kTitles{"tracked", "hidden", "out of view", "lost", "not seen yet"};
    size_t parts = 0;
    for (const TrackedFrame& f : session_.frames) {
      if (Shown(f.utime)) parts = std::max(parts, f.parts.size());
    }
    for (size_t p = 0; p < parts; ++p) {
      Label(PartName(static_cast<int>(p)), kThin);
      Ground(kThin);
      const TrackedFrame* first = nullptr;
      const auto close = [&](int64_t until) {
        if (!first) return;
        const auto status = static_cast<size_t>(first->parts[p].status);
        out_ += svg::Rect(X(first->utime), y_, X(until) - X(first->utime), kThin, kStyles[status],
                          At(first->utime) + " – " + At(until) + " " + kTitles[status]);
      };
      for (const TrackedFrame& f : session_.frames) {
        if (!Shown(f.utime) || p >= f.parts.size()) continue;
        if (first && first->parts[p].status == f.parts[p].status) continue;
        close(f.utime);
        first = &f;
      }
      close(std::min(end_, session_.frames.back().utime));
      Next(kThin, 3);
    }
  }

  const Trial& trial_;
  const Session& session_;
  const TaskNames* names_;
  int64_t begin_, end_ = 0;
  double y_ = 0;
  std::string out_;
};

}  // namespace

std::string TimelineSvg(const Trial& trial, const Session& session) { return Drawing(trial, session).Svg(); }

std::string TimelineLegend() {
  const auto sign = [](const std::string& shape, const std::string& meaning) {
    return "<span class=\"key\"><svg viewBox=\"0 0 16 16\" aria-hidden=\"true\">" + shape + "</svg>" + meaning +
           "</span>\n";
  };
  return "<p class=\"legend\">" + sign(svg::Path({{8, 1}, {13, 8}, {8, 15}, {3, 8}}, true, "truth"), "made in truth") +
         sign(svg::Path({{8, 1}, {13, 8}, {8, 15}, {3, 8}}, true, "missed"), "never announced") +
         sign(svg::Circle(8, 8, 5.5, "made"), "announced") +
         sign(svg::Circle(8, 8, 5.5, "mistake"), "mistake announced") +
         sign(svg::Rect(3, 3, 10, 10, "undone"), "undone") +
         sign(svg::Circle(8, 8, 5.5, "false"), "false alarm, taken back") +
         sign(svg::Path({{0, 16}, {0, 6}, {16, 6}, {16, 16}}, true, "probability"), "probability") +
         sign(svg::Rect(0, 2, 16, 12, "say-explain"), "explains") +
         sign(svg::Rect(0, 2, 16, 12, "say-praise"), "praises") +
         sign(svg::Rect(0, 2, 16, 12, "say-corrective"), "corrects") +
         sign(svg::Rect(0, 2, 16, 12, "say-hint"), "reminds") + sign(svg::Rect(0, 5, 16, 6, "look"), "looks") +
         sign(svg::Rect(0, 5, 16, 6, "point"), "points") + sign(svg::Rect(0, 4, 16, 8, "tracked"), "tracked") +
         sign(svg::Rect(0, 4, 16, 8, "occluded"), "hidden") + sign(svg::Rect(0, 4, 16, 8, "outside"), "out of view") +
         sign(svg::Rect(0, 4, 16, 8, "lost"), "lost") + "</p>\n";
}

}  // namespace coach
