#include "services/assembly_reasoner/hidden_parts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/assembly_reasoner.h"
#include "services/assembly_reasoner/lesson.h"
#include "services/assembly_reasoner/lesson_configuration.h"

namespace coach {
namespace {

class HiddenPartsTest : public testing::Test {
 protected:
  HiddenPartsTest()
      : task_(LoadTask(std::string(COACH_SOURCE_DIR) + "/deploy/tasks/rectangle_long_medium.yaml")), contacts_(task_) {
    poses_.utime = 1000000;
    poses_.parts.resize(4);
    for (size_t p = 0; p < 4; ++p) {
      poses_.parts[p].status = PartStatus::kTracked;
      poses_.parts[p].visible_fraction = 0.9;
      poses_.parts[p].covariance = Matrix6::Identity() * 1e-6;
      poses_.parts[p].X_TP.translation() = Vector3(0.3 * static_cast<double>(p), 0.1, 0);
    }
  }
  /// Part 2 (medium) sits in its corner with part 0 (long) and is covered.
  void Cover() {
    hidden_.Seat({0, 2}, Corner(), task_.connections[0].X_AB);
    poses_.parts[2].status = PartStatus::kOccluded;
    poses_.parts[2].visible_fraction = 0;
    poses_.parts[2].X_TP.translation().setConstant(7);  // where it was last believed does not matter
  }
  /// Parts 0 and 2 are joined and seen for 30 frames; from then on part 3 rests in a wrong joint with part 2, which is
  /// covered or not.
  void NextFrame(int frame, bool covered) {
    const Mistake& wrong = *std::find_if(task_.mistakes.begin(), task_.mistakes.end(),
                                         [](const Mistake& m) { return m.name == "corner_medium_medium"; });
    poses_.utime += 33333;
    for (PartEstimate& part : poses_.parts) part.X_TP.translation().z() = 1e-5 * (frame % 7);  // measured anew
    poses_.parts[2].X_TP = poses_.parts[0].X_TP * task_.connections[0].X_AB;
    poses_.pairs.clear();
    const bool hidden = frame >= 30 && covered;
    poses_.parts[2].status = hidden ? PartStatus::kOccluded : PartStatus::kTracked;
    poses_.parts[2].visible_fraction = hidden ? 0 : 0.9;
    const auto pair = [&](int a, int b, const Pose& X_AB) {
      PairEvidence e;
      e.part_a = a;
      e.part_b = b;
      e.X_AB = X_AB;
      e.X_AB.translation().x() += 1e-5 * (frame % 7);
      e.covariance = Matrix6::Identity() * 1e-6;
      e.visible_fraction = {0.9, 0.9};
      poses_.pairs.push_back(e);
    };
    if (!hidden) pair(0, 2, task_.connections[0].X_AB);
    if (frame < 30) return;
    poses_.parts[3].X_TP = poses_.parts[2].X_TP * wrong.X_AB;
    poses_.parts[3].X_TP.translation().x() += 1e-5 * (frame % 5);  // a pose that repeats exactly is no evidence
    if (!hidden) pair(2, 3, wrong.X_AB);
  }
  const ContactClass& Corner() const { return contacts_.Classes(task_.parts[0].type, task_.parts[2].type)[0]; }

