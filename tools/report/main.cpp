// coach-report: what happened in one or more sessions, as tables, a page and a PDF.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "tools/report/annotation_files.h"
#include "tools/report/page.h"
#include "tools/report/pdf.h"
#include "tools/report/session_files.h"
#include "tools/report/tables.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

void Write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error(file.string() + ": can't be written");
}

void WriteAnnotations(const Report& report, const fs::path& folder) {
  for (const SessionReport& s : report.sessions) {
    const Session& session = s.session;
    const int64_t origin = session.frames.empty() ? session.begin : session.frames.front().utime;
    const fs::path stem = folder / (session.name + ".annotations");
    Write(stem.string() + ".elan.txt", ElanText(session.annotations, session.events, origin));
    Write(stem.string() + ".boris.csv", BorisCsv(session.annotations, session.events, origin, session.name));
  }
}

/// Two files of one name would overwrite each other's annotations.
void TellNamesApart(std::vector<Session>& sessions) {
  for (size_t i = 1; i < sessions.size(); ++i) {
    const std::string name = sessions[i].name;
    int number = 2;
    const auto taken = [&] {
      for (size_t k = 0; k < i; ++k) {
        if (sessions[k].name == sessions[i].name) return true;
      }
      return false;
    };
    while (taken()) sessions[i].name = name + "_" + std::to_string(number++);
  }
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  using namespace coach;
  CLI::App app(
      "What happened in one or more sessions: events.csv, trials.csv, table1.csv, incidents.csv, questionnaire.csv, "
      "annotations for ELAN and BORIS, report.html. The same logs give the same files, byte for byte (the PDF apart).",
      "coach-report");
  std::vector<std::string> paths;
  std::string folder = "report", questionnaire;
  SessionOptions options;
  BootstrapOptions bootstrap;
  bool pdf = false;
  app.add_option(
         "SESSION", paths,
         "recording of the bus (*.lcm), the reasoner's event log (*.jsonl), or a folder with the recordings of one "
         "session; annotations beside it (NAME.annotations.txt, .csv, .jsonl, .json) are read with it")
      ->required();
  app.add_option("--out,-o", folder, "folder of the report, made if it is missing")->capture_default_str();
  app.add_option(
      "--annotations", options.annotations,
      "ELAN's tab-delimited text (.txt), BORIS's events (.csv), the page's annotations (.jsonl) or a scene's "
      "events (.json); with one SESSION only");
  app.add_option("--annotation-offset", options.annotation_offset,
                 "s after the session's first frame at which the annotated video begins")
      ->capture_default_str();
  app.add_option("--annotator", options.annotator, "whose events are the truth (default: who noted most)");
  app.add_option("--questionnaire", questionnaire, "answers (csv): a column a question, a row a participant");
  app.add_option("--station", options.station,
                 "of a recording that holds several (default: the one with most messages)");
  app.add_option("--resamples", bootstrap.resamples, "of the bootstrap")
      ->capture_default_str()
      ->check(CLI::Range(100, 100000));
  app.add_option("--seed", bootstrap.seed, "of the bootstrap")->capture_default_str();
  app.add_flag("--pdf", pdf, "also report.pdf, by an installed Chromium");
  CLI11_PARSE(app, argc, argv);
  try {
    if (paths.size() > 1 && !options.annotations.empty())
      throw std::runtime_error("--annotations goes with one SESSION; put the file beside each: NAME.annotations.txt");
    std::vector<Session> sessions;
    for (const std::string& path : paths) sessions.push_back(ReadSession(path, options));
    TellNamesApart(sessions);
    for (const Session& session : sessions) {
      for (const std::string& problem : session.problems)
        std::fprintf(stderr, "coach-report: %s: %s\n", session.name.c_str(), problem.c_str());
    }
    Questionnaire answers;
    if (!questionnaire.empty()) answers = ParseQuestionnaire(ReadFile(questionnaire));
    const Report report = MakeReport(std::move(sessions), std::move(answers), bootstrap);
    const fs::path out = folder;
    fs::create_directories(out);
    Write(out / "events.csv", EventsCsv(report));
    Write(out / "trials.csv", TrialsCsv(report));
    Write(out / "table1.csv", Table1Csv(report));
    Write(out / "incidents.csv", IncidentsCsv(report));
    if (!report.questionnaire.questions.empty())
      Write(out / "questionnaire.csv", QuestionnaireCsv(report.questionnaire));
    WriteAnnotations(report, out);
    Write(out / "report.html", PageHtml(report));
    if (pdf) PrintPdf(out / "report.html", out / "report.pdf");
    std::printf("%s\n", (out / "report.html").c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "coach-report: %s\n", error.what());
    return 1;
  }
}
