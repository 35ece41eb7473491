#include "tools/evaluate/evaluation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>

namespace coach {
namespace {

std::string Text(double x, int digits = 2) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(digits) << x;
  return out.str();
}

std::string Count(int k, int n) { return std::to_string(k) + "/" + std::to_string(n); }

std::string Spread(const Statistics& s) { return s.n == 0 ? "-" : Text(s.median) + " / " + Text(s.p95); }

using Cell = std::function<std::string(const Evaluation&)>;

std::string Table(const std::vector<std::pair<std::string, Cell>>& rows, const std::vector<Evaluation>& results) {
  std::ostringstream out;
  out << "| |";
  for (const Evaluation& r : results) out << " " << r.name << " |";
  out << "\n|---|";
  for (size_t i = 0; i < results.size(); ++i) out << "---|";
  out << "\n";
  for (const auto& [name, cell] : rows) {
    out << "| " << name << " |";
    for (const Evaluation& r : results) out << " " << cell(r) << " |";
    out << "\n";
  }
  return out.str();
}

Target AtMost(const std::string& what, double bound, const std::string& unit, std::optional<double> measured) {
  Target t{what, "<= " + Text(bound, bound == std::floor(bound) ? 0 : 1) + unit, "-"};
  if (!measured) return t;
  t.measured = Text(*measured) + unit;
  t.verdict = *measured <= bound ? Target::Verdict::kMet : Target::Verdict::kNotMet;
  return t;
}

std::optional<double> If(bool known, double value) { return known ? std::optional<double>(value) : std::nullopt; }

const char* ToString(Target::Verdict verdict) {
  switch (verdict) {
    case Target::Verdict::kMet:
      return "met";
    case Target::Verdict::kNotMet:
      return "not met";
    case Target::Verdict::kUnknown:
      return "not measured";
  }
  return "";
}

void AddCoverage(const std::string& what, const std::optional<double>& measured, std::vector<Target>* targets) {
  Target t{what, "90 to 99 %", "-"};
  if (measured) {
    t.measured = Text(*measured, 1) + " %";
    t.verdict = *measured >= 90 && *measured <= 99 ? Target::Verdict::kMet : Target::Verdict::kNotMet;
  }
  targets->push_back(t);
}

void AddTimings(const Evaluation& r, std::vector<Target>* targets) {
  const auto stage = [&](const std::string& name, double q) -> std::optional<double> {
    const auto found = r.estimates.stage_ms.find(name);
    return found == r.estimates.stage_ms.end() ? std::nullopt : std::optional(Quantile(found->second, q));
  };
  targets->push_back(AtMost("pose-filter, median", 3, " ms", stage("pose_filter", 0.5)));
  targets->push_back(AtMost("pose-filter, p99", 5, " ms", stage("pose_filter", 0.99)));
  targets->push_back(AtMost("detector, median", 0.5, " ms", stage("detector", 0.5)));
}

std::vector<PlotBand> HiddenBands(const SceneTruth& truth, double below) {
  std::vector<PlotBand> bands;
  bool open = false;
  for (size_t f = 0; f < truth.visible.size(); ++f) {
    const bool hidden = *std::min_element(truth.visible[f].begin(), truth.visible[f].end()) < below;
    const double time = truth.image_ids[f] / truth.fps;
    if (hidden && !open) bands.push_back({time, time});
    if (hidden) bands.back().to = time;
    open = hidden;
  }
  return bands;
}

std::vector<double> Times(const SceneTruth& truth) {
  std::vector<double> times;
  for (const int id : truth.image_ids) times.push_back(id / truth.fps);
  return times;
}

}  // namespace

Evaluation Evaluate(const SceneTruth& truth, Estimates estimates) {
  Evaluation r;
  r.name = estimates.name;
  r.errors = ComputeErrors(truth, estimates);
  r.poses = ScorePoses(truth, estimates, r.errors);
  if (estimates.has_events) r.events = ScoreEvents(truth, estimates);
  r.estimates = std::move(estimates);
  return r;
}

