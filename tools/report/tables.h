// A report as tables for other programs (csv with a header, times in s).
#pragma once

#include <string>

#include "tools/report/report.h"

namespace coach {

/// session,trial,source,time,decided,kind,subject,part_a,part_b,probability,matched,delay,dating,annotator,reason:
/// every decision (source coach) and every annotation (source observer), times from the session's begin; trial is empty
/// outside of one; matched is yes or no where there is a truth to compare with.
std::string EventsCsv(const Report& report);
/// One row a trial.
std::string TrialsCsv(const Report& report);
/// group,trials,measure,unit,value,k,n,low,high,interval,paper
std::string Table1Csv(const Report& report);
/// session,time,seconds,kind,what
std::string IncidentsCsv(const Report& report);

}  // namespace coach
