#include "tools/report/table1.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace coach {
namespace {

using Sample = std::vector<const TrialFigures*>;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Count {
  int k = 0, n = 0;
  double share() const { return n > 0 ? static_cast<double>(k) / n : kNone; }
};

std::vector<double> Delays(const Sample& sample, bool connect, bool wrong) {
  std::vector<double> all;
  for (const TrialFigures* f : sample) {
    if (connect) all.insert(all.end(), f->delays_connect.begin(), f->delays_connect.end());
    if (wrong) all.insert(all.end(), f->delays_wrong.begin(), f->delays_wrong.end());
  }
  return all;
}

/// Events announced within so many seconds of their moment, of those that happened.
Count Within(const Sample& sample, double limit, bool connect, bool wrong) {
  Count count;
  for (const TrialFigures* f : sample) {
    if (!f->annotated) continue;
    count.n += (connect ? f->connections : 0) + (wrong ? f->wrong : 0);
  }
  const auto delays = Delays(sample, connect, wrong);
  count.k =
      static_cast<int>(std::count_if(delays.begin(), delays.end(), [&](double d) { return std::abs(d) <= limit; }));
  return count;
}

struct Row {
  const char* name;
  const char* unit;
  std::function<Count(const Sample&)> count;                 ///< of a share; else empty
  std::function<std::vector<double>(const Sample&)> values;  ///< of a mean or median; else empty
  double (*summary)(const std::vector<double>&) = Mean;
  double paper_rectangles = kNone, paper_square = kNone;
};

double MedianOf(const std::vector<double>& v) { return Median(v); }
double MedianSize(const std::vector<double>& v) {
  std::vector<double> sizes;
  for (const double x : v) sizes.push_back(std::abs(x));
  return Median(sizes);
}

std::function<std::vector<double>(const Sample&)> Each(std::function<double(const TrialFigures&)> of) {
  return [of = std::move(of)](const Sample& sample) {
    std::vector<double> values;
    for (const TrialFigures* f : sample) {
      const double value = of(*f);
      if (std::isfinite(value)) values.push_back(value);
    }
    return values;
  };
}

Row PerTrial(const char* name, int TrialFigures::*member) {
  return {name, "a trial", {}, Each([member](const TrialFigures& f) { return static_cast<double>(f.*member); })};
}

const std::vector<Row>& Rows() {
  static const std::vector<Row> rows = [] {
    const auto within = [](double limit, bool wrong) {
      return [=](const Sample& s) { return Within(s, limit, true, wrong); };
    };
    const auto datings = [](const Sample& s) {
      std::vector<double> all;
      for (const TrialFigures* f : s) all.insert(all.end(), f->datings.begin(), f->datings.end());
      return all;
    };
    const auto annotated = [](double value, const TrialFigures& f) { return f.annotated ? value : kNone; };
    std::vector<Row> r{
        {"Completed",
         "%",
         [](const Sample& s) {
           Count c;
           for (const TrialFigures* f : s) c.k += f->completed;
           c.n = static_cast<int>(s.size());
           return c;
         },
         {}},
        {"Time to completion, mean",
         "s",
         {},
         Each([](const TrialFigures& f) { return f.completed ? f.seconds : kNone; }),
         Mean,
         48.49,
         110.09},
        {"Mistakes a trial",
         "",
         {},
         Each([](const TrialFigures& f) { return static_cast<double>(f.wrong); }),
         Mean,
         0.86,
         0.67},
        {"Announced after, median",
         "s",
         {},
         [](const Sample& s) { return Delays(s, true, true); },
         MedianSize,
         3.42,
         7.02},
        {"All announced within 1 s", "%", within(1, true), {}},
        {"All announced within 5 s", "%", within(5, true), {}, Mean, 50.0, 43.2},
        {"All announced within 20 s", "%", within(20, true), {}, Mean, 56.3, 59.5},
        {"Correct ones within 1 s", "%", within(1, false), {}},
        {"Correct ones within 5 s", "%", within(5, false), {}, Mean, 70.0, 39.4},
        {"Correct ones within 20 s", "%", within(20, false), {}, Mean, 80.0, 57.6},
        {"Mistakes found", "%", [](const Sample& s) { return Within(s, 20, false, true); }, {}},
        {"Dated off by, median", "s", {}, datings, MedianSize},
        {"Dated off by, signed median", "s", {}, datings, MedianOf},
        {"Right among what was announced (precision)",
         "%",
         [](const Sample& s) {
           Count c;
           for (const TrialFigures* f : s) {
             if (!f->annotated) continue;
             c.k += f->reported - f->false_alarms;
             c.n += f->reported;
           }
           return c;
         },
         {}},
        {"False alarms", "a trial", {}, Each([annotated](const TrialFigures& f) {
           return annotated(f.false_alarms, f);
         })},
        PerTrial("Undone", &TrialFigures::undone),
        PerTrial("Sentences of the robot", &TrialFigures::spoken),
        PerTrial("Praise", &TrialFigures::praise),
        PerTrial("Corrections", &TrialFigures::corrections),
        PerTrial("Corrections taken back", &TrialFigures::repairs),
        PerTrial("Hints", &TrialFigures::hints),
        PerTrial("Orders of the operator", &TrialFigures::operator_orders),
        {"Part-frames tracked, mean of trials", "%", {}, Each([](const TrialFigures& f) {
           return f.tracked_share < 0 ? kNone : 100 * f.tracked_share;
         })},
        {"Exchanges of equal parts", "a trial", {}, Each([](const TrialFigures& f) {
           return f.tracked_share < 0 ? kNone : f.exchanges;
         })},
        {"Capture to pose, median of trials",
         "ms",
         {},
         Each([](const TrialFigures& f) { return f.latency_ms < 0 ? kNone : f.latency_ms; }),
         MedianOf},
        {"Capture to pose, 99 %, median of trials",
         "ms",
         {},
         Each([](const TrialFigures& f) { return f.latency_p99_ms < 0 ? kNone : f.latency_p99_ms; }),
         MedianOf},
    };
    return r;
  }();
  return rows;
}

double Value(const Row& row, const Sample& sample) {
  return row.count ? 100 * row.count(sample).share() : row.summary(row.values(sample));
}

Measure MeasureOf(const Row& row, const Sample& sample, double paper, const BootstrapOptions& options) {
  Measure m;
  m.name = row.name;
  m.unit = row.unit;
  m.value = Value(row, sample);
  if (std::isfinite(paper)) m.paper = paper;
  if (row.count) {
    const Count c = row.count(sample);
    m.k = c.k;
    m.n = c.n;
  } else {
    m.n = static_cast<int>(row.values(sample).size());
  }
  if (!std::isfinite(m.value)) return m;
  m.interval = BootstrapInterval(
      sample.size(),
      [&](const std::vector<size_t>& drawn) {
        Sample resampled;
        for (const size_t i : drawn) resampled.push_back(sample[i]);
        return Value(row, resampled);
      },
      options);
  if (m.interval) {
    m.method = "bootstrap";
  } else if (row.count) {
    m.interval = WilsonInterval(*m.k, *m.n);
    m.interval->low *= 100;
    m.interval->high *= 100;
    m.method = "Wilson";
  }
  return m;
}

enum class Kind { kAll, kRectangles, kSquare, kOther };

MeasureGroup Group(const std::string& title, Kind kind, const Sample& sample, const BootstrapOptions& options) {
  MeasureGroup group{title, static_cast<int>(sample.size()), {}};
  for (const Row& row : Rows()) {
    const double paper = kind == Kind::kRectangles ? row.paper_rectangles
                         : kind == Kind::kSquare   ? row.paper_square
                                                   : kNone;
    group.measures.push_back(MeasureOf(row, sample, paper, options));
  }
  return group;
}

}  // namespace

