// What is said of a mistake, when and how often.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "classroom.h"

namespace coach {
namespace {

TEST(Lesson, MovingHandsHoldHintsUpButNoCorrection) {
  Classroom room(13);
  room.hand_speed = [](int64_t) { return 0.3; };
  room.Operator(OperatorKind::kStart);
  room.Run(60);
  EXPECT_EQ(room.Count("idle_1"), 0);
  room.Join(0, 1, Rectangle().mistakes[0].X_AB);
  room.Run(10);
  EXPECT_EQ(room.Count("wrong"), 1);
}

TEST(Lesson, AMistakeIsCorrectedThreeTimesThenTheWholeHelpThenSilence) {
  Classroom room(4);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  const Mistake& m = Rectangle().mistakes[0];  // long on long
  room.Join(0, 1, m.X_AB);
  room.Run(120);
  EXPECT_EQ(room.Count("wrong"), 3);
  EXPECT_EQ(room.Count("wrong_last"), 1);
  EXPECT_EQ(room.state().phase, Phase::kWrong);
  int64_t last = 0;
  for (const auto& s : room.said) {
    if (s.command.priority != Priority::kCorrective) continue;
    EXPECT_TRUE(last == 0 || s.at - last >= 12000000);
    last = s.at;
  }
  room.Undo(0, 1);
  room.Run(3);
  EXPECT_NE(room.state().phase, Phase::kWrong);
}

TEST(Lesson, ATurnedPieceIsNamedAsSuch) {
  Classroom room(5);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.JoinRight(0);
  room.Run(10);
  const auto& c = Rectangle().connections[4];  // mirrored_1 between the two parts that are left
  room.Join(1, 3, c.X_AB);
  room.Run(10);
  EXPECT_EQ(room.Count("wrong_turned"), 1);
}

TEST(Lesson, TwoThatBelongTogetherAreNotSaidToBelongElsewhere) {
  const auto& mistakes = Rectangle().mistakes;
  const auto line = std::find_if(mistakes.begin(), mistakes.end(),
                                 [](const Mistake& m) { return m.type_a != m.type_b && m.name.rfind("line", 0) == 0; });
  ASSERT_NE(line, mistakes.end());
  Classroom room(5);
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Join(0, 2, line->X_AB);
  room.Run(10);
  EXPECT_EQ(room.Count("wrong_unknown"), 1);
  EXPECT_EQ(room.Count("wrong"), 0);
}

TEST(Lesson, WhileAMistakeStandsNothingElseIsAskedFor) {
  Classroom room(14);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.JoinRight(0);
  room.Run(0.8);  // the praise is being said, the next step waits
  room.Join(0, 1, Rectangle().mistakes[0].X_AB);
  room.moving = true;  // in the child's hands
  const size_t said = room.said.size();
  room.Run(40);
  EXPECT_EQ(room.state().phase, Phase::kWrong);
  EXPECT_LE(room.said.size(), said + 1);
  room.moving = false;
  room.Run(1.2);
  EXPECT_EQ(room.said.back().command.priority, Priority::kCorrective) << "as soon as the parts rest";
  room.Undo(0, 1);
  room.Run(12);
  EXPECT_EQ(room.Keys().back(), "step");
}

TEST(Lesson, HelpAgainstAMistakeIsGivenAtOnce) {
  Classroom room(15);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.moving = true;
  room.Join(0, 1, Rectangle().mistakes[0].X_AB);
  room.Run(2);
  room.Operator(OperatorKind::kHelp);
  room.Run(0.4);
  EXPECT_EQ(room.Keys().back(), "wrong");
}

}  // namespace
}  // namespace coach
