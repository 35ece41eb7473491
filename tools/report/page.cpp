#include "tools/report/page.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tools/report/numbers.h"
#include "tools/report/plots.h"
#include "tools/report/style.h"
#include "tools/report/svg.h"
#include "tools/report/timeline.h"

namespace coach {
namespace {

using svg::Escaped;

constexpr const char* kDash = "–";

std::string Cell(const std::string& text, const char* style = "") {
  return "<td" + (*style ? " class=\"" + std::string(style) + "\"" : std::string()) + ">" +
         (text.empty() ? std::string() : Escaped(text)) + "</td>";
}
std::string NumberCell(const std::string& text) { return Cell(text.empty() ? kDash : text, "number"); }

std::string Header(const std::vector<std::string>& names) {
  std::string out = "<tr>";
  for (const std::string& name : names) {
    const bool number = name.starts_with("#");
    out += std::string("<th scope=\"col\"") + (number ? " class=\"number\"" : "") + ">" +
           Escaped(number ? name.substr(1) : name) + "</th>";
  }
  return out + "</tr>\n";
}

std::string Tile(const std::string& value, const std::string& meaning) {
  return "<div class=\"tile\"><b>" + Escaped(value.empty() ? kDash : value) + "</b><span>" + Escaped(meaning) +
         "</span></div>\n";
}

std::string List(const std::set<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += (out.empty() ? "" : ", ") + item;
  return out;
}

std::string Heading(const Report& report) {
  std::set<std::string> stations, tasks, dates;
  for (const SessionReport& s : report.sessions) {
    if (!s.session.station.empty()) stations.insert(s.session.station);
    if (const std::string date = Date(s.session.begin); !date.empty()) dates.insert(date.substr(0, 10));
    for (const Trial& t : s.trials) {
      if (!t.span.task.empty()) tasks.insert(t.span.task);
    }
  }
  const bool one = report.sessions.size() == 1;
  std::string out = "<header><h1>" +
                    (one ? "Session " + Escaped(report.sessions[0].session.name)
                         : std::to_string(report.sessions.size()) + " sessions") +
                    "</h1>\n<p>Coach report";
  if (!tasks.empty()) out += " · " + Escaped(List(tasks));
  if (!stations.empty()) out += " · " + Escaped(List(stations));
  if (!dates.empty()) out += " · " + *dates.begin() + (dates.size() > 1 ? " to " + *dates.rbegin() : "");
  return out + "</p></header>\n";
}

std::string Navigation(const Report& report) {
  std::string out = "<nav aria-label=\"Sections\">";
  if (!report.table1.empty()) out += "<a href=\"#table1\">Table</a>";
  if (!report.questionnaire.questions.empty()) out += "<a href=\"#questionnaire\">Questionnaire</a>";
  for (size_t i = 0; i < report.sessions.size(); ++i)
    out += "<a href=\"#session-" + std::to_string(i + 1) + "\">" + Escaped(report.sessions[i].session.name) + "</a>";
  return out + "<a href=\"#versions\">Versions</a><a href=\"#meaning\">What the figures mean</a></nav>\n";
}

std::string Overview(const Report& report) {
  int trials = 0, completed = 0, happened = 0, found = 0, false_alarms = 0, annotated = 0, announced = 0;
  std::vector<double> delays, tracked;
  size_t incidents = 0;
  for (const SessionReport& s : report.sessions) {
    incidents += s.incidents.size();
    for (const TrialFigures& f : s.figures) {
      ++trials;
      completed += f.completed;
      annotated += f.annotated;
      announced += f.detected_connections + f.detected_wrong;
      if (f.tracked_share >= 0) tracked.push_back(f.tracked_share);
      if (!f.annotated) continue;
      happened += f.connections + f.wrong;
      found += static_cast<int>(f.datings.size());
      false_alarms += f.false_alarms;
      delays.insert(delays.end(), f.delays_connect.begin(), f.delays_connect.end());
      delays.insert(delays.end(), f.delays_wrong.begin(), f.delays_wrong.end());
    }
  }
  std::string out = "<section><div class=\"tiles\">\n";
  out += Tile(std::to_string(completed) + " of " + std::to_string(trials), "trials completed");
  if (annotated > 0) {
    out += Tile(std::to_string(found) + " of " + std::to_string(happened), "true connections and mistakes announced");
    out += Tile(std::to_string(false_alarms), "false alarms");
    out += Tile(delays.empty() ? "" : Fixed(Median(delays), 1) + " s", "median delay of the announcement");
  } else {
    out += Tile(std::to_string(announced), "connections and mistakes announced");
  }
  if (!tracked.empty()) out += Tile(Fixed(100 * Mean(tracked), 1) + " %", "of part-frames tracked");
  out += Tile(std::to_string(incidents), "incidents");
  out += "</div>\n";
  if (annotated < trials)
    out +=
        "<p class=\"soft\">" + std::to_string(trials - annotated) + " of " + std::to_string(trials) +
        " trials have no annotation: what is true is not known there, and delays, false alarms and shares leave them "
        "out.</p>\n";
  return out + "</section>\n";
}

std::string Table(const Report& report) {
  if (report.table1.empty()) return "";
  bool paper = false;
  for (const MeasureGroup& g : report.table1) {
    for (const Measure& m : g.measures) paper |= m.paper.has_value();
  }
  std::vector<std::string> head{"", "#value", "", "#k / n", "#95 % interval"};
  if (paper) head.push_back("#paper");
  std::string out = "<section id=\"table1\"><h2>Table I</h2>\n<div class=\"card scroll\"><table>\n" + Header(head);
  for (const MeasureGroup& g : report.table1) {
    out += "<tr><td class=\"heading\" colspan=\"" + std::to_string(head.size()) + "\">" + Escaped(g.title) + " (" +
           std::to_string(g.trials) + (g.trials == 1 ? " trial" : " trials") + ")</td></tr>\n";
    for (const Measure& m : g.measures) {
      const bool known = std::isfinite(m.value);
      if (!known && !m.paper) continue;
      std::string count = m.k   ? std::to_string(*m.k) + " / " + std::to_string(*m.n)
                          : m.n ? "n = " + std::to_string(*m.n)
                                : "";
      out += "<tr>" + Cell(m.name) + NumberCell(Fixed(m.value, 2)) + Cell(known ? m.unit : "", "soft") +
             NumberCell(count) +
             NumberCell(m.interval ? Fixed(m.interval->low, 2) + " " + kDash + " " + Fixed(m.interval->high, 2) : "");
      if (paper) out += NumberCell(m.paper ? Fixed(*m.paper, 2) : " ");
      out += "</tr>\n";
    }
  }
  out += "</table></div>\n";
  std::vector<double> delays, datings;
  for (const SessionReport& s : report.sessions) {
    for (const TrialFigures& f : s.figures) {
      delays.insert(delays.end(), f.delays_connect.begin(), f.delays_connect.end());
      delays.insert(delays.end(), f.delays_wrong.begin(), f.delays_wrong.end());
      datings.insert(datings.end(), f.datings.begin(), f.datings.end());
    }
  }
  if (!delays.empty())
    out += "<div class=\"two\"><div class=\"card\">" +
           Histogram("Announced after the true moment", "s", delays, std::min(-1.0, std::floor(Quantile(delays, 0))),
                     std::max(5.0, std::ceil(Quantile(delays, 0.98)))) +
           "</div><div class=\"card\">" +
           Histogram("Dated off the true moment by", "s", datings, std::min(-2.0, std::floor(Quantile(datings, 0.01))),
                     std::max(2.0, std::ceil(Quantile(datings, 0.99)))) +
           "</div></div>\n";
  return out + "</section>\n";
}

std::string Answers(const Questionnaire& questionnaire) {
  if (questionnaire.questions.empty()) return "";
  std::string out =
      "<section id=\"questionnaire\"><h2>Questionnaire (Table II)</h2>\n<div class=\"card scroll\"><table>\n" +
      Header({"Question", "#n", "#mean", "#sd", "#median"});
  for (const Question& q : questionnaire.questions)
    out += "<tr>" + Cell(q.text) + NumberCell(std::to_string(q.answers.size())) +
           NumberCell(Fixed(Mean(q.answers), 2)) + NumberCell(Fixed(Deviation(q.answers), 2)) +
           NumberCell(Fixed(Median(q.answers), 1)) + "</tr>\n";
  out += "</table>\n";
  if (questionnaire.unreadable > 0)
    out += "<p class=\"soft\">" + std::to_string(questionnaire.unreadable) +
           " answers can't be read and are left out.</p>\n";
  out += "</div>\n<div class=\"two\">\n";
  for (const Question& q : questionnaire.questions) {
    std::vector<Bar> bars;
    for (const auto& [grade, count] : q.Histogram())
      bars.push_back({std::to_string(grade), static_cast<double>(count)});
    out += "<div class=\"card\">" + BarPlot(svg::Shortened(q.text, 60), "grade", bars) + "</div>\n";
  }
  return out + "</div></section>\n";
}

std::string EventTable(const Trial& trial, const Session& session) {
  const TaskNames* names = NamesOf(session, trial.span.task);
  const auto part = [&](int p) -> std::string {
    if (p < 0) return "";
    return names && p < static_cast<int>(names->parts.size()) ? names->parts[static_cast<size_t>(p)]
                                                              : "part " + std::to_string(p + 1);
  };
  std::string out = "<details><summary>Every decision (" + std::to_string(trial.events.size()) +
                    ")</summary><div class=\"scroll\"><table>\n" +
                    Header({"#time", "#dated", "what", "", "parts", "#p", "why, or the words"});
  const auto clock = [&](int64_t utime) { return Clock(static_cast<double>(utime - trial.span.begin) / 1e6, true); };
  for (const GuidanceEvent& e : trial.events) {
    const std::string a = part(e.part_a), b = part(e.part_b);
    out += "<tr>" + NumberCell(clock(e.utime)) + NumberCell(e.since == e.utime ? " " : clock(e.since)) + Cell(e.kind) +
           Cell(e.subject) + Cell(a + (a.empty() || b.empty() ? "" : ", ") + b) +
           NumberCell(e.probability > 0 ? Fixed(e.probability, 2) : " ") + Cell(e.reason) + "</tr>\n";
  }
  return out + "</table></div></details>\n";
}

std::string TrialCard(const Trial& trial, const TrialFigures& f, const Session& session) {
  const std::string state = !trial.span.started ? "<span class=\"tag\">no lesson was started</span>"
                            : f.completed       ? "<span class=\"tag good\">completed</span>"
                                                : "<span class=\"tag bad\">not completed</span>";
  std::string facts = Clock(f.seconds) + " min";
  facts += ", " + std::to_string(f.detected_connections) + " connections and " + std::to_string(f.detected_wrong) +
           " mistakes announced";
  if (f.annotated)
    facts += "; in truth " + std::to_string(f.connections) + " and " + std::to_string(f.wrong) + ", " +
             std::to_string(f.false_alarms) + " false alarms";
  return "<div class=\"card\"><h3>Trial " + std::to_string(trial.number) + " " +
         Escaped(trial.span.task.empty() ? "" : trial.span.task) + " " + state + " <small>" + facts +
         (f.annotated ? "" : "; not annotated") + "</small></h3>\n" + TimelineSvg(trial, session) +
         EventTable(trial, session) + "</div>\n";
}

std::string Latency(const Session& session) {
  std::map<std::string, PlotLine> lines;
  for (const HealthSample& h : session.health) {
    if (h.latency_p50_ms <= 0 && !lines.contains(h.service)) continue;
    PlotLine& line = lines[h.service];
    line.name = h.service;
    line.points.emplace_back(static_cast<double>(h.utime - session.begin) / 1e6,
                             h.latency_p50_ms > 0 ? h.latency_p50_ms : std::nan(""));
  }
  std::vector<PlotLine> shown;
  for (auto& [name, line] : lines) shown.push_back(std::move(line));
  std::vector<double> poses;
  for (const TrackedFrame& f : session.frames) {
    if (f.latency_ms >= 0) poses.push_back(static_cast<double>(f.latency_ms));
  }
  if (shown.empty() && poses.empty()) return "";
  std::string out = "<div class=\"two\">";
  if (!shown.empty())
    out += "<div class=\"card\">" + LinePlot("From capture to each service's answer, median of 5 s", "ms", shown) +
           "</div>";
  if (!poses.empty())
    out += "<div class=\"card\">" +
           Histogram("From capture to pose, frames", "ms", poses, 0, std::max(20.0, Quantile(poses, 0.99))) + "</div>";
  return out + "</div>\n";
}

std::string IncidentTable(const SessionReport& s) {
  if (s.incidents.empty()) return "<div class=\"card\"><h3>Incidents</h3><p class=\"soft\">None.</p></div>\n";
  std::string out = "<div class=\"card\"><h3>Incidents <small>" + std::to_string(s.incidents.size()) +
                    "</small></h3><div class=\"scroll\"><table>\n" + Header({"#time", "#lasted", "", "what"});
  for (const Incident& i : s.incidents)
    out += "<tr>" + NumberCell(Clock(static_cast<double>(i.utime - s.session.begin) / 1e6)) +
           NumberCell(i.seconds > 0 ? Fixed(i.seconds, 1) + " s" : " ") + Cell(ToString(i.kind), "soft") +
           Cell(i.what) + "</tr>\n";
  return out + "</table></div></div>\n";
}

std::string Problems(const Session& session) {
  if (session.problems.empty()) return "";
  std::string out = "<div class=\"problems\"><b>About this log</b><ul>";
  for (const std::string& p : session.problems) out += "<li>" + Escaped(p) + "</li>";
  return out + "</ul></div>\n";
}

std::string SessionSection(const SessionReport& s, size_t number, bool many) {
  std::string out = "<section id=\"session-" + std::to_string(number) + "\">";
  const std::string date = Date(s.session.begin);
  out += "<h2>" + (many ? "Session " + Escaped(s.session.name) : std::string("Trials")) + "</h2>\n";
  if (many)
    out += "<p class=\"soft\">" + (date.empty() ? "" : date + " UTC, ") +
           Clock(static_cast<double>(s.session.end - s.session.begin) / 1e6) + " min</p>\n";
  out += Problems(s.session);
  if (!s.trials.empty()) out += TimelineLegend();
  for (size_t i = 0; i < s.trials.size(); ++i) out += TrialCard(s.trials[i], s.figures[i], s.session);
  if (s.trials.empty()) out += "<div class=\"card\"><p class=\"soft\">Nothing happened in this log.</p></div>\n";
  return out + Latency(s.session) + "<section>" + IncidentTable(s) + "</section></section>\n";
}

std::string Versions(const Report& report) {
  std::map<std::string, std::pair<Configuration, std::set<std::string>>> found;
  bool event_logs = false;
  for (const SessionReport& s : report.sessions) {
    event_logs |= !s.session.has_bus;
    for (const Configuration& c : s.session.configurations) {
      auto& [configuration, sessions] = found[c.service + "\n" + c.version + "\n" + c.sha256];
      configuration = c;
      sessions.insert(s.session.name);
    }
  }
  std::string out = "<section id=\"versions\"><h2>Versions and configuration</h2>\n<div class=\"card\">";
  if (found.empty()) {
    out +=
        event_logs ? "<p class=\"soft\">An event log does not tell.</p>" : "<p class=\"soft\">None was recorded.</p>";
  } else {
    out += "<div class=\"scroll\"><table>\n" + Header({"service", "version", "configuration (sha256)", "sessions"});
    for (const auto& [key, entry] : found)
      out += "<tr>" + Cell(entry.first.service) + Cell(entry.first.version) + Cell(entry.first.sha256.substr(0, 16)) +
             Cell(entry.second.size() == report.sessions.size() ? "all" : List(entry.second)) + "</tr>\n";
    out += "</table></div>\n";
    std::set<std::string> shown;
    for (const auto& [key, entry] : found) {
      if (!shown.insert(entry.first.sha256).second) continue;
      out += "<details><summary>Configuration " + Escaped(entry.first.sha256.substr(0, 16)) + "</summary><pre>" +
             Escaped(entry.first.yaml) + "</pre></details>\n";
    }
  }
  std::set<std::string> tasks;
  for (const SessionReport& s : report.sessions) {
    for (const TaskNames& t : s.session.tasks) tasks.insert(t.name + " (" + t.sha256.substr(0, 16) + ")");
  }
  if (!tasks.empty()) out += "<p>Tasks: " + Escaped(List(tasks)) + "</p>\n";
  return out + "</div></section>\n";
}

std::string Meaning(const Report& report) {
  return "<section id=\"meaning\"><h2>What the figures mean</h2><div class=\"card\">\n"
         "<p>A <b>trial</b> runs from the start of a task until it is first complete, begun anew, another one is "
         "chosen, "
         "or the log ends; what is taken apart afterwards does not count. <b>True</b> events are those an observer "
         "noted; if one comes after a completion that was announced too early, the trial is counted to there.</p>\n"
         "<p>An announced event is <b>matched</b> to a true one of the same kind and of the same two types of parts "
         "(equal "
         "parts may stand for each other), one to one, smallest time difference first, within 20 s. What has no match "
         "is a "
         "<b>false alarm</b>. <b>Announced within</b> x s: not later than x s after the true moment, or after the "
         "first "
         "moment when both parts were at least 0.3 visible if that is later. <b>Dated off by</b>: the estimated moment "
         "of the "
         "event against the true one.</p>\n"
         "<p><b>Intervals</b> are 95 %: bootstrap over whole trials (" +
         std::to_string(report.bootstrap.resamples) + " resamples, seed " + std::to_string(report.bootstrap.seed) +
         "), as what happens within one trial hangs together; Wilson's for a share within a single trial. The column "
         "<b>paper</b> holds the values of the paper's Table I for this kind of task; its trials are not these.</p>\n"
         "</div></section>\n";
}

}  // namespace

std::string PageHtml(const Report& report) {
  const bool many = report.sessions.size() != 1;
  const std::string title =
      many ? std::to_string(report.sessions.size()) + " sessions" : report.sessions[0].session.name;
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" "
      "content=\"default-src 'none'; style-src 'unsafe-inline'\">\n<title>Coach report: " +
      Escaped(title) + "</title>\n<style>" + kStyleSheet + "</style></head><body>\n";
  out += Heading(report) + Navigation(report) + "<main>\n" + Overview(report) + Table(report);
  for (size_t i = 0; i < report.sessions.size(); ++i) out += SessionSection(report.sessions[i], i + 1, many);
  out += Answers(report.questionnaire);
  return out + Versions(report) + Meaning(report) + "</main></body></html>\n";
}

}  // namespace coach
