// coach-evaluate-reasoner: the paper's connection model and Coach's on the same scripted pose streams, as a table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>

#include "common/assembly/task_file.h"
#include "tools/evaluate_reasoner/event_score.h"
#include "tools/evaluate_reasoner/situations.h"

namespace {

using namespace coach;

double Seconds(int64_t utime) { return static_cast<double>(utime) * 1e-6; }

double Quantile(std::vector<double> x, double q) {
  if (x.empty()) return 0;
  std::sort(x.begin(), x.end());
  return x[static_cast<size_t>(q * static_cast<double>(x.size() - 1) + 0.5)];
}

double MedianOfAbsolute(std::vector<double> x) {
  for (double& v : x) v = std::abs(v);
  return Quantile(std::move(x), 0.5);
}

std::vector<ConnectionEvent> Run(const Task& task, const ScriptedLesson& lesson, AssemblyReasonerOptions options,
                                 bool paper) {
  options.paper = paper;
  AssemblyReasoner reasoner(task, options);
  std::vector<ConnectionEvent> events;
  for (const PartPoses& frame : lesson.frames) {
    const ReasonerOutput out = reasoner.Step(frame);
    events.insert(events.end(), out.events.begin(), out.events.end());
  }
  return events;
}

void PrintEvents(const ScriptedLesson& lesson, const std::vector<ConnectionEvent>& said) {
  for (const TrueEvent& e : lesson.events)
    std::printf("  true %7.2f (due %7.2f) %-10s %s %d-%d\n", Seconds(e.moment), Seconds(e.due), e.type.c_str(),
                e.names.empty() ? "" : e.names[0].c_str(), e.part_a, e.part_b);
  for (const ConnectionEvent& e : said)
    std::printf("  said %7.2f (at  %7.2f) %-10s %s %d-%d p %.2f\n", Seconds(e.since), Seconds(e.decided),
                e.type.c_str(), e.name.c_str(), e.part_a, e.part_b, e.probability);
}

void PrintRow(const std::string& name, const char* model, const EventScore& s, size_t lessons, int near_misses) {
  const double n = std::max(1, s.truths);
  std::printf("%s | %s | %zu | %d | %.1f | %.1f | %.2f | %.2f | %.2f | %.1f | %d/%d | %d/%d | %d/%d | %d (%d) |\n",
              name.c_str(), model, lessons, s.truths, 100 * s.within_1s / n, 100 * s.found / n, Quantile(s.delays, 0.5),
              Quantile(s.delays, 0.95), MedianOfAbsolute(s.dating),
              100.0 * s.found / std::max(1, s.found + s.false_alarms), s.wrong_found, s.wrong_truths, s.unknown_found,
              s.unknown_truths, s.disconnects_found, s.disconnects, s.false_alarms, near_misses);
  std::fflush(stdout);
}

struct Options {
  std::vector<std::string> tasks;
  std::vector<double> noises{1, 3, 6};  // mm
  int lessons = 20, orders = 0;
  double fps = 30;
  uint64_t seed = 1;
  bool verbose = false, no_paper = false;
  ScriptOptions script;
  AssemblyReasonerOptions reasoner;
};

/// Of everything something, in random lessons.
Situation Mixed(const Task& task, const Options& options) {
  Situation mixed{"mixed", {}};
  for (int i = 0; i < options.lessons; ++i) {
    std::mt19937_64 random(options.seed * 1000 + static_cast<uint64_t>(i));
    mixed.scripts.push_back(RandomScript(task, options.script, random));
  }
  return mixed;
}

/// Rows of both models for one situation under one noise.
void Compare(const Task& task, const Situation& situation, double millimetres, const Options& options) {
  EventScore coach_score, paper_score;
  int near_misses = 0;
  TrackerErrors errors;
  errors.position = millimetres / 1000;
  for (size_t i = 0; i < situation.scripts.size(); ++i) {
    std::mt19937_64 random(options.seed * 1000 + i);
    const auto lesson = PlayScript(task, situation.scripts[i], errors, options.fps, random());
    near_misses += lesson.near_misses;
    const auto said = Run(task, lesson, options.reasoner, false);
    const EventScore one = Score(lesson.events, said);
    if (options.verbose) {
      std::printf("lesson %zu: %d of %d, %d false\n", i, one.found, one.truths, one.false_alarms);
      PrintEvents(lesson, said);
    }
    coach_score += one;
    if (!options.no_paper) paper_score += Score(lesson.events, Run(task, lesson, options.reasoner, true));
  }
  char noise[32];
  std::snprintf(noise, sizeof noise, " | %.0f | ", millimetres);
  const std::string name = "| " + task.name + noise + situation.name;
  if (!options.no_paper) PrintRow(name, "paper [1]", paper_score, situation.scripts.size(), near_misses);
  PrintRow(name, "Coach", coach_score, situation.scripts.size(), near_misses);
}

void Evaluate(const Options& options) {
  std::puts(
      "| task | noise mm | situation | model | lessons | connections | within 1 s % | found % | delay median s | p95 s "
      "| "
      "dating error median s | precision % | mistakes found | unknown contacts found | undone found | false alarms "
      "(near misses) |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (const std::string& file : options.tasks) {
    const Task task = LoadTask(file);
    std::vector<Situation> situations{Mixed(task, options)};
    if (options.orders > 0) situations = Situations(task, options.orders);
    for (const double millimetres : options.noises) {
      for (const Situation& situation : situations) Compare(task, situation, millimetres, options);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Connection models compared on scripted pose streams");
  Options o;
  app.add_option("tasks", o.tasks, "task files")->required()->check(CLI::ExistingFile);
  app.add_option("--noise", o.noises, "tracker errors, mm");
  app.add_option("--lessons", o.lessons, "lessons a row");
  app.add_option("--situations", o.orders,
                 "instead of random lessons a row for every situation: so many orders of the steps and assignments of "
                 "equal parts, the same under the hands, every mistake, every undoing, near misses of 5 to 30 mm");
  app.add_option("--fps", o.fps, "frames a second");
  app.add_option("--near-misses", o.script.near_misses, "probability of a near miss before a step");
  app.add_option("--unknown", o.script.unknown, "probability of a contact that is on no list before a step");
  app.add_option("--seed", o.seed, "of the scripts and the errors");
  app.add_option("--decide-probability", o.reasoner.decide_probability, "from which on a joint is decided");
  app.add_option("--decide-hold", o.reasoner.decide_hold, "s for which it has to last");
  app.add_option("--forgetting", o.reasoner.belief.forgetting_time, "s in which new evidence replaces old");
  app.add_option("--price", o.reasoner.belief.price_connection, "nats against a connection that is not decided");
  app.add_option("--price-mistake", o.reasoner.belief.price_mistake, "the same for a mistake");
  app.add_flag("--events", o.verbose, "print every event");
  app.add_flag("--no-paper", o.no_paper, "Coach's model only");
  CLI11_PARSE(app, argc, argv);
  try {
    Evaluate(o);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coach-evaluate-reasoner: %s\n", e.what());
    return 1;
  }
  return 0;
}
