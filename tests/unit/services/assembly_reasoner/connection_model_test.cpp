#include "services/assembly_reasoner/connection_model.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "common/assembly/connection_probability.h"
#include "common/assembly/task_file.h"

namespace coach {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(PaperConnectionProbability, ByHand) {
  EXPECT_DOUBLE_EQ(DistanceProbability({0, 0, 0}, {0.03, 0, 0}), 1);
  EXPECT_NEAR(DistanceProbability({0, 0, 0}, {0.06, 0, 0}), 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(DistanceProbability({0, 0, 0}, {0, 0.09, 0}), 0);
}

TEST(PaperConnectionProbability, WhatItCanNotSee) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation({0, 0, 90 * kDegree});
  X.translation() = Vector3(0.075, 0.045, 0);
  Pose turned = X;
  turned.linear() = ExpRotation({0, 0, 20 * kDegree}) * X.linear();
  EXPECT_DOUBLE_EQ(PaperConnectionProbability(X, turned), 1);
  Pose apart = X;
  apart.translation().y() += 0.04;
  EXPECT_NEAR(PaperConnectionProbability(X, apart), 1, 1e-9);
  Pose rolled = X;  // A about its long axis: B in A's frame goes to the other side
  rolled.translation().y() -= 0.09;
  EXPECT_LE(PaperConnectionProbability(X, rolled), 0.5);
}

class CoachModel : public testing::Test {
 protected:
  explicit CoachModel(const std::string& task = "rectangle_long_medium", int connection = 0)
      : task_(LoadTask(std::string(COACH_SOURCE_DIR) + "/deploy/tasks/" + task + ".yaml")),
        X_joint_(task_.connections[connection].X_AB),
        contacts_(task_),
        model_(MakeCoachConnectionModel(task_, contacts_)) {}

  /// Judges parts 0 (long) and 2 (medium) held for `seconds` at `gap` from the corner's pose.
  PairVerdict Hold(const Pose& X_AB, double seconds, double deviation, double visible = 1, bool pairs = true) {
    std::normal_distribution<double> noise(0, deviation);
    PairVerdict verdict;
    for (int i = 0; i < static_cast<int>(seconds * 30); ++i) {
      utime_ += 33333;
      PartEstimate a, b;
      a.status = b.status = PartStatus::kTracked;
      a.visible_fraction = b.visible_fraction = visible;
      a.X_TP.translation().z() = noise(random_);
      PairEvidence pair;
      Vector6 xi;
      for (int k = 0; k < 6; ++k) xi[k] = (k < 3 ? 1 : 10) * noise(random_);
      pair.X_AB = Perturb(X_AB, xi);
      pair.covariance.setZero();
      pair.covariance.diagonal() << Vector3::Constant(deviation * deviation),
          Vector3::Constant(100 * deviation * deviation);
      b.X_TP = a.X_TP * pair.X_AB;
      pair.part_b = 2;
      pair.surface_distance = 0.01;
      verdict = model_->Judge({utime_, 0, 2, &a, &b, pairs ? &pair : nullptr});
    }
    return verdict;
  }
  Pose Corner(double gap_x = 0, double angle = 0) const {
    Pose X = X_joint_;
    X.translation().x() += gap_x;
    X.linear() = ExpRotation({0, 0, angle}) * X.linear();
    return X;
  }

