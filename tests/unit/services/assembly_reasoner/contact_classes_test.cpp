#include "services/assembly_reasoner/contact_classes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "common/assembly/task_file.h"

namespace coach {
namespace {

Task Shipped(const std::string& name) {
  return LoadTask(std::string(COACH_SOURCE_DIR) + "/deploy/tasks/" + name + ".yaml");
}

TEST(ContactClasses, FourCornersOfARectangleAreOneClass) {
  const Task task = Shipped("rectangle_long_medium");
  const ContactTable table(task);
  const auto& classes = table.Classes(0, 1);
  ASSERT_EQ(classes.size(), 3u);  // corner, its mirror image, in line
  EXPECT_THAT(classes[0].connections, testing::ElementsAre(0, 1, 2, 3));
  EXPECT_TRUE(classes[0].mistakes.empty());
  EXPECT_THAT(classes[1].connections, testing::ElementsAre(4, 5, 6, 7));
  EXPECT_EQ(classes[1].mistakes.size(), 1u);   // the mirrored corner is a mistake among unmirrored ones
  EXPECT_EQ(classes[0].templates.size(), 4u);  // either end of either brick
}

TEST(ContactClasses, EqualPartsMayStandInEitherOrder) {
  const Task task = Shipped("square");
  const ContactTable table(task);
  for (const ContactClass& c : table.Classes(0, 0)) {
    for (const ContactTemplate& t : c.templates) {
      EXPECT_LT(NearestContact(c, t.X_AB).distance, 1e-3);
      EXPECT_LT(NearestContact(c, t.X_AB.inverse()).distance, 1e-3);
    }
  }
}

TEST(ContactClasses, AWheelTurnsFreelyAndNothingElseIsFree) {
  const Task task = Shipped("car");
  const ContactTable table(task);
  const auto& classes = table.Classes(0, 2);
  ASSERT_EQ(classes.size(), 4u);  // one a place on the chassis
  const ContactTemplate& joint = classes[0].templates[0];
  ASSERT_EQ(joint.freedom.size(), 1u);
  for (double q = -3.1; q < 3.1; q += 0.37) {
    const Pose X = MoveJoint(joint, {q});
    EXPECT_LT((X.translation() - joint.X_AB.translation()).norm(), 1e-9);
    EXPECT_LT(NearestContact(classes[0], X).distance, 1e-3) << q;
    EXPECT_GT(NearestContact(classes[1], X).distance, 30) << q;
    Pose pulled = X;
    pulled.translation() += 0.004 * (X.linear() * Vector3::UnitZ());
    const ContactError error = NearestContact(classes[0], pulled);
    EXPECT_NEAR(error.distance, 4, 0.01) << q;
    EXPECT_EQ(error.constrained.cols(), 5);
  }
}

TEST(ContactClasses, RangesOfFreedomEndSomewhere) {
  ContactClass slider;
  slider.templates.push_back(
      {Pose::Identity(), {{JointFreedom::Kind::kTranslation, Vector3::UnitX(), Vector3::Zero(), 0, 0.02}}});
  Pose X = Pose::Identity();
  X.translation().x() = 0.015;
  EXPECT_LT(NearestContact(slider, X).distance, 1e-3);
  X.translation().x() = 0.03;
  EXPECT_NEAR(NearestContact(slider, X).distance, 10, 0.01);
}

}  // namespace
}  // namespace coach
