#include "tools/report/report.h"

namespace coach {

Report MakeReport(std::vector<Session> sessions, Questionnaire answers, const BootstrapOptions& bootstrap) {
  Report report;
  report.bootstrap = bootstrap;
  report.questionnaire = std::move(answers);
  std::vector<Trial> trials;
  std::vector<TrialFigures> figures;
  for (Session& session : sessions) {
    SessionReport part;
    part.trials = Trials(session);
    for (const Trial& trial : part.trials) part.figures.push_back(FiguresOf(trial, session));
    part.incidents = Incidents(session);
    Merge(report.questionnaire, QuestionnaireOf(session.annotations));
    part.session = std::move(session);
    trials.insert(trials.end(), part.trials.begin(), part.trials.end());
    figures.insert(figures.end(), part.figures.begin(), part.figures.end());
    report.sessions.push_back(std::move(part));
  }
  if (!trials.empty()) report.table1 = Table1(trials, figures, bootstrap);
  return report;
}

}  // namespace coach