std::string ScoreTable(const SceneTruth& truth, const std::vector<Evaluation>& results) {
  std::vector<std::pair<std::string, Cell>> rows{
      {"position, visible >= 0.1, median / p95 (mm)", [](const Evaluation& r) { return Spread(r.poses.position_mm); }},
      {"rotation, visible >= 0.1, median / p95 (deg)",
       [](const Evaluation& r) { return Spread(r.poses.rotation_deg); }},
      {"ADD-S, median / p95 (mm)", [](const Evaluation& r) { return Spread(r.poses.add_s_mm); }},
      {"position, visible >= 0.5, median / p95 (mm)",
       [](const Evaluation& r) { return Spread(r.poses.clear_position_mm); }},
      {"rotation, visible >= 0.5, median / p95 (deg)",
       [](const Evaluation& r) { return Spread(r.poses.clear_rotation_deg); }},
      {"within 20 mm and 10 deg, visible >= 0.1 (%)", [](const Evaluation& r) { return Text(r.poses.success_10, 1); }},
      {"within 20 mm and 10 deg, visible >= 0.3 (%)", [](const Evaluation& r) { return Text(r.poses.success_30, 1); }},
      {"losses (s lost)",
       [](const Evaluation& r) {
         return std::to_string(r.poses.losses.size()) + " (" + Text(r.poses.lost_seconds, 1) + ")";
       }},
      {"recovered within 0.2 s",
       [](const Evaluation& r) { return Count(Recovered(r.poses), static_cast<int>(r.poses.recoveries.size())); }},
      {"identity switches; longest swap (s)",
       [](const Evaluation& r) {
         return std::to_string(r.poses.identity_switches) + "; " + Text(r.poses.longest_swap);
       }},
      {"all parts found after (s)",
       [](const Evaluation& r) { return r.poses.start_seconds ? Text(*r.poses.start_seconds) : std::string("never"); }},
      {"wrong while tracked (%)",
       [](const Evaluation& r) { return r.poses.wrong_while_tracked ? Text(*r.poses.wrong_while_tracked) : "-"; }},
      {"95 % ellipsoid holds: visible; hidden (%)", [](const Evaluation& r) {
         const auto cell = [](const std::optional<double>& x) { return x ? Text(*x, 1) : std::string("-"); };
         return cell(r.poses.coverage_visible) + "; " + cell(r.poses.coverage_hidden);
       }}};
  if (truth.scenario == "fig4") {
    rows.push_back({"distance error, both >= 0.5 visible, median / p95 (mm)",
                    [](const Evaluation& r) { return Spread(r.poses.distance_mm); }});
    rows.push_back({"distance error, all frames, median / p95 (mm)",
                    [](const Evaluation& r) { return Spread(r.poses.distance_all_mm); }});
  }
  const auto events = [](const auto& cell) -> Cell {
    return [cell](const Evaluation& r) { return r.estimates.has_events ? cell(r.events) : std::string("-"); };
  };
  rows.push_back({"connections found; false alarms", events([](const EventScores& e) {
                    return Count(e.matched, static_cast<int>(e.connections.size())) + "; " +
                           std::to_string(e.false_alarms);
                  })});
  rows.push_back({"announced within 1 s", events([](const EventScores& e) {
                    return Count(e.within_1s, static_cast<int>(e.connections.size()));
                  })});
  rows.push_back({"time error of connections, median (s)", events([](const EventScores& e) {
                    return e.time_error.n ? Text(e.time_error.median) : std::string("-");
                  })});
  rows.push_back({"final state right",
                  events([](const EventScores& e) { return std::string(e.final_state_right ? "yes" : "no"); })});
  return Table(rows, results);
}