  Task task_;
  ContactTable contacts_;
  HiddenParts hidden_;
  PartPoses poses_;
};

TEST_F(HiddenPartsTest, AHiddenPartIsWhereItsJointPutsIt) {
  Cover();
  const Pose X_T2 = poses_.parts[0].X_TP * task_.connections[0].X_AB;
  const auto pairs = hidden_.Infer(poses_);
  ASSERT_EQ(pairs.size(), 2u);  // with parts 1 and 3; its holder says nothing new
  for (const PairEvidence& pair : pairs) {
    const bool is_first = pair.part_a == 2;
    const Pose& other = poses_.parts[is_first ? pair.part_b : pair.part_a].X_TP;
    const Pose expected = is_first ? X_T2.inverse() * other : other.inverse() * X_T2;
    EXPECT_LT((pair.X_AB.matrix() - expected.matrix()).norm(), 1e-9);
    EXPECT_GT(pair.covariance(0, 0), 2e-6);  // both parts' and the joint's play
  }
}

TEST_F(HiddenPartsTest, NothingIsInferredWithoutASeenHolder) {
  EXPECT_TRUE(hidden_.Infer(poses_).empty());
  Cover();
  poses_.parts[0].visible_fraction = 0.1;
  EXPECT_TRUE(hidden_.Infer(poses_).empty());
  poses_.parts[0].visible_fraction = 0.9;
  hidden_.Unseat({0, 2});
  EXPECT_TRUE(hidden_.Infer(poses_).empty());
}

TEST_F(HiddenPartsTest, APairThatIsNotInItsJointIsNoSeat) {
  Pose off = task_.connections[0].X_AB;
  off.translation().x() += 0.02;
  hidden_.Seat({0, 2}, Corner(), off);
  poses_.parts[2].status = PartStatus::kOccluded;
  poses_.parts[2].visible_fraction = 0;
  EXPECT_TRUE(hidden_.Infer(poses_).empty());
}

TEST_F(HiddenPartsTest, ExchangedPartsTakeTheirSeatsAlong) {
  Cover();
  hidden_.Exchange(2, 3);
  EXPECT_TRUE(hidden_.Infer(poses_).empty());  // part 3 has the seat now and is seen
  std::swap(poses_.parts[2], poses_.parts[3]);
  EXPECT_EQ(hidden_.Infer(poses_).size(), 2u);
}

TEST_F(HiddenPartsTest, ACoveredMistakeIsNoticedAndNotToldToTheTracker) {
  AssemblyReasoner reasoner(task_);
  std::vector<ConnectionEvent> said;
  bool told = false;
  for (int frame = 0; frame < 90; ++frame) {
    NextFrame(frame, true);
    const ReasonerOutput out = reasoner.Step(poses_);
    ASSERT_TRUE(out.accepted) << out.refused;
    said.insert(said.end(), out.events.begin(), out.events.end());
    for (const ConnectionProbability& c : out.belief.connections) told = told || c.connection < 0;
  }
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[0].type, "connect");
  EXPECT_EQ(said[1].type, "wrong");
  EXPECT_EQ(said[1].name, "corner_medium_medium");
  EXPECT_FALSE(told);
  ASSERT_EQ(reasoner.joints().size(), 2u);
  EXPECT_TRUE(reasoner.IsSeen(reasoner.joints()[0]));
  EXPECT_FALSE(reasoner.IsSeen(reasoner.joints()[1]));
}

TEST_F(HiddenPartsTest, WithTheThirdPartHiddenTooNothingIsClaimed) {
  AssemblyReasoner reasoner(task_);
  std::vector<ConnectionEvent> said;
  for (int frame = 0; frame < 90; ++frame) {
    NextFrame(frame, true);
    if (frame >= 30) {
      poses_.parts[3].status = PartStatus::kOccluded;
      poses_.parts[3].visible_fraction = 0;
    }
    const ReasonerOutput out = reasoner.Step(poses_);
    said.insert(said.end(), out.events.begin(), out.events.end());
  }
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].type, "connect");
}

TEST_F(HiddenPartsTest, TheChildHearsOfACoveredMistakeOnlyWhenItIsSeen) {
  LessonOptions options;
  options.start_by_itself = true;
  Lesson lesson({task_}, LoadPhraseBooks(std::string(COACH_SOURCE_DIR) + "/deploy/phrases"), options, "TEST");
  int corrections = 0;
  const auto run = [&](int from, int to, bool covered) {
    for (int frame = from; frame < to; ++frame) {
      NextFrame(frame, covered);
      for (const RobotCommand& c : lesson.Step(poses_).commands) corrections += c.phrase_key.rfind("wrong", 0) == 0;
    }
  };
  run(0, 900, true);
  EXPECT_EQ(corrections, 0);
  run(900, 1500, false);
  EXPECT_GT(corrections, 0);
}

}  // namespace
}  // namespace coach
