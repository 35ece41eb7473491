#include "tools/study/guidance_study.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/lesson.h"
#include "services/assembly_reasoner/lesson_configuration.h"
#include "tools/simulator/live_lesson.h"
#include "tools/study/report_text.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr double kFps = 15, kLimit = 300;  // Hz; s, after which a lesson ends unfinished
constexpr double kNoise = 0.0007;          // m, of a pose; 0.6 degrees a millimetre
constexpr double kNear = 0.03;             // m, between bounding spheres of parts that make a pair
constexpr double kCharactersASecond = 14;  // of the robot
const char* const kTempers[] = {"listens", "errs", "never-listens"};

/// What a tracker says of the true poses at a time.
class NoisyTracker {
 public:
  NoisyTracker(const Task& task, uint64_t seed) : task_(task), random_(seed) {
    for (size_t i = 0; i < task.parts.size(); ++i) {
      double reach = 0;
      for (const Vector3& v : task.TypeOf(static_cast<int>(i)).mesh.vertices) reach = std::max(reach, v.norm());
      reach_.push_back(reach);
    }
  }

  PartPoses Look(const ThingTracks& things, double time) {
    PartPoses poses;
    poses.utime = static_cast<int64_t>(1e6 * time) + 1;
    poses.table_found = true;
    const int n = static_cast<int>(task_.parts.size());
    for (int i = 0; i < n; ++i) {
      const Pose X = things.At(i, time);
      PartEstimate part;
      part.X_TP = Perturb(X, Shake());
      part.velocity.head<3>() = kFps * (X.translation() - things.At(i, time - 1 / kFps).translation());
      part.covariance = Covariance();
      part.visible_fraction = 0.8;
      part.status = PartStatus::kTracked;
      part.confidence = 1;
      poses.parts.push_back(part);
    }
    for (int a = 0; a < n; ++a) {
      for (int b = a + 1; b < n; ++b) AddPair(things, time, a, b, &poses);
    }
    return poses;
  }

 private:
  void AddPair(const ThingTracks& things, double time, int a, int b, PartPoses* poses) {
    const Pose X_WA = things.At(a, time), X_WB = things.At(b, time);
    const double apart = (X_WA.translation() - X_WB.translation()).norm();
    if (apart > reach_[static_cast<size_t>(a)] + reach_[static_cast<size_t>(b)] + kNear) return;
    PairEvidence pair;
    pair.part_a = a;
    pair.part_b = b;
    pair.X_AB = Perturb(X_WA.inverse() * X_WB, Shake());
    pair.covariance = Covariance();
    pair.visible_fraction = {0.8, 0.8};
    poses->pairs.push_back(pair);
  }
  Vector6 Shake() {
    Vector6 xi;
    for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? kNoise : kTurn) * random_.Normal();
    return xi;
  }
  static Matrix6 Covariance() {
    Vector6 variance;
    variance << Vector3::Constant(kNoise * kNoise), Vector3::Constant(kTurn * kTurn);
    return variance.asDiagonal();
  }

  static constexpr double kTurn = 0.6 * M_PI / 180 * 1000 * kNoise;  // rad
  const Task& task_;
  Random random_;
  std::vector<double> reach_;  // m, by part
};

/// A robot that says one thing after the other and reports each.
class Speaker {
 public:
  void Say(const RobotCommand& command, double now) {
    if (command.kind != ActKind::kAct) return;
    command_ = command;
    until_ = now + 0.5 + CountCharacters(command.text) / kCharactersASecond;
    ++said_;
  }
  /// What was said to the end just now.
  std::optional<RobotCommand> Finished(double now) {
    if (!command_ || now < until_) return std::nullopt;
    return std::exchange(command_, std::nullopt);
  }
  int said() const { return said_; }

 private:
  std::optional<RobotCommand> command_;
  double until_ = 0;
  int said_ = 0;
};

