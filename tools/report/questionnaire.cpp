#include "tools/report/questionnaire.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "tools/report/csv.h"
#include "tools/report/numbers.h"
#include "tools/report/statistics.h"

namespace coach {
namespace {

/// As the teacher's page asks them.
constexpr std::array<const char*, 5> kPageQuestions{
    "Did you like building with the robot?", "Did you understand what the robot told you?",
    "Did the robot help you when you needed it?", "Was it easy to build?", "Would you like to do it again?"};
const std::set<std::string> kNoQuestions{"participant", "child",   "id",    "name", "code",
                                         "date",        "session", "group", "age",  "comment"};

bool Grade(const std::string& text, double& grade) {
  const auto number = ParseNumber(text);
  if (!number || *number < 0 || *number > 100) return false;
  grade = *number;
  return true;
}

char SeparatorOf(std::string_view text) {
  const std::string_view header = text.substr(0, text.find('\n'));
  char best = ',';
  for (const char c : {';', '\t'}) {
    if (std::count(header.begin(), header.end(), c) > std::count(header.begin(), header.end(), best)) best = c;
  }
  return best;
}

}  // namespace

std::map<int, int> Question::Histogram() const {
  std::map<int, int> counts{{1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}};
  for (const double a : answers) ++counts[static_cast<int>(std::lround(a))];
  return counts;
}

Questionnaire ParseQuestionnaire(std::string_view text) {
  Questionnaire out;
  const auto rows = ParseCsv(text, SeparatorOf(text));
  if (rows.empty()) return out;
  std::vector<std::pair<size_t, size_t>> columns;  // of the file, question
  for (size_t c = 0; c < rows[0].size(); ++c) {
    const std::string name = Trimmed(rows[0][c]);
    if (name.empty() || kNoQuestions.contains(Lowered(name))) continue;
    columns.emplace_back(c, out.questions.size());
    out.questions.push_back({name, {}});
  }
  for (size_t r = 1; r < rows.size(); ++r) {
    for (const auto& [column, question] : columns) {
      if (column >= rows[r].size() || Trimmed(rows[r][column]).empty()) continue;
      double grade = 0;
      if (Grade(rows[r][column], grade)) {
        out.questions[question].answers.push_back(grade);
      } else {
        ++out.unreadable;
      }
    }
  }
  return out;
}

Questionnaire QuestionnaireOf(const std::vector<Annotation>& annotations) {
  Questionnaire out;
  for (const Annotation& a : annotations) {
    if (a.kind != "questionnaire") continue;
    const auto number = ParseNumber(a.subject);
    double grade = 0;
    if (!Grade(a.value.substr(0, a.value.find(' ')), grade)) {
      ++out.unreadable;
      continue;
    }
    const bool known = number && *number >= 0 && *number < kPageQuestions.size() && *number == std::floor(*number);
    Merge(out, {{{known ? kPageQuestions[static_cast<size_t>(*number)] : a.subject, {grade}}}, 0});
  }
  return out;
}

void Merge(Questionnaire& a, const Questionnaire& b) {
  for (const Question& q : b.questions) {
    auto found =
        std::find_if(a.questions.begin(), a.questions.end(), [&](const Question& own) { return own.text == q.text; });
    if (found == a.questions.end()) found = a.questions.insert(found, {q.text, {}});
    found->answers.insert(found->answers.end(), q.answers.begin(), q.answers.end());
  }
  a.unreadable += b.unreadable;
}

std::string QuestionnaireCsv(const Questionnaire& questionnaire) {
  std::set<int> grades{1, 2, 3, 4, 5};
  for (const Question& q : questionnaire.questions) {
    for (const auto& [grade, count] : q.Histogram()) grades.insert(grade);
  }
  CsvRow header{"question", "n", "mean", "sd", "median"};
  for (const int grade : grades) header.push_back("grade_" + std::to_string(grade));
  std::string out = CsvLine(header);
  for (const Question& q : questionnaire.questions) {
    CsvRow row{q.text, std::to_string(q.answers.size()), Fixed(Mean(q.answers), 3), Fixed(Deviation(q.answers), 3),
               Fixed(Median(q.answers), 3)};
    const auto histogram = q.Histogram();
    for (const int grade : grades) row.push_back(std::to_string(histogram.contains(grade) ? histogram.at(grade) : 0));
    out += CsvLine(row);
  }
  return out;
}

}  // namespace coach
