#include "tools/report/tables.h"

#include <algorithm>
#include <limits>

#include "tools/report/csv.h"
#include "tools/report/numbers.h"

namespace coach {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string Time(int64_t utime, const Session& session) {
  return Fixed(static_cast<double>(utime - session.begin) / 1e6, 3);
}

std::string PartName(const Session& session, const Trial* trial, int part) {
  if (part < 0) return "";
  const TaskNames* names = NamesOf(session, trial ? trial->span.task : "");
  if (names && part < static_cast<int>(names->parts.size())) return names->parts[static_cast<size_t>(part)];
  return "part " + std::to_string(part + 1);
}

const Trial* TrialAt(const SessionReport& report, const GuidanceEvent& e) {
  for (const Trial& t : report.trials) {
    if (std::any_of(t.events.begin(), t.events.end(), [&](const GuidanceEvent& own) {
          return own.id == e.id && own.utime == e.utime && own.kind == e.kind && own.subject == e.subject;
        }))
      return &t;
  }
  return nullptr;
}

CsvRow CoachRow(const SessionReport& report, const GuidanceEvent& e) {
  const Session& session = report.session;
  const Trial* trial = TrialAt(report, e);
  CsvRow row{session.name,
             trial ? std::to_string(trial->number) : "",
             "coach",
             Time(e.since, session),
             Time(e.utime, session),
             e.kind,
             e.subject,
             PartName(session, trial, e.part_a),
             PartName(session, trial, e.part_b),
             e.probability > 0 ? Fixed(e.probability, 3) : ""};
  const TrueEvent* truth = nullptr;
  bool compared = false;
  for (size_t d = 0; trial && d < trial->detected.size(); ++d) {
    const DetectedEvent& detected = trial->detected[d];
    if (detected.event.id != e.id || detected.event.utime != e.utime || detected.event.kind != e.kind ||
        detected.event.subject != e.subject)
      continue;
    compared = trial->annotated;
    if (detected.truth) truth = &trial->truth[*detected.truth];
  }
  row.push_back(!compared ? "" : truth ? "yes" : "no");
  row.push_back(truth ? Fixed(truth->delay, 3) : "");
  row.push_back(truth ? Fixed(truth->dating, 3) : "");
  row.push_back("");
  row.push_back(e.reason);
  return row;
}

CsvRow ObserverRow(const SessionReport& report, const Annotation& a) {
  std::string number, matched, delay, dating;
  for (const Trial& trial : report.trials) {
    for (const TrueEvent& t : trial.truth) {
      if (t.annotation.id != a.id || t.annotation.utime != a.utime || t.annotation.subject != a.subject ||
          t.annotation.kind != a.kind)
        continue;
      number = std::to_string(trial.number);
      matched = t.detected ? "yes" : "no";
      delay = t.detected ? Fixed(t.delay, 3) : "";
      dating = t.detected ? Fixed(t.dating, 3) : "";
    }
  }
  return {report.session.name,
          number,
          "observer",
          Time(a.utime, report.session),
          "",
          a.kind,
          a.subject,
          "",
          "",
          "",
          matched,
          delay,
          dating,
          a.annotator,
          a.value};
}

std::string Optional(double value, int digits) { return value < 0 ? "" : Fixed(value, digits); }

}  // namespace

std::string EventsCsv(const Report& report) {
  std::string out = CsvLine({"session", "trial", "source", "time", "decided", "kind", "subject", "part_a", "part_b",
                             "probability", "matched", "delay", "dating", "annotator", "reason"});
  for (const SessionReport& s : report.sessions) {
    std::vector<std::pair<int64_t, CsvRow>> rows;
    for (const GuidanceEvent& e : s.session.events) rows.emplace_back(e.utime, CoachRow(s, e));
    for (const Annotation& a : s.session.annotations) rows.emplace_back(a.utime, ObserverRow(s, a));
    std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [utime, row] : rows) out += CsvLine(row);
  }
  return out;
}

std::string TrialsCsv(const Report& report) {
  std::string out = CsvLine({"session",
                             "trial",
                             "station",
                             "date",
                             "task",
                             "begin",
                             "seconds",
                             "completed",
                             "annotated",
                             "connections",
                             "mistakes",
                             "announced_connections",
                             "announced_mistakes",
                             "undone",
                             "found",
                             "false_alarms",
                             "delay_median",
                             "dating_median",
                             "sentences",
                             "praise",
                             "corrections",
                             "taken_back",
                             "hints",
                             "operator_orders",
                             "tracked_share",
                             "exchanges",
                             "latency_median_ms",
                             "latency_p99_ms"});
  for (const SessionReport& s : report.sessions) {
    for (size_t i = 0; i < s.trials.size(); ++i) {
      const Trial& t = s.trials[i];
      const TrialFigures& f = s.figures[i];
      std::vector<double> delays = f.delays_connect;
      delays.insert(delays.end(), f.delays_wrong.begin(), f.delays_wrong.end());
      const auto known = [&](int value) { return f.annotated ? std::to_string(value) : ""; };
      out += CsvLine({t.session,
                      std::to_string(t.number),
                      s.session.station,
                      Date(t.span.begin),
                      t.span.task,
                      Time(t.span.begin, s.session),
                      Fixed(f.seconds, 3),
                      f.completed ? "yes" : "no",
                      f.annotated ? "yes" : "no",
                      known(f.connections),
                      known(f.wrong),
                      std::to_string(f.detected_connections),
                      std::to_string(f.detected_wrong),
                      std::to_string(f.undone),
                      known(static_cast<int>(delays.size())),
                      known(f.false_alarms),
                      Fixed(Median(delays), 3),
                      Fixed(f.datings.empty() ? kNone : Median(f.datings), 3),
                      std::to_string(f.spoken),
                      std::to_string(f.praise),
                      std::to_string(f.corrections),
                      std::to_string(f.repairs),
                      std::to_string(f.hints),
                      std::to_string(f.operator_orders),
                      Optional(f.tracked_share, 4),
                      f.tracked_share < 0 ? "" : std::to_string(f.exchanges),
                      Optional(f.latency_ms, 1),
                      Optional(f.latency_p99_ms, 1)});
    }
  }
  return out;
}

std::string Table1Csv(const Report& report) {
  std::string out =
      CsvLine({"group", "trials", "measure", "unit", "value", "k", "n", "low", "high", "interval", "paper"});
  const auto count = [](std::optional<int> n) { return n ? std::to_string(*n) : ""; };
  for (const MeasureGroup& g : report.table1) {
    for (const Measure& m : g.measures) {
      out += CsvLine({g.title, std::to_string(g.trials), m.name, m.unit, Fixed(m.value, 3), count(m.k), count(m.n),
                      m.interval ? Fixed(m.interval->low, 3) : "", m.interval ? Fixed(m.interval->high, 3) : "",
                      m.method, m.paper ? Fixed(*m.paper, 2) : ""});
    }
  }
  return out;
}

std::string IncidentsCsv(const Report& report) {
  std::string out = CsvLine({"session", "time", "seconds", "kind", "what"});
  for (const SessionReport& s : report.sessions) {
    for (const std::string& problem : s.session.problems) out += CsvLine({s.session.name, "", "", "log", problem});
    for (const Incident& i : s.incidents)
      out += CsvLine({s.session.name, Time(i.utime, s.session), Fixed(i.seconds, 1), ToString(i.kind), i.what});
  }
  return out;
}

}  // namespace coach
