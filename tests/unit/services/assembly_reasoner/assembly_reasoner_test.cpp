#include "services/assembly_reasoner/assembly_reasoner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "common/assembly/task_file.h"
#include "tools/evaluate_reasoner/event_score.h"

namespace coach {
namespace {

Task Shipped(const std::string& name) {
  return LoadTask(std::string(COACH_SOURCE_DIR) + "/deploy/tasks/" + name + ".yaml");
}

std::vector<ConnectionEvent> Replay(AssemblyReasoner& reasoner, const ScriptedLesson& lesson) {
  std::vector<ConnectionEvent> said;
  for (const PartPoses& frame : lesson.frames) {
    const ReasonerOutput out = reasoner.Step(frame);
    EXPECT_TRUE(out.accepted) << out.refused;
    said.insert(said.end(), out.events.begin(), out.events.end());
  }
  return said;
}

/// Every order of the steps with every assignment of equal parts to slots, `stride` apart; a stride prime to their
/// number goes through all orders and assignments of each.
void EveryOrder(const std::string& name, int64_t stride) {
  const Task task = Shipped(name);
  TrackerErrors errors;
  errors.freezes = errors.jumps = 0;
  EventScore sum;
  int lessons = 0;
  for (int64_t i = 0; i < CountPlainScripts(task); i += stride) {
    AssemblyReasoner reasoner(task);
    const auto lesson = PlayScript(task, PlainScriptAt(task, i), errors, 15, static_cast<uint64_t>(i));
    sum += Score(lesson.events, Replay(reasoner, lesson));
    ++lessons;
  }
  EXPECT_GE(lessons, 4);
  EXPECT_EQ(sum.found, sum.truths);
  EXPECT_EQ(sum.false_alarms, 0);
  EXPECT_GE(sum.within_1s, sum.truths * 98 / 100);
}

TEST(AssemblyReasoner, EveryOrderAndAssignmentOfTheRectangle) { EveryOrder("rectangle_long_medium", 5); }
TEST(AssemblyReasoner, ManyOrdersOfTheSquare) { EveryOrder("square", 887); }
TEST(AssemblyReasoner, ManyOrdersOfTheCar) { EveryOrder("car", 577); }

TEST(PoseScript, PlainScriptsAreAllOrdersAndAssignments) {
  const Task task = Shipped("rectangle_long_medium");
  ASSERT_EQ(CountPlainScripts(task), 24 * 2 * 2);
  std::set<std::vector<std::array<int, 3>>> different;
  for (int64_t i = 0; i < CountPlainScripts(task); ++i) {
    std::vector<std::array<int, 3>> script;
    for (const ScriptAction& a : PlainScriptAt(task, i)) script.push_back({a.index, a.part_a, a.part_b});
    different.insert(script);
  }
  EXPECT_EQ(different.size(), 96u);
}

TEST(AssemblyReasoner, EveryListedMistakeIsFoundAndItsUndoing) {
  for (const char* name : {"rectangle_long_short", "square", "car"}) {
    const Task task = Shipped(name);
    for (size_t m = 0; m < task.mistakes.size(); ++m) {
      const auto find = [&](int type, int other) {
        int p = 0;
        while (task.parts[p].type != type || p == other) ++p;
        return p;
      };
      const int a = find(task.mistakes[m].type_a, -1), b = find(task.mistakes[m].type_b, a);
      const auto kind = ScriptAction::Kind::kMistake, undo = ScriptAction::Kind::kUndo;
      const int index = static_cast<int>(m);
      const auto lesson = PlayScript(task, {{kind, index, a, b}, {undo, index, a, b}}, {}, 15, m);
      AssemblyReasoner reasoner(task);
      const auto said = Replay(reasoner, lesson);
      ASSERT_EQ(said.size(), 2u) << name << " " << task.mistakes[m].name;
      // A turned corner alone may be the beginning of the mirrored variant.
      if (said[0].type == "wrong") {
        EXPECT_EQ(said[0].name, task.mistakes[m].name);
      }
      EXPECT_EQ(said[1].type, "disconnect");
      EXPECT_EQ(said[1].name, said[0].name);
    }
  }
}

TEST(AssemblyReasoner, PulledApartUnderBeliefOneIsKnownInHalfASecond) {
  const Task task = Shipped("rectangle_long_medium");
  using Kind = ScriptAction::Kind;
  const auto lesson = PlayScript(task, {{Kind::kConnect, 0, 0, 2}, {Kind::kUndo, 0, 0, 2}}, {}, 30, 5);
  AssemblyReasoner reasoner(task);
  const auto said = Replay(reasoner, lesson);
  ASSERT_EQ(said.size(), 2u);
  const auto truth = std::find_if(lesson.events.begin(), lesson.events.end(),
                                  [](const TrueEvent& e) { return e.type == "disconnect"; });
  EXPECT_LT(said[1].decided - truth->moment, 700000);  // the pull takes 0.2 s to open 10 mm
}

TEST(AssemblyReasoner, IdentityExchangePermutesTheBelief) {
  const Task task = Shipped("rectangle_long_medium");
  const auto lesson = PlayScript(task, {{ScriptAction::Kind::kConnect, 0, 0, 2}}, {}, 15, 5);
  AssemblyReasoner reasoner(task);
  ASSERT_EQ(Replay(reasoner, lesson).size(), 1u);
  PartPoses exchanged = lesson.frames.back();
  exchanged.utime += 66666;
  std::swap(exchanged.parts[0], exchanged.parts[1]);
  exchanged.parts[0].identity_exchange = 1;
  exchanged.parts[1].identity_exchange = 0;
  for (PairEvidence& pair : exchanged.pairs) {
    if (pair.part_a == 0 && pair.part_b == 2) pair.part_a = 1;
  }
  const ReasonerOutput out = reasoner.Step(exchanged);
  EXPECT_TRUE(out.events.empty());
  ASSERT_EQ(reasoner.joints().size(), 1u);
  EXPECT_EQ(reasoner.joints()[0].part_a, 1);
  EXPECT_EQ(out.state.made, 1);
}

TEST(AssemblyReasoner, BadPosesAreRefusedAndChangeNothing) {
  const Task task = Shipped("rectangle_long_medium");
  const auto lesson = PlayScript(task, {{ScriptAction::Kind::kConnect, 0, 0, 2}}, {}, 15, 5);
  AssemblyReasoner reasoner(task);
  Replay(reasoner, lesson);
  PartPoses bad = lesson.frames.back();
  EXPECT_FALSE(reasoner.Step(bad).accepted);  // repeated
  bad.utime -= 5000000;
  EXPECT_FALSE(reasoner.Step(bad).accepted);  // back in time
  bad.utime += 10000000;
  bad.parts[0].X_TP.translation().x() = std::nan("");
  EXPECT_FALSE(reasoner.Step(bad).accepted);
  bad.parts.pop_back();
  EXPECT_FALSE(reasoner.Step(bad).accepted);
  PartPoses nan = lesson.frames.back();
  nan.utime += 66666;
  for (PairEvidence& pair : nan.pairs) pair.covariance.setConstant(std::nan(""));
  const ReasonerOutput out = reasoner.Step(nan);
  EXPECT_TRUE(out.accepted);
  EXPECT_EQ(out.state.made, 1);
}

TEST(AssemblyReasoner, HiddenPartsKeepTheirConnections) {
  const Task task = Shipped("rectangle_long_medium");
  const auto lesson = PlayScript(task, {{ScriptAction::Kind::kConnect, 0, 0, 2}}, {}, 15, 5);
  AssemblyReasoner reasoner(task);
  Replay(reasoner, lesson);
  PartPoses hidden = lesson.frames.back();
  for (int i = 0; i < 150; ++i) {
    hidden.utime += 66666;
    hidden.pairs.clear();
    for (PartEstimate& part : hidden.parts) {
      part.visible_fraction = 0;
      part.status = PartStatus::kOccluded;
      part.X_TP.translation().x() += 0.001 * part.X_TP.translation().y();
    }
    const ReasonerOutput out = reasoner.Step(hidden);
    EXPECT_TRUE(out.events.empty());
    EXPECT_EQ(out.state.made, 1);
  }
}

TEST(AssemblyReasoner, OverrideAndMemory) {
  const Task task = Shipped("rectangle_long_medium");
  AssemblyReasoner reasoner(task);
  ASSERT_EQ(reasoner.Override(0, true, 1000).size(), 1u);
  EXPECT_TRUE(reasoner.Override(0, true, 2000).empty());
  AssemblyReasoner other(task);
  other.Restore(reasoner.Save());
  ASSERT_EQ(other.joints().size(), 1u);
  EXPECT_EQ(other.joints()[0].connection, 0);
  ASSERT_EQ(other.Override(0, false, 3000).size(), 1u);
  EXPECT_TRUE(other.joints().empty());
  AssemblyMemory bad = reasoner.Save();
  bad.joints[0].part_b = 17;
  EXPECT_THROW(other.Restore(bad), std::invalid_argument);
}

TEST(AssemblyReasoner, SameStreamSameEvents) {
  const Task task = Shipped("square");
  std::mt19937_64 random(4);
  const auto lesson = PlayScript(task, RandomScript(task, {}, random), {}, 15, 9);
  AssemblyReasoner a(task), b(task);
  const auto first = Replay(a, lesson), second = Replay(b, lesson);
  ASSERT_EQ(first.size(), second.size());
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].decided, second[i].decided);
    EXPECT_EQ(first[i].probability, second[i].probability);
  }
}

TEST(AssemblyReasoner, ThePaperTakesCloseForConnected) {
  const Task task = Shipped("rectangle_long_medium");
  AssemblyReasonerOptions paper;
  paper.paper = true;
  ScriptAction miss{ScriptAction::Kind::kNearMiss, 0, 0, 2};
  miss.gap = 0.03;
  const auto lesson = PlayScript(task, {miss}, {}, 15, 3);
  AssemblyReasoner as_written(task, paper), coach(task);
  EXPECT_GT(Score(lesson.events, Replay(as_written, lesson)).false_alarms, 0);
  EXPECT_TRUE(Replay(coach, lesson).empty());
}

}  // namespace
}  // namespace coach
