// coach-evaluate-reasoner: the paper's connection model and Coach's on the same scripted pose streams, as a table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include "common/assembly/task_file.h"
#include "tools/evaluate_reasoner/event_score.h"

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

void PrintRow(const std::string& task, double noise, const char* model, const EventScore& s, int lessons,
              int near_misses) {
  const double n = std::max(1, s.truths);
  std::printf(
      "| %s | %.0f | %s | %d | %d | %.1f | %.1f | %.2f | %.2f | %.2f | %.1f | %d/%d | %d/%d | %d/%d | %d (%d) |\n",
      task.c_str(), noise * 1000, model, lessons, s.truths, 100 * s.within_1s / n, 100 * s.found / n,
      Quantile(s.delays, 0.5), Quantile(s.delays, 0.95), MedianOfAbsolute(s.dating),
      100.0 * s.found / std::max(1, s.found + s.false_alarms), s.wrong_found, s.wrong_truths, s.unknown_found,
      s.unknown_truths, s.disconnects_found, s.disconnects, s.false_alarms, near_misses);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Connection models compared on scripted pose streams");
  std::vector<std::string> tasks;
  std::vector<double> noises{1, 3, 6};
  int lessons = 20;
  double fps = 30, misses = 0.3, unknown = 0;
  uint64_t seed = 1;
  bool verbose = false, no_paper = false;
  AssemblyReasonerOptions reasoner;
  app.add_option("tasks", tasks, "task files")->required()->check(CLI::ExistingFile);
  app.add_option("--noise", noises, "tracker errors, mm");
  app.add_option("--lessons", lessons, "lessons a row");
  app.add_option("--fps", fps, "frames a second");
  app.add_option("--near-misses", misses, "probability of a near miss before a step");
  app.add_option("--unknown", unknown, "probability of a contact that is on no list before a step");
  app.add_option("--seed", seed, "of the scripts and the errors");
  app.add_option("--decide-probability", reasoner.decide_probability, "from which on a joint is decided");
  app.add_option("--decide-hold", reasoner.decide_hold, "s for which it has to last");
  app.add_option("--forgetting", reasoner.belief.forgetting_time, "s in which new evidence replaces old");
  app.add_option("--price", reasoner.belief.price_connection, "nats against a connection that is not decided");
  app.add_option("--price-mistake", reasoner.belief.price_mistake, "the same for a mistake");
  app.add_flag("--events", verbose, "print every event");
  app.add_flag("--no-paper", no_paper, "Coach's model only");
  CLI11_PARSE(app, argc, argv);
  try {
    std::puts(
        "| task | noise mm | model | lessons | connections | within 1 s % | found % | delay median s | p95 s | dating "
        "error median s | precision % | mistakes found | unknown contacts found | undone found | false alarms (near "
        "misses) |");
    std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for (const std::string& file : tasks) {
      const Task task = LoadTask(file);
      for (const double mm : noises) {
        EventScore coach_score, paper_score;
        int near_misses = 0;
        for (int i = 0; i < lessons; ++i) {
          std::mt19937_64 random(seed * 1000 + static_cast<uint64_t>(i));
          ScriptOptions options;
          options.near_misses = misses;
          options.unknown = unknown;
          TrackerErrors errors;
          errors.position = mm / 1000;
          const auto lesson = PlayScript(task, RandomScript(task, options, random), errors, fps, random());
          near_misses += lesson.near_misses;
          const auto said = Run(task, lesson, reasoner, false);
          const EventScore one = Score(lesson.events, said);
          if (verbose) {
            std::printf("lesson %d: %d of %d, %d false\n", i, one.found, one.truths, one.false_alarms);
            PrintEvents(lesson, said);
          }
          coach_score += one;
          if (!no_paper) paper_score += Score(lesson.events, Run(task, lesson, reasoner, true));
        }
        const std::string name = std::filesystem::path(file).stem().string();
        if (!no_paper) PrintRow(name, mm / 1000, "paper [1]", paper_score, lessons, near_misses);
        PrintRow(name, mm / 1000, "Coach", coach_score, lessons, near_misses);
        std::fflush(stdout);
      }
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coach-evaluate-reasoner: %s\n", e.what());
    return 1;
  }
  return 0;
}
