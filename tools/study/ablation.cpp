#include "tools/study/ablation.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "common/assembly/task_file.h"
#include "tools/evaluate/evaluation.h"
#include "tools/study/report_text.h"
#include "tools/study/study_scene.h"

namespace coach {
namespace {

using Json = nlohmann::json;

std::string Sha256(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": can't be read");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr);
  std::ostringstream hex;
  hex << std::hex;
  for (unsigned int i = 0; i < size; ++i) hex << (digest[i] >> 4) << (digest[i] & 15);
  return hex.str();
}

/// Folder of a scene, which is rendered if it is not there.
std::filesystem::path SceneFolder(const AblationScene& scene, const ExperimentOptions& options) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const std::filesystem::path folder = options.scratch / scene.name;
  if (std::filesystem::exists(folder)) return folder;
  ScenarioOptions scenario;
  scenario.name = scene.name;
  scenario.seed = scene.seed;
  scenario.fps = options.fps;
  scenario.style = scene.style;
  Scenario made = MakeScenario(LoadTask(options.tasks / (std::string(scene.task) + ".yaml")), scenario);
  const auto end = std::upper_bound(made.frame_times.begin(), made.frame_times.end(), scene.seconds);
  made.image_ids.resize(static_cast<size_t>(end - made.frame_times.begin()));
  made.frame_times.erase(end, made.frame_times.end());
  RenderOnce(made, folder);
  return folder;
}

Json Scores(const SceneTruth& truth, const Evaluation& r) {
  const PoseScores& s = r.poses;
  int judged = 0;
  for (const auto& frame : truth.visible) {
    judged += static_cast<int>(std::count_if(frame.begin(), frame.end(), [](double v) { return v >= 0.3; }));
  }
  const auto filter = r.estimates.stage_ms.find("pose_filter");
  return {{"position", s.clear_position_mm.n > 0 ? Json(s.clear_position_mm.median) : Json()},
          {"rotation", s.clear_position_mm.n > 0 ? Json(s.clear_rotation_deg.median) : Json()},
          {"judged", judged},
          {"good", std::lround(s.success_30 / 100 * judged)},
          {"losses", s.losses.size()},
          {"lost_seconds", s.lost_seconds},
          {"reappearances", s.recoveries.size()},
          {"recovered", Recovered(s)},
          {"swap_seconds", s.longest_swap},
          {"tracked", s.tracked_frames},
          {"wrong", std::lround(s.wrong_while_tracked.value_or(0) / 100 * s.tracked_frames)},
          {"ms", filter == r.estimates.stage_ms.end() ? Json() : Json(Quantile(filter->second, 0.5))}};
}

/// Sums over runs; medians are medians of the runs' medians.
struct Tally {
  std::vector<double> position, rotation, ms;
  int runs = 0, judged = 0, good = 0, losses = 0, reappearances = 0, recovered = 0, swaps = 0, tracked = 0, wrong = 0;
  double lost_seconds = 0;

  void Add(const Json& s) {
    ++runs;
    if (!s["position"].is_null()) position.push_back(s["position"]), rotation.push_back(s["rotation"]);
    if (!s["ms"].is_null()) ms.push_back(s["ms"]);
    judged += s["judged"].get<int>(), good += s["good"].get<int>();
    losses += s["losses"].get<int>(), lost_seconds += s["lost_seconds"].get<double>();
    reappearances += s["reappearances"].get<int>(), recovered += s["recovered"].get<int>();
    swaps += s["swap_seconds"].get<double>() >= 0.5;
    tracked += s["tracked"].get<int>(), wrong += s["wrong"].get<int>();
  }

  std::string Row() const {
    const auto median = [](const std::vector<double>& v) { return v.empty() ? "-" : Number(Quantile(v, 0.5)); };
    const auto percent = [](int k, int n, int digits) { return n == 0 ? "-" : Number(100.0 * k / n, digits); };
    std::ostringstream md;
    md << median(position) << " | " << median(rotation) << " | " << percent(good, judged, 1) << " | " << losses << " ("
       << Number(lost_seconds, 1) << ") | " << recovered << "/" << reappearances << " | " << swaps << " | "
       << percent(wrong, tracked, 2) << " | " << median(ms) << " |";
    return md.str();
  }
};

constexpr const char* kColumns =
    " position (mm) | rotation (deg) | within 20 mm, 10 deg (%) | losses (s) | back in 0.2 s | swaps | wrong while "
    "tracked (%) | filter (ms) |\n|---|---|---|---|---|---|---|---|---|\n";

}  // namespace

const std::vector<AblationScene>& AblationScenes() {
  static const std::vector<AblationScene> scenes{
      {"hidden_still", "rectangle_long_medium", "normal", 101, 15, false},
      {"hidden_moving", "square", "slow", 102, 15, true},
      {"pass_over", "rectangle_long_short", "normal", 103, 15, false},
      {"touching", "square", "hesitant", 104, 15, true},
      {"fast", "car", "hasty", 105, 15, true},
      {"leave_return", "square", "normal", 106, 15, false},
      {"handed_over", "rectangle_long_medium", "slow", 107, 15, true},
      {"half_covered", "car", "normal", 108, 15, false},
      {"jolts", "rectangle_long_short", "hasty", 109, 15, true},
      {"shiny", "square", "normal", 110, 15, false},
      {"dropped_frames", "rectangle_long_medium", "normal", 111, 15, false},
      {"slow_camera", "car", "hesitant", 112, 15, true},
      {"noisy", "square", "hasty", 113, 15, true},
      {"fig4", "two_bricks", "normal", 114, 15, false},
  };
  return scenes;
}