/// One child, once.
Json Build(const Task& task, const std::string& temper, bool guided, int number) {
  ScenarioOptions scenario;
  scenario.name = "ready";
  scenario.seed = static_cast<uint64_t>(3000 + number);
  LiveLesson child(MakeScenario(task, scenario), {.temper = TemperByName(temper)});
  NoisyTracker tracker(task, scenario.seed);
  LessonOptions lesson_options;
  lesson_options.start_by_itself = true;
  Lesson lesson({task}, LoadPhraseBooks(ShippedPhrases()), lesson_options, "STUDY");
  Speaker robot;
  double now = 0;
  for (int frame = 1; now < kLimit && !child.complete(); ++frame) {
    now = frame / kFps;
    if (const auto said = robot.Finished(now)) {
      RobotStatus status;
      status.session = lesson.session();
      status.command_id = said->id;
      status.state = ActState::kDone;
      lesson.Handle(status);
    }
    child.Advance(now);
    if (!guided) continue;
    const LessonOutput out = lesson.Step(tracker.Look(child.performance().things, now));
    for (const RobotCommand& command : out.commands) {
      robot.Say(command, now);
      child.Hear(command.phrase_key, out.state.step);
    }
  }
  int mistakes = 0;
  double end = 0;
  for (const TrueEvent& e : child.performance().events) {
    mistakes += e.kind == "wrong_connect" && e.time < kLimit;
    if (e.kind == "connect") end = std::max(end, e.time);
  }
  const bool complete = child.complete() && end < kLimit;
  return {
      {"complete", complete}, {"seconds", complete ? end : kLimit}, {"mistakes", mistakes}, {"words", robot.said()}};
}

struct Tally {
  int children = 0, complete = 0, mistakes = 0, words = 0;
  std::vector<double> seconds;
};

}  // namespace

std::string GuidanceStudy::Run(int number, const ExperimentOptions& options) const {
  static constexpr const char* kTasks[] = {"rectangle_long_medium", "rectangle_long_short", "square"};
  const std::string name = kTasks[number % 3];
  const Task task = LoadTask(options.tasks / (name + ".yaml"));
  Json unit{{"number", number}, {"task", name}};
  for (const char* temper : kTempers) {
    for (const bool guided : {true, false}) unit[temper][guided ? "on" : "off"] = Build(task, temper, guided, number);
  }
  return unit.dump();
}

std::string GuidanceStudy::Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const {
  std::map<std::string, Tally> tallies;
  std::ostringstream md, csv;
  csv << "number,task,temper,guidance,complete,seconds,mistakes,words\n";
  for (const std::string& text : results) {
    const Json unit = Json::parse(text);
    for (const std::string temper : kTempers) {
      for (const std::string guidance : {"on", "off"}) {
        const Json& r = unit[temper][guidance];
        csv << unit["number"] << "," << unit["task"].get<std::string>() << "," << temper << "," << guidance << ","
            << r["complete"] << "," << r["seconds"] << "," << r["mistakes"] << "," << r["words"] << "\n";
        Tally& t = tallies[temper + guidance];
        ++t.children;
        t.complete += r["complete"].get<bool>();
        t.mistakes += r["mistakes"].get<int>();
        t.words += r["words"].get<int>();
        t.seconds.push_back(r["seconds"]);
      }
    }
  }
  md << "# Guidance on and off, " << results.size() << " rooms\n\nA lesson ends unfinished after " << kLimit
     << " s, which count as its time.\n\n| child | guidance | complete (95 % interval) | time (s), median | mistakes a "
        "lesson | sentences a lesson |\n|---|---|---|---|---|---|\n";
  for (const std::string temper : kTempers) {
    for (const std::string guidance : {"on", "off"}) {
      const Tally& t = tallies[temper + guidance];
      const double n = std::max(1, t.children);
      md << "| " << temper << " | " << guidance << " | " << Share(t.complete, t.children) << " | "
         << Median(t.seconds, 0) << " | " << Number(t.mistakes / n, 1) << " | " << Number(t.words / n, 1) << " |\n";
    }
  }
  WriteText(folder / "guidance.csv", csv.str());
  WriteText(folder / "guidance.md", md.str());
  return md.str();
}

}  // namespace coach
