// Answers of children and teachers (the paper's Table II): means with n, and how often each grade was given.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/operator/annotations.h"

namespace coach {

struct Question {
  std::string text;
  std::vector<double> answers;  ///< in the order of the file
  /// Grades (rounded to whole numbers) with the number of answers; 1 to 5 are always there.
  std::map<int, int> Histogram() const;
};

struct Questionnaire {
  std::vector<Question> questions;
  int unreadable = 0;  ///< answers that are no number from 0 to 100
};

/// A table with a header: each column is a question and each row somebody's answers. Columns that are called
/// participant, child, id, name, code, date, session, group, age or comment are left aside; an empty field is no
/// answer. Separators are commas, semicolons or tabs, whichever the header has most of.
Questionnaire ParseQuestionnaire(std::string_view text);

/// The answers given on the teacher's page (annotations of kind "questionnaire": subject is the question's number,
/// value the grade and the child's code).
Questionnaire QuestionnaireOf(const std::vector<Annotation>& annotations);

/// Adds b's answers to a's questions of the same text.
void Merge(Questionnaire& a, const Questionnaire& b);

/// question,n,mean,sd,median,grade_1,...
std::string QuestionnaireCsv(const Questionnaire& questionnaire);

}  // namespace coach
