// coach-evaluate-recordings: connections found in recorded scenes with ground truth, through the tracker, as a table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/assembly_reasoner.h"
#include "tools/evaluate/event_scores.h"
#include "tools/evaluate_reasoner/recorded_poses.h"
#include "tools/track_sequence/sequence_tracker.h"

namespace {

namespace fs = std::filesystem;
using namespace coach;

struct Options {
  std::vector<std::string> scenes;
  std::vector<uint64_t> seeds{1};
  double fps = 15;
  fs::path recordings;
  bool replay = false, verbose = false;
};

double Seconds(int64_t utime) { return static_cast<double>(utime) * 1e-6; }

double MedianOfAbsolute(std::vector<double> x) {
  if (x.empty()) return 0;
  for (double& v : x) v = std::abs(v);
  std::sort(x.begin(), x.end());
  return x[(x.size() - 1) / 2];
}

/// What the tracker says of a scene: tracked now, or as it was recorded.
std::vector<PartPoses> PosesOf(const Options& options, const fs::path& scene, uint64_t seed) {
  const fs::path log = options.recordings / (scene.filename().string() + "_" + std::to_string(seed) + ".lcm");
  if (options.replay) return ReadPartPoses(log);
  std::vector<PartPoses> poses;
  SequenceOptions sequence;
  sequence.scene = scene;
  sequence.task = scene / "task.yaml";
  sequence.fps = options.fps;
  sequence.seed = seed;
  sequence.observe = [&](const PartPoses& p) { poses.push_back(p); };
  TrackSequence(sequence);
  if (!options.recordings.empty()) WritePartPoses(log, poses);
  return poses;
}

/// Every true event kind by kind, and how it was found.
struct Row {
  int connections = 0, found = 0, within_1s = 0, mistakes = 0, mistakes_found = 0, false_alarms = 0;
  int undone = 0, undone_found = 0, undone_false = 0;
  std::vector<double> dating;
  bool end_right = true;

  Row& operator+=(const Row& o) {
    connections += o.connections, found += o.found, within_1s += o.within_1s;
    mistakes += o.mistakes, mistakes_found += o.mistakes_found, false_alarms += o.false_alarms;
    undone += o.undone, undone_found += o.undone_found, undone_false += o.undone_false;
    dating.insert(dating.end(), o.dating.begin(), o.dating.end());
    end_right = end_right && o.end_right;
    return *this;
  }
  void Print(const std::string& name, const std::string& seed) const {
    std::printf("| %s | %s | %d/%d | %d/%d | %d/%d | %d/%d | %d | %d | %.2f | %s |\n", name.c_str(), seed.c_str(),
                found, connections, within_1s, connections, mistakes_found, mistakes, undone_found, undone,
                false_alarms, undone_false, MedianOfAbsolute(dating), end_right ? "yes" : "no");
    std::fflush(stdout);
  }
};

Row Score(const SceneTruth& truth, const std::vector<ConnectionEvent>& events, int64_t first_utime) {
  Estimates estimates, undone;
  for (const ConnectionEvent& e : events)
    (e.type == "disconnect" ? undone : estimates)
        .events.push_back({Seconds(e.since - first_utime), e.name, e.type, Seconds(e.decided - first_utime)});
  // Undoings are scored by the same rule as the joints themselves.
  SceneTruth truth_of_undoing = truth;
  std::erase_if(truth_of_undoing.events, [](const TruthEvent& e) { return e.kind != "disconnect"; });
  for (TruthEvent& e : truth_of_undoing.events) e.kind = "connect";
  for (EventRow& e : undone.events) e.kind = "connect";
  const EventScores made = ScoreEvents(truth, estimates), ended = ScoreEvents(truth_of_undoing, undone);
  Row row;
  row.connections = static_cast<int>(made.connections.size());
  row.found = made.matched;
  row.within_1s = made.within_1s;
  row.false_alarms = made.false_alarms;
  for (const Announcement& a : made.connections) {
    const auto event = std::find_if(truth.events.begin(), truth.events.end(), [&](const TruthEvent& e) {
      return e.time == a.time && e.connection == a.connection;
    });
    const bool wrong = event != truth.events.end() && event->kind == "wrong_connect";
    row.mistakes += wrong;
    row.mistakes_found += wrong && a.error;
    if (a.error) row.dating.push_back(*a.error);
  }
  row.undone = static_cast<int>(ended.connections.size());
  row.undone_found = ended.matched;
  row.undone_false = ended.false_alarms;
  Estimates all = estimates;
  for (EventRow e : undone.events) {
    e.kind = "disconnect";
    all.events.push_back(e);
  }
  row.end_right = ScoreEvents(truth, all).final_state_right;
  return row;
}

void PrintEvents(const SceneTruth& truth, const std::vector<ConnectionEvent>& said, int64_t first_utime) {
  for (const TruthEvent& e : truth.events) {
    if (e.kind.find("connect") == std::string::npos && e.kind.find("near_miss") == std::string::npos) continue;
    std::printf("  true %7.2f               %-15s %s", e.time, e.kind.c_str(), e.connection.c_str());
    for (const int p : e.parts) std::printf(" %d", p);
    std::puts("");
  }
  for (const ConnectionEvent& e : said)
    std::printf("  said %7.2f (at %7.2f) %-15s %s %d %d p %.2f\n", Seconds(e.since - first_utime),
                Seconds(e.decided - first_utime), e.type.c_str(), e.name.c_str(), e.part_a, e.part_b, e.probability);
}

void Evaluate(const Options& options) {
  std::puts(
      "| scene | seed | found | within 1 s | mistakes found | undone found | false | false undone | dating error "
      "median s | end state right |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|");
  Row sum;
  for (const fs::path scene : options.scenes) {
    const SceneTruth truth = ReadSceneTruth(scene);
    for (const uint64_t seed : options.seeds) {
      const std::vector<PartPoses> poses = PosesOf(options, scene, seed);
      AssemblyReasoner reasoner(LoadTask(scene / "task.yaml"));
      std::vector<ConnectionEvent> said;
      for (const PartPoses& p : poses) {
        const ReasonerOutput out = reasoner.Step(p);
        said.insert(said.end(), out.events.begin(), out.events.end());
      }
      const Row row = Score(truth, said, poses.front().utime);
      row.Print(scene.filename(), std::to_string(seed));
      if (options.verbose) PrintEvents(truth, said, poses.front().utime);
      sum += row;
    }
  }
  sum.Print("all", "");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Connections found in recorded scenes with ground truth, through the tracker");
  Options options;
  app.add_option("scenes", options.scenes, "scene folders")->required()->check(CLI::ExistingDirectory);
  app.add_option("--seeds", options.seeds, "of the tracker");
  app.add_option("--fps", options.fps, "frames a second of the scenes")->check(CLI::PositiveNumber);
  app.add_option("--recordings", options.recordings, "folder: PART_POSES are kept there as SCENE_SEED.lcm");
  app.add_flag("--replay", options.replay, "reason over the kept PART_POSES instead of tracking");
  app.add_flag("--events", options.verbose, "print every event");
  CLI11_PARSE(app, argc, argv);
  try {
    if (options.replay && options.recordings.empty()) throw std::invalid_argument("--replay needs --recordings");
    Evaluate(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coach-evaluate-recordings: %s\n", e.what());
    return 1;
  }
  return 0;
}
