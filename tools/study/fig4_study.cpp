#include "tools/study/fig4_study.h"

#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/assembly/task_file.h"
#include "tools/study/report_text.h"
#include "tools/study/study_scene.h"

namespace coach {
namespace {

using Json = nlohmann::json;

Json Finite(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double x : values) list.push_back(std::isfinite(x) ? Json(std::round(1e4 * x) / 1e4) : Json());
  return list;
}

std::vector<double> Doubles(const Json& list) {
  std::vector<double> values;
  for (const Json& x : list) values.push_back(x.is_null() ? std::numeric_limits<double>::infinity() : x.get<double>());
  return values;
}

}  // namespace

std::string Fig4Study::Run(int number, const ExperimentOptions& options) const {
  ScenarioOptions scenario;
  scenario.name = "fig4";
  scenario.seed = static_cast<uint64_t>(number);
  scenario.fps = 30;
  scenario.seconds = options.seconds > 0 ? options.seconds : 24;
  const StudyScene scene(Units(number).back(), LoadTask(options.tasks / "two_bricks.yaml"), scenario, options);
  Json unit{{"seed", number}};
  for (const char* mode : {"full", "paper"}) {
    const Evaluation r = scene.Track(mode);
    const Plot plot = DistancePlot(scene.truth(), {r});
    if (!unit.contains("time")) {
      unit["time"] = Finite(plot.series[0].x);
      for (const PlotBand& band : plot.bands) unit["bands"].push_back({band.from, band.to, band.colour});
    }
    unit["modes"][mode] = {{"distance_mm", Finite(plot.series[0].y)},
                           {"both_visible_median", r.poses.distance_mm.median},
                           {"both_visible_p95", r.poses.distance_mm.p95},
                           {"success", r.poses.success_30},
                           {"lost_seconds", r.poses.lost_seconds},
                           {"reappearances", r.poses.recoveries.size()},
                           {"recovered", Recovered(r.poses)}};
  }
  return unit.dump();
}

std::string Fig4Study::Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const {
  std::ostringstream md, csv;
  csv << "seed,mode,time,distance_error_mm\n";
  std::map<std::string, std::vector<double>> median, p95, success, lost;
  std::map<std::string, int> back, gone;
  for (const std::string& text : results) {
    const Json unit = Json::parse(text);
    Plot plot{.title = "Error of the distance between two bricks, seed " + unit["seed"].dump(),
              .x_label = "time (s)",
              .y_label = "mm",
              .y_low = 0.1,
              .y_high = 1000};
    plot.bands_legend = "red: a brick is hidden, blue: jolt";
    for (const Json& b : unit.value("bands", Json::array()))
      plot.bands.push_back({b[0], b[1], b[2].get<std::string>()});
    const auto time = Doubles(unit["time"]);
    for (const auto& [mode, m] : unit["modes"].items()) {
      plot.series.push_back({mode, time, Doubles(m["distance_mm"])});
      for (size_t i = 0; i < time.size(); ++i)
        csv << unit["seed"] << "," << mode << "," << time[i] << "," << m["distance_mm"][i] << "\n";
      median[mode].push_back(m["both_visible_median"]), p95[mode].push_back(m["both_visible_p95"]);
      success[mode].push_back(m["success"]), lost[mode].push_back(m["lost_seconds"]);
      back[mode] += m["recovered"].get<int>(), gone[mode] += m["reappearances"].get<int>();
    }
    WriteSvg(folder / ("fig4_seed" + unit["seed"].dump() + ".svg"), plot);
  }
  md << "# Two bricks before a moving camera (the paper's Fig. 4), " << results.size() << " scenes\n\n"
     << "Median over the scenes with its 95 % bootstrap interval; the curves are in fig4.csv and fig4_seed*.svg.\n\n"
     << "| | full | paper |\n|---|---|---|\n";
  const auto row = [&](const std::string& what, auto& values) {
    md << "| " << what << " | " << Median(values["full"]) << " | " << Median(values["paper"]) << " |\n";
  };
  row("distance error, both visible, median (mm)", median);
  row("distance error, both visible, p95 (mm)", p95);
  row("part-frames within 20 mm and 10 deg (%)", success);
  row("seconds lost", lost);
  md << "| back within 0.2 s of reappearing | " << Share(back["full"], gone["full"]) << " | "
     << Share(back["paper"], gone["paper"]) << " |\n";
  WriteText(folder / "fig4.csv", csv.str());
  WriteText(folder / "fig4.md", md.str());
  return md.str();
}

}  // namespace coach
