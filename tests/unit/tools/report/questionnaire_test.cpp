#include "tools/report/questionnaire.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace coach {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

TEST(Questionnaire, AColumnAQuestion) {
  const auto q =
      ParseQuestionnaire("Participant;Was it fun?;Was it easy?;Comment\nc1;5;2;so <fun>\nc2;4;;\nc3;often;3;\n");
  ASSERT_EQ(q.questions.size(), 2u);
  EXPECT_EQ(q.questions[0].text, "Was it fun?");
  EXPECT_THAT(q.questions[0].answers, ElementsAre(5, 4));
  EXPECT_THAT(q.questions[1].answers, ElementsAre(2, 3));
  EXPECT_EQ(q.unreadable, 1);
  EXPECT_THAT(q.questions[0].Histogram(), ElementsAre(Pair(1, 0), Pair(2, 0), Pair(3, 0), Pair(4, 1), Pair(5, 1)));
}

TEST(Questionnaire, MeansWithTheirNumber) {
  EXPECT_EQ(QuestionnaireCsv(ParseQuestionnaire("a,b\n1,7\n2,7\n4,\n")),
            "question,n,mean,sd,median,grade_1,grade_2,grade_3,grade_4,grade_5,grade_7\n"
            "a,3,2.333,1.528,2.000,1,1,0,1,0,0\nb,2,7.000,0.000,7.000,0,0,0,0,0,2\n");
}

TEST(Questionnaire, EmptyAndOddFiles) {
  EXPECT_TRUE(ParseQuestionnaire("").questions.empty());
  EXPECT_TRUE(ParseQuestionnaire("id,name\n1,x\n").questions.empty());
  const auto no_rows = ParseQuestionnaire("How was it?\n");
  ASSERT_EQ(no_rows.questions.size(), 1u);
  EXPECT_EQ(QuestionnaireCsv(no_rows),
            "question,n,mean,sd,median,grade_1,grade_2,grade_3,grade_4,grade_5\nHow was it?,0,,,,0,0,0,0,0\n");
  EXPECT_EQ(ParseQuestionnaire("q\n-1\n1e9\n").unreadable, 2);
}

Annotation Answer(const std::string& subject, const std::string& value) {
  return {0, 0, "", "questionnaire", subject, value, 0};
}

TEST(Questionnaire, AnswersFromThePage) {
  const auto q = QuestionnaireOf({Answer("0", "5 c1"),
                                  Answer("0", "3"),
                                  Answer("4", "2 c1"),
                                  Answer("x", "1"),
                                  Answer("1", "?"),
                                  {0, 0, "", "note", "0", "5", 0}});
  ASSERT_EQ(q.questions.size(), 3u);
  EXPECT_THAT(q.questions[0].answers, ElementsAre(5, 3));
  EXPECT_EQ(q.questions[2].text, "x");
  EXPECT_EQ(q.unreadable, 1);
}

TEST(Questionnaire, QuestionsAreCalledWhatThePageCallsThem) {
  std::ifstream file(COACH_SOURCE_DIR "/tools/operator/page/words.js");
  std::stringstream words;
  words << file.rdbuf();
  for (const char* number : {"0", "1", "2", "3", "4"})
    EXPECT_THAT(words.str(), HasSubstr("'" + QuestionnaireOf({Answer(number, "1")}).questions[0].text + "'"));
}

TEST(Questionnaire, PaperAndPageGoTogether) {
  auto q = ParseQuestionnaire("Was it easy to build?\n2\n");
  Merge(q, QuestionnaireOf({Answer("3", "4")}));
  ASSERT_EQ(q.questions.size(), 1u);
  EXPECT_THAT(q.questions[0].answers, ElementsAre(2, 4));
}

}  // namespace
}  // namespace coach
