#include "tools/study/start_study.h"

#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/assembly/task_file.h"
#include "tools/study/report_text.h"
#include "tools/study/study_scene.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr double kNear = 20, kTurned = 10;  // mm, degrees: within both a part is found

/// What is not found at the end: part, how far off it is (null: no estimate), how much of it is seen.
Json WrongParts(const SceneTruth& truth, const PoseErrors& errors) {
  Json wrong = Json::array();
  for (size_t k = 0; k < truth.objects.size(); ++k) {
    const double mm = errors.position_mm[k].back(), degrees = errors.rotation_deg[k].back();
    if (mm < kNear && degrees < kTurned) continue;
    const auto rounded = [](double x) { return std::isfinite(x) ? Json(std::round(10 * x) / 10) : Json(); };
    wrong.push_back({{"part", truth.objects[k].name},
                     {"mm", rounded(mm)},
                     {"degrees", rounded(degrees)},
                     {"visible", std::round(100 * truth.visible.back()[k]) / 100}});
  }
  return wrong;
}

}  // namespace

std::string StartStudy::Run(int number, const ExperimentOptions& options) const {
  static constexpr const char* kTasks[] = {"rectangle_long_medium", "rectangle_long_short", "square", "car"};
  const std::string task = kTasks[number % 4];
  ScenarioOptions scenario;
  scenario.name = "start";
  scenario.seed = static_cast<uint64_t>(1000 + number);
  scenario.fps = 10;
  scenario.seconds = 1.1;
  const StudyScene scene(Units(number).back(), LoadTask(options.tasks / (task + ".yaml")), scenario, options);
  const Evaluation r = scene.Track("full");
  const bool found = r.poses.start_seconds && *r.poses.start_seconds <= 1.0 + 1e-9;
  return Json{{"number", number},
              {"task", task},
              {"found", found},
              {"after", found ? Json(*r.poses.start_seconds) : Json()},
              {"parts", r.errors.position_mm.size()},
              {"wrong", WrongParts(scene.truth(), r.errors)}}
      .dump();
}

std::string StartStudy::Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const {
  std::map<std::string, std::array<int, 2>> by_task;  // failures, scenes
  std::ostringstream md, csv, failures;
  csv << "number,task,found,after,parts,wrong_parts\n";
  int failed = 0, parts = 0;
  size_t wrong = 0;
  for (const std::string& text : results) {
    const Json u = Json::parse(text);
    const std::string task = u["task"];
    csv << u["number"] << "," << task << "," << u["found"] << "," << u["after"] << "," << u["parts"] << ","
        << u["wrong"].size() << "\n";
    auto& entry = by_task[task];
    ++entry[1];
    wrong += u["wrong"].size(), parts += u["parts"].get<int>();
    if (u["found"].get<bool>()) continue;
    ++failed, ++entry[0];
    for (const Json& w : u["wrong"]) {
      failures << "| " << u["number"] << " | " << task << " | " << w["part"].get<std::string>() << " | " << w["mm"]
               << " | " << w["degrees"] << " | " << w["visible"] << " |\n";
    }
  }
  md << "# Starting from nothing, " << results.size()
     << " scenes\n\nA start fails if there is no moment within 1 s at which all parts that are at least half visible "
        "are within 20 mm and 10 degrees (modulo symmetry).\n\n| task | failures (95 % interval) |\n|---|---|\n";
  for (const auto& [task, entry] : by_task) md << "| " << task << " | " << Share(entry[0], entry[1]) << " |\n";
  md << "| all | " << Share(failed, static_cast<int>(results.size())) << " |\n| parts wrong at the end | "
     << Share(static_cast<int>(wrong), parts)
     << " |\n\nWrong at the end of the scenes that failed:\n\n| scene | task | part | off (mm) | off (degrees) | "
        "visible "
        "|\n|---|---|---|---|---|---|\n"
     << failures.str();
  WriteText(folder / "start.csv", csv.str());
  WriteText(folder / "start.md", md.str());
  return md.str();
}

}  // namespace coach
