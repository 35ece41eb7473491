#include "services/assembly_reasoner/hidden_parts.h"

#include <gtest/gtest.h>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/assembly_reasoner.h"

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
  // Parts 0 and 2 are joined; then 2 is covered and part 3 comes to rest in a wrong joint with it.
  AssemblyReasoner reasoner(task_);
  const Mistake* wrong = nullptr;
  for (const Mistake& m : task_.mistakes) {
    if (m.name == "corner_medium_medium") wrong = &m;
  }
  ASSERT_NE(wrong, nullptr);
  std::vector<ConnectionEvent> said;
  bool told = false;
  for (int frame = 0; frame < 90; ++frame) {
    poses_.utime += 33333;
    for (PartEstimate& part : poses_.parts) part.X_TP.translation().z() = 1e-5 * (frame % 7);  // measured anew
    poses_.parts[2].X_TP = poses_.parts[0].X_TP * task_.connections[0].X_AB;
    poses_.pairs.clear();
    if (frame < 30) {
      PairEvidence pair;
      pair.part_b = 2;
      pair.X_AB = task_.connections[0].X_AB;
      pair.X_AB.translation().x() += 1e-5 * (frame % 7);
      pair.covariance = Matrix6::Identity() * 1e-6;
      pair.visible_fraction = {0.9, 0.9};
      poses_.pairs.push_back(pair);
    } else {
      poses_.parts[2].status = PartStatus::kOccluded;
      poses_.parts[2].visible_fraction = 0;
      poses_.parts[3].X_TP = poses_.parts[2].X_TP * wrong->X_AB;
      poses_.parts[3].X_TP.translation().x() += 1e-5 * (frame % 5);  // a pose that repeats exactly is no evidence
    }
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
}

}  // namespace
}  // namespace coach
