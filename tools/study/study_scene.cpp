#include "tools/study/study_scene.h"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tools/simulator/scene_recorder.h"

namespace coach {

void RenderOnce(const Scenario& scenario, const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder)) return;
  const std::filesystem::path part = folder.string() + ".part" + std::to_string(getpid());
  std::filesystem::remove_all(part);
  RecordScene(scenario, part, {}, {});
  std::error_code taken;
  std::filesystem::rename(part, folder, taken);
  if (taken) std::filesystem::remove_all(part);
}

StudyScene::StudyScene(const std::string& name, const Task& task, const ScenarioOptions& scenario,
                       const ExperimentOptions& options)
    : folder_(options.scratch / name), tracker_(options.tracker), keep_(options.keep_scenes) {
  if (!keep_) std::filesystem::remove_all(folder_);
  RenderOnce(MakeScenario(task, scenario), folder_ / "scene");
  truth_ = ReadSceneTruth(folder_ / "scene");
}

StudyScene::~StudyScene() {
  std::error_code ignored;
  if (!keep_) std::filesystem::remove_all(folder_, ignored);
}

Evaluation StudyScene::Track(const std::string& mode) const {
  const auto file = [&](const std::string& kind) { return (folder_ / (mode + "_" + kind)).string(); };
  const std::filesystem::path scene = folder_ / "scene";
  std::ostringstream command;
  command << "'" << tracker_.string() << "' '" << scene.string() << "' --task '" << (scene / "task.yaml").string()
          << "' --fps " << truth_.fps << " --poses '" << file("poses.csv") << "' --states '" << file("states.csv")
          << "' --events '" << file("events.csv") << "' --timings '" << file("timings.csv") << "'"
          << (mode == "paper" ? " --paper" : "") << " > '" << file("log") << "' 2>&1";
  if (std::system(command.str().c_str()) != 0) {
    std::ifstream log(file("log"));
    const std::string text{std::istreambuf_iterator<char>(log), std::istreambuf_iterator<char>()};
    throw std::runtime_error("the tracker failed: " + text.substr(text.size() > 200 ? text.size() - 200 : 0));
  }
  Estimates estimates = ReadEstimates(Companions(file("poses.csv")), truth_);
  estimates.name = mode;
  return Evaluate(truth_, std::move(estimates));
}

}  // namespace coach