  Task task_;
  Pose X_joint_;
  ContactTable contacts_;
  std::unique_ptr<ConnectionModel> model_;
  int64_t utime_ = 0;
  std::mt19937_64 random_{3};
};

TEST_F(CoachModel, TellsMadeFromNear) {
  EXPECT_GT(Hold(Corner(), 1, 0.001).log_odds[0], 3);
  EXPECT_LT(Hold(Corner(0.005), 2, 0.001).log_odds[0], 0);
  EXPECT_LT(Hold(Corner(0.010), 2, 0.001).log_odds[0], -4);
  EXPECT_LT(Hold(Corner(0, 12 * kDegree), 2, 0.001).log_odds[0], -4);
}

TEST_F(CoachModel, TellsTheCornerFromItsMirrorImage) {
  const PairVerdict verdict = Hold(Corner(), 1, 0.001);
  EXPECT_LT(verdict.log_odds[1], -8);
  EXPECT_LT(verdict.log_odds[2], -8);
}

TEST_F(CoachModel, NoiseMakesItSlowNotWrong) {
  const double at_once = Hold(Corner(), 0.2, 0.005).log_odds[0];
  EXPECT_GT(Hold(Corner(), 2, 0.005).log_odds[0], at_once);
}

TEST_F(CoachModel, NoEvidenceNoClaim) {
  EXPECT_FALSE(Hold(Corner(), 1, 0.001, 0.03).has_evidence);
  // Poses without pairs may stem from an enforced connection: they say nothing near a joint, and 'apart' far from it.
  EXPECT_FALSE(Hold(Corner(), 1, 0.001, 1, false).has_evidence);
  const PairVerdict far = Hold(Corner(0.1), 1, 0.001, 1, false);
  ASSERT_TRUE(far.has_evidence);
  EXPECT_LT(far.log_odds[0], -8);
}

/// What a made joint is told in one frame.
struct Look {
  double visible = 0.9;
  double gap = 0;    ///< m between the surfaces
  double speed = 0;  ///< m/s of the second part
  bool misfit = false, pressed = false;
};

class BreakOfAMadeJoint : public CoachModel {
 protected:
  using CoachModel::CoachModel;
  /// Judges one frame, a 30th of a second later, of the joint opened by `open` m to the side.
  PairVerdict Frame(double open, const Look& look = {}, int decided = 0, double turn = 0) {
    utime_ += 33333;
    std::normal_distribution<double> noise(0, 0.0003);
    PartEstimate a, b;
    a.status = b.status = PartStatus::kTracked;
    a.visible_fraction = b.visible_fraction = look.visible;
    b.velocity[0] = look.speed;
    a.X_TP.translation().z() = noise(random_);
    PairEvidence pair;
    pair.part_b = 2;
    pair.X_AB = Corner(open + noise(random_), turn);
    pair.covariance.setZero();
    pair.covariance.diagonal() << Vector3::Constant(1e-6), Vector3::Constant(1e-4);
    pair.surface_distance = look.gap;
    b.X_TP = a.X_TP * pair.X_AB;
    PairView view{utime_, 0, 2, &a, &b, &pair};
    view.misfit = look.misfit;
    view.pressed = look.pressed;
    view.decided = decided;
    return model_->Judge(view);
  }
  void Made() {
    for (int i = 0; i < 30; ++i) Frame(0);
  }
  /// The joint slides open to 12 mm in half a second and stays there for as long; is that believed?
  bool Opens(const Look& look) {
    Made();
    PairVerdict verdict;
    for (int i = 1; i <= 30; ++i) verdict = Frame(0.012 * std::min(1.0, i / 15.0), look);
    return verdict.has_evidence && verdict.log_odds[0] < -2;
  }
};

TEST_F(BreakOfAMadeJoint, SeenAndSlowItIsBelieved) { EXPECT_TRUE(Opens({})); }

TEST_F(BreakOfAMadeJoint, APartThatIsAllButCoveredProvesNothing) {
  EXPECT_FALSE(Opens({.visible = 0.1}));
  EXPECT_TRUE(Opens({.visible = 0.15}));
}

TEST_F(BreakOfAMadeJoint, APartInsideAnotherProvesNothing) {
  EXPECT_FALSE(Opens({.misfit = true}));
  EXPECT_FALSE(Opens({.gap = 0.009, .misfit = true}));
  EXPECT_FALSE(Opens({.pressed = true}));
  EXPECT_TRUE(Opens({.gap = 0.009, .pressed = true})) << "there is air between the two";
}

TEST_F(BreakOfAMadeJoint, InFastMotionThereHasToBeAirBetweenTheParts) {
  EXPECT_FALSE(Opens({.gap = 0.002, .speed = 0.3}));
  EXPECT_TRUE(Opens({.gap = 0.002, .speed = 0.1}));
  EXPECT_TRUE(Opens({.gap = 0.012, .speed = 0.3}));
}

TEST_F(BreakOfAMadeJoint, AJumpIsTheTrackersAndOnlyWhatLastsIsBelieved) {
  Made();
  const CoachConnectionModelOptions options;
  const int64_t jumped = utime_ + 33333;
  bool believed = false;
  int64_t when = 0;
  for (int i = 0; i < 90 && !believed; ++i) {
    const PairVerdict verdict = Frame(0.060, {.gap = 0.02});  // 60 mm in a 30th of a second: 1.8 m/s
    believed = verdict.has_evidence && verdict.log_odds[0] < -2;
    when = utime_;
  }
  EXPECT_TRUE(believed);
  EXPECT_NEAR(static_cast<double>(when - jumped) * 1e-6, options.jump_time, 0.1);
}

TEST_F(BreakOfAMadeJoint, AfterAJumpOnlyAirBetweenThePartsOrAReturnProvesAnything) {
  Made();
  PairVerdict verdict;
  for (int i = 0; i < 150; ++i) {
    verdict = Frame(0, {}, 0, std::numbers::pi);  // turned over in place, and so it stays
    EXPECT_FALSE(verdict.has_evidence && verdict.log_odds[0] < 0);
  }
  for (int i = 0; i < 90; ++i) verdict = Frame(0.060, {.gap = 0.02});
  EXPECT_TRUE(verdict.has_evidence && verdict.log_odds[0] < -2);
  Made();
  for (int i = 0; i < 60; ++i) Frame(0);
  EXPECT_TRUE(Opens({})) << "seen in the joint again";
}

class BreakOfAWheel : public BreakOfAMadeJoint {
 protected:
  BreakOfAWheel() : BreakOfAMadeJoint("car", 1) {}
};

TEST_F(BreakOfAMadeJoint, ABrickThatIsTurnedIsSeen) {
  Made();
  PairVerdict verdict;
  for (int i = 1; i <= 40; ++i) verdict = Frame(0.002, {}, 0, 9 * kDegree * std::min(1.0, i / 15.0));
  EXPECT_TRUE(verdict.has_evidence && verdict.log_odds[0] < -2);
}

TEST_F(BreakOfAWheel, ASmallPartIsTurnedByTheTrackersErrors) {
  Made();
  PairVerdict verdict;
  for (int i = 1; i <= 40; ++i) verdict = Frame(0.002, {}, 0, 9 * kDegree * std::min(1.0, i / 15.0));
  EXPECT_FALSE(verdict.has_evidence && verdict.log_odds[0] < 0);
  EXPECT_TRUE(Opens({}));
}

TEST_F(BreakOfAMadeJoint, AJumpAwayAndBackLeavesNoTrace) {
  Made();
  PairVerdict verdict;
  for (int i = 0; i < 15; ++i) {
    verdict = Frame(0.060);
    EXPECT_FALSE(verdict.has_evidence && verdict.log_odds[0] < 0);
  }
  for (int i = 0; i < 30; ++i) verdict = Frame(0);
  ASSERT_TRUE(verdict.has_evidence);
  EXPECT_GT(verdict.log_odds[0], 3);
}

TEST_F(BreakOfAMadeJoint, WhatIsMeasuredClosedIsNotOpenedByWhatWasMeasuredBefore) {
  Made();
  for (int i = 0; i < 45; ++i) Frame(0.008, {.pressed = true});  // covered and misplaced
  for (int i = 0; i < 15; ++i) {
    const PairVerdict verdict = Frame(0);
    EXPECT_FALSE(verdict.has_evidence && verdict.log_odds[0] < 0) << i;
  }
}

TEST_F(BreakOfAMadeJoint, WithoutAJointAPartInsideAnotherClaimsNothingButAJoint) {
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(Frame(0.012, {.misfit = true}, -1).has_evidence);
  PairVerdict verdict;
  for (int i = 0; i < 30; ++i) verdict = Frame(0, {.misfit = true}, -1);
  EXPECT_TRUE(verdict.has_evidence);
}

TEST_F(BreakOfAMadeJoint, PartsMeasuredInEachOtherTouch) {
  PairVerdict inside, beside;
  for (int i = 0; i < 30; ++i) inside = Frame(-0.006, {.gap = -0.0065}, -1);
  EXPECT_GT(inside.log_odds[0], 2) << "a near miss would be measured further off still";
  EXPECT_LT(inside.log_odds[1], -4);
  model_ = MakeCoachConnectionModel(task_, contacts_);
  for (int i = 0; i < 30; ++i) beside = Frame(0.006, {.gap = 0.0065}, -1);
  EXPECT_LT(beside.log_odds[0], -2);
}

TEST_F(CoachModel, DatesTheArrivalBack) {
  Hold(Corner(0.05), 1, 0.0005);
  const int64_t moment = utime_;
  Hold(Corner(), 0.8, 0.0005);
  EXPECT_NEAR(static_cast<double>(model_->ChangeTime(0, 2, 0, -1, utime_) - moment), 0, 100000);
  const int64_t left = utime_;
  Hold(Corner(0.03), 0.5, 0.0005);
  EXPECT_NEAR(static_cast<double>(model_->ChangeTime(0, 2, -1, 0, utime_) - left), 0, 100000);
}

}  // namespace
}  // namespace coach
