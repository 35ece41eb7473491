// The operator overrides the lesson, or is refused with a reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "classroom.h"

namespace coach {
namespace {

TEST(Lesson, OperatorCommandsInTheWrongPhaseAreRefusedWithAnEvent) {
  Classroom room(7);
  for (const auto kind : {OperatorKind::kPause, OperatorKind::kResume, OperatorKind::kSkip, OperatorKind::kHelp,
                          OperatorKind::kRepeat, OperatorKind::kMarkDone}) {
    const LessonOutput out = room.Operator(kind);
    ASSERT_FALSE(out.events.empty());
    EXPECT_THAT(out.events.back().reason, testing::StartsWith("refused"));
    EXPECT_TRUE(out.commands.empty());
  }
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  EXPECT_THAT(room.Operator(OperatorKind::kStart).events.back().reason, testing::HasSubstr("refused"));
  EXPECT_THAT(room.Operator(OperatorKind::kLanguage, "xx").events.back().reason, testing::HasSubstr("refused"));
  EXPECT_THAT(room.Operator(OperatorKind::kChooseTask, "boat").events.back().reason, testing::HasSubstr("refused"));
  EXPECT_THAT(room.Operator(OperatorKind::kMarkDone, "corner_9").events.back().reason, testing::HasSubstr("refused"));
}

TEST(Lesson, OperatorMarksSkipsPausesSpeaks) {
  Classroom room(8);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Operator(OperatorKind::kMarkDone, "corner_1");
  room.Run(2);
  EXPECT_EQ(room.state().made, 1);
  room.Operator(OperatorKind::kMarkUndone, "corner_1");
  room.Run(2);
  EXPECT_EQ(room.state().made, 0);
  const int step = room.state().step;
  room.Operator(OperatorKind::kSkip);
  room.Run(1);
  EXPECT_NE(room.state().step, step);
  room.Operator(OperatorKind::kPause);
  const size_t before = room.said.size();
  room.Run(200);
  EXPECT_LE(room.said.size(), before + 1) << "a pause is quiet";
  EXPECT_EQ(room.state().phase, Phase::kPaused);
  room.Operator(OperatorKind::kSay, "Bravo");
  EXPECT_EQ(room.said.back().command.text, "Bravo");
  room.Operator(OperatorKind::kLanguage, "el");
  room.Operator(OperatorKind::kResume);
  room.Run(15);
  EXPECT_EQ(room.said.back().command.language, "el");
  EXPECT_EQ(room.Operator(OperatorKind::kStop).commands.back().kind, ActKind::kStop);
}

}  // namespace
}  // namespace coach