std::vector<Target> CheckTargets(const SceneTruth& truth, const Evaluation& r) {
  const PoseScores& s = r.poses;
  const bool clear = s.clear_position_mm.n > 0;
  std::vector<Target> targets{
      AtMost("position, at least half visible, median", 1, " mm", If(clear, s.clear_position_mm.median)),
      AtMost("position, at least half visible, p95", 3, " mm", If(clear, s.clear_position_mm.p95)),
      AtMost("rotation, at least half visible, median", 1, " deg", If(clear, s.clear_rotation_deg.median))};
  if (truth.scenario == "fig4") {
    targets.push_back(
        AtMost("distance of two fixed parts, median", 0.3, " mm", If(s.distance_mm.n > 0, s.distance_mm.median)));
    targets.push_back(
        AtMost("distance of two fixed parts, p95", 1.5, " mm", If(s.distance_mm.n > 0, s.distance_mm.p95)));
  }
  Target success{"part-frames at least 0.3 visible within 20 mm and 10 deg", ">= 98 %", Text(s.success_30, 1) + " %"};
  success.verdict = s.success_30 >= 98 ? Target::Verdict::kMet : Target::Verdict::kNotMet;
  targets.push_back(success);
  Target recovery{"back under 10 mm within 0.2 s of reappearing", "always", "-"};
  if (!s.recoveries.empty()) {
    recovery.measured = Count(Recovered(s), static_cast<int>(s.recoveries.size()));
    recovery.verdict =
        Recovered(s) == static_cast<int>(s.recoveries.size()) ? Target::Verdict::kMet : Target::Verdict::kNotMet;
  }
  targets.push_back(recovery);
  targets.push_back(AtMost("wrong by over 20 mm while tracked", 0.1, " %", s.wrong_while_tracked));
  AddCoverage("95 % ellipsoid holds the truth, visible", s.coverage_visible, &targets);
  AddCoverage("95 % ellipsoid holds the truth, hidden", s.coverage_hidden, &targets);
  Target swap{"longest identity swap", "< 0.5 s", Text(s.longest_swap) + " s"};
  swap.verdict = s.longest_swap < 0.5 ? Target::Verdict::kMet : Target::Verdict::kNotMet;
  targets.push_back(swap);
  Target start = AtMost("all parts found from nothing", 1, " s", s.start_seconds);
  if (!s.start_seconds) start.measured = "never", start.verdict = Target::Verdict::kNotMet;
  targets.push_back(start);
  AddTimings(r, &targets);
  return targets;
}

std::string TargetTable(const SceneTruth& truth, const std::vector<Evaluation>& results) {
  std::vector<std::vector<Target>> all;
  for (const Evaluation& r : results) all.push_back(CheckTargets(truth, r));
  std::ostringstream out;
  out << "| target | bound |";
  for (const Evaluation& r : results) out << " " << r.name << " |";
  out << "\n|---|---|";
  for (size_t i = 0; i < results.size(); ++i) out << "---|";
  out << "\n";
  for (size_t row = 0; !all.empty() && row < all[0].size(); ++row) {
    out << "| " << all[0][row].what << " | " << all[0][row].bound << " |";
    for (const auto& targets : all)
      out << " " << targets[row].measured << ": " << ToString(targets[row].verdict) << " |";
    out << "\n";
  }
  return out.str();
}

Plot ErrorPlot(const SceneTruth& truth, const std::vector<Evaluation>& results) {
  Plot plot{.title = "Position error of the worst visible part",
            .x_label = "time (s)",
            .y_label = "mm",
            .y_low = 0.1,
            .y_high = 1000};
  for (const Evaluation& r : results) {
    PlotSeries series{r.name, Times(truth), {}};
    for (size_t f = 0; f < truth.X_CP.size(); ++f) {
      double worst = -1;
      for (size_t k = 0; k < truth.objects.size(); ++k) {
        if (truth.visible[f][k] >= 0.1) worst = std::max(worst, std::min(1000.0, r.errors.position_mm[k][f]));
      }
      series.y.push_back(worst >= 0 ? worst : kNoEstimate);
    }
    plot.series.push_back(series);
  }
  plot.bands = HiddenBands(truth, 0.05);
  plot.bands_legend = "shaded: a part is hidden";
  return plot;
}

Plot DistancePlot(const SceneTruth& truth, const std::vector<Evaluation>& results) {
  Plot plot{.title = "Error of the distance between the first two parts",
            .x_label = "time (s)",
            .y_label = "mm",
            .y_low = 0.1,
            .y_high = 1000};
  for (const Evaluation& r : results) {
    plot.series.push_back({r.name, Times(truth), DistanceErrors(truth, r.estimates, r.errors)});
  }
  plot.bands = HiddenBands(truth, 0.05);
  for (const TruthEvent& e : truth.events) {
    if (e.kind == "jolt") plot.bands.push_back({e.time, e.time + e.duration, "#b9d3ee"});
  }
  plot.bands_legend = "red: a part is hidden, blue: jolt";
  return plot;
}

}  // namespace coach
