#include "tools/study/experiments.h"

#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "tools/study/ablation.h"
#include "tools/study/fig4_study.h"
#include "tools/study/guidance_study.h"
#include "tools/study/start_study.h"
#include "tools/study/table1_study.h"

namespace coach {

std::vector<std::string> Experiment::Units(int n) const {
  std::vector<std::string> units;
  for (int i = 1; i <= n; ++i) {
    std::ostringstream unit;
    unit << name() << "-" << std::setw(4) << std::setfill('0') << i;
    units.push_back(unit.str());
  }
  return units;
}

const Experiment& FindExperiment(const std::string& name) {
  static const Fig4Study fig4;
  static const StartStudy start;
  static const Table1Study table1;
  static const GuidanceStudy guidance;
  static const AblationStudy ablation;
  for (const Experiment* e : std::initializer_list<const Experiment*>{&fig4, &start, &table1, &guidance, &ablation}) {
    if (e->name() == name) return *e;
  }
  throw std::invalid_argument("study: found " + name + ", expected fig4, start, table1, guidance or ablation");
}

}  // namespace coach