TrialFigures FiguresOf(const Trial& trial, const Session& session) {
  TrialFigures f;
  f.annotated = trial.annotated;
  f.completed = trial.span.completed;
  f.seconds = trial.seconds();
  for (const DetectedEvent& d : trial.detected) {
    f.detected_connections += d.event.kind == "connect";
    f.detected_wrong += d.event.kind == "wrong";
    f.undone += d.event.kind == "disconnect";
    if (d.event.kind == "disconnect") continue;
    ++f.reported;
    f.false_alarms += trial.annotated && !d.truth;
  }
  f.connections = f.detected_connections;
  f.wrong = f.detected_wrong;
  if (trial.annotated) f.connections = f.wrong = 0;
  for (const TrueEvent& t : trial.truth) {
    if (t.annotation.kind == "disconnect") continue;
    const bool wrong = t.annotation.kind == "wrong";
    ++(wrong ? f.wrong : f.connections);
    if (!t.detected) continue;
    (wrong ? f.delays_wrong : f.delays_connect).push_back(t.delay);
    f.datings.push_back(t.dating);
  }
  for (const GuidanceEvent& e : trial.events) {
    f.spoken += e.kind == "say";
    f.praise += e.kind == "say" && (e.subject == "praise" || e.subject == "complete");
    f.corrections += e.kind == "say" && e.subject.starts_with("wrong");
    f.hints += e.kind == "say" && e.subject.starts_with("idle");
    f.repairs += e.kind == "repair";
    f.operator_orders += e.kind == "operator" && e.subject != "start";
  }
  int64_t tracked = 0, all = 0;
  std::vector<double> latencies;
  for (const TrackedFrame& frame : session.frames) {
    if (frame.utime < trial.span.begin || frame.utime > trial.span.end) continue;
    for (const TrackedFrame::Part& part : frame.parts) tracked += part.status == PartStatus::kTracked;
    all += static_cast<int64_t>(frame.parts.size());
    f.exchanges += frame.exchanges;
    if (frame.latency_ms >= 0) latencies.push_back(static_cast<double>(frame.latency_ms));
  }
  if (all > 0) f.tracked_share = static_cast<double>(tracked) / static_cast<double>(all);
  if (!latencies.empty()) {
    f.latency_ms = Median(latencies);
    f.latency_p99_ms = Quantile(latencies, 0.99);
  }
  return f;
}

std::vector<MeasureGroup> Table1(const std::vector<Trial>& trials, const std::vector<TrialFigures>& figures,
                                 const BootstrapOptions& options) {
  Sample all;
  std::map<std::pair<Kind, std::string>, Sample> by_task;
  for (size_t i = 0; i < trials.size(); ++i) {
    const std::string& task = trials[i].span.task;
    const Kind kind = task.starts_with("rectangle") ? Kind::kRectangles
                      : task.starts_with("square")  ? Kind::kSquare
                                                    : Kind::kOther;
    const std::string title = kind == Kind::kRectangles ? "Rectangles"
                              : kind == Kind::kSquare   ? "Square"
                              : task.empty()            ? "Unknown task"
                                                        : task;
    by_task[{kind, title}].push_back(&figures[i]);
    all.push_back(&figures[i]);
  }
  std::vector<MeasureGroup> groups;
  if (by_task.size() != 1) groups.push_back(Group("All trials", Kind::kAll, all, options));
  for (const auto& [key, sample] : by_task) groups.push_back(Group(key.second, key.first, sample, options));
  return groups;
}

}  // namespace coach
