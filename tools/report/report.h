// Everything that a report shows, put together from its sessions.
#pragma once

#include <vector>

#include "tools/report/incidents.h"
#include "tools/report/questionnaire.h"
#include "tools/report/session.h"
#include "tools/report/table1.h"
#include "tools/report/trials.h"

namespace coach {

struct SessionReport {
  Session session;
  std::vector<Trial> trials;
  std::vector<TrialFigures> figures;  ///< of each trial
  std::vector<Incident> incidents;
};

struct Report {
  std::vector<SessionReport> sessions;
  std::vector<MeasureGroup> table1;
  Questionnaire questionnaire;
  BootstrapOptions bootstrap;
};

/// @param answers of a questionnaire on paper; those given on the teacher's page are added
Report MakeReport(std::vector<Session> sessions, Questionnaire answers, const BootstrapOptions& bootstrap = {});

}  // namespace coach