std::vector<std::string> AblationStudy::Units(int n) const {
  std::vector<std::string> units;
  for (int seed = 1; seed <= n; ++seed) {
    for (const AblationScene& scene : AblationScenes()) {
      units.push_back("ablation-" + std::string(scene.name) + "-" + std::to_string(seed));
    }
  }
  return units;
}

std::string AblationStudy::Run(int number, const ExperimentOptions& options) const {
  const int scenes = static_cast<int>(AblationScenes().size());
  const AblationScene& scene = AblationScenes()[static_cast<size_t>((number - 1) % scenes)];
  const int seed = (number - 1) / scenes + 1;
  const std::filesystem::path folder = SceneFolder(scene, options);
  const SceneTruth truth = ReadSceneTruth(folder);
  const std::filesystem::path results =
      options.scratch / ("results-" + std::string(scene.name) + "-" + std::to_string(seed));
  std::filesystem::remove_all(results);
  std::filesystem::create_directories(results);
  std::ostringstream command;
  command << "'" << options.tracker.string() << "' '" << folder.string() << "' --task '"
          << (folder / "task.yaml").string() << "' --fps " << truth.fps << " --seed " << seed << " --variants '"
          << results.string() << "' > '" << (results / "log").string() << "' 2>&1";
  if (std::system(command.str().c_str()) != 0)
    throw std::runtime_error("the tracker failed, see " + (results / "log").string());
  Json unit{{"scene", scene.name},      {"held_back", scene.held_back}, {"seed", seed},
            {"frames", truth.frames()}, {"parts", truth.parts()},       {"truth", Sha256(folder / "scene_gt.json")}};
  for (const auto& file : std::filesystem::directory_iterator(results)) {
    const std::string name = file.path().filename().string(), ending = "_poses.csv";
    if (!name.ends_with(ending)) continue;
    const Evaluation r = Evaluate(truth, ReadEstimates(Companions(file.path()), truth));
    unit["rows"][name.substr(0, name.size() - ending.size())] = Scores(truth, r);
  }
  if (!options.keep_scenes) std::filesystem::remove_all(results);
  return unit.dump();
}

std::string AblationStudy::Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const {
  std::ostringstream md, csv;
  std::map<bool, std::map<std::string, Tally>> by_half;          // held back or not, variant
  std::map<std::string, std::map<std::string, Tally>> by_scene;  // scene, variant
  std::map<std::string, Json> of_scene;
  csv << "scene,held_back,seed,variant,position_mm,rotation_deg,judged,good,losses,lost_s,reappearances,recovered,"
         "swap_s,tracked,wrong,filter_ms\n";
  for (const std::string& text : results) {
    const Json u = Json::parse(text);
    const std::string scene = u["scene"];
    of_scene[scene] = u;
    for (const auto& [variant, s] : u["rows"].items()) {
      by_half[u["held_back"].get<bool>()][variant].Add(s);
      by_scene[scene][variant].Add(s);
      csv << scene << "," << u["held_back"] << "," << u["seed"] << ",\"" << variant << "\"";
      for (const char* key : {"position", "rotation", "judged", "good", "losses", "lost_seconds", "reappearances",
                              "recovered", "swap_seconds", "tracked", "wrong", "ms"}) {
        csv << "," << s[key];
      }
      csv << "\n";
    }
  }
  md << "# Ablation, " << results.size() << " runs\n\n"
     << "Position and rotation: of parts at least half visible, median over the runs of a run's median. Within 20 mm "
        "and 10 degrees: of part-frames at least 0.3 visible. Swaps: runs in which two equal parts had each other's "
        "place for 0.5 s. Wrong while tracked: off by over 20 mm.\n";
  for (const bool held_back : {false, true}) {
    if (by_half[held_back].empty()) continue;
    md << "\n## " << (held_back ? "Scenes held back" : "Scenes of the development") << "\n\n| |" << kColumns;
    for (const auto& [variant, tally] : by_half[held_back]) md << "| " << variant << " | " << tally.Row() << "\n";
  }
  md << "\n## Scene by scene\n\n| |" << kColumns;
  for (const AblationScene& s : AblationScenes()) {
    if (!of_scene.count(s.name)) continue;
    for (const char* variant : {"full", "paper"})
      md << "| " << s.name << ", " << variant << " | " << by_scene[s.name][variant].Row() << "\n";
  }
  md << "\n## Scenes\n\n| scene | task, child, seed | frames | parts | SHA-256 of scene_gt.json "
        "|\n|---|---|---|---|---|\n";
  for (const AblationScene& s : AblationScenes()) {
    if (!of_scene.count(s.name)) continue;
    const Json& u = of_scene[s.name];
    md << "| " << s.name << (s.held_back ? " (held back)" : "") << " | " << s.task << ", " << s.style << ", " << s.seed
       << " | " << u["frames"] << " | " << u["parts"] << " | `" << u["truth"].get<std::string>() << "` |\n";
  }
  WriteText(folder / "ablation.csv", csv.str());
  WriteText(folder / "ablation.md", md.str());
  return md.str();
}

}  // namespace coach
