#include "tools/simulator/hard_cases.h"

#include <algorithm>
#include <cmath>

#include "tools/simulator/shapes.h"

namespace coach {
namespace {

/// A screen that a hand puts in front of a part and takes away again.
struct Screen {
  static constexpr double kHeight = 0.17;
  int thing = 0;
  Pose away, hiding;
};

Screen AddScreen(Making* m, double width, double x, double y) {
  Screen s;
  s.thing = static_cast<int>(m->scenario.meshes.size());
  s.away = OnTable(-0.42, -0.02, 0.5 * Screen::kHeight, 0.9);
  s.hiding = OnTable(x, y, 0.5 * Screen::kHeight, 0);
  m->AddProp(MakeBox({width, 0.03, Screen::kHeight}), s.away);
  return s;
}

std::vector<Pose> Row(const Making& m, double y) {
  std::vector<Pose> poses;
  const int n = static_cast<int>(m.task.parts.size());
  for (int i = 0; i < n; ++i)
    poses.push_back(Flat(m, i, i == 0 ? 0.05 : 0.05 + 0.085 * i, i == 0 ? y : 0.13, i == 0 ? 0.0 : 1.5));
  return poses;
}

/// The rest of the parts at the far side; a and b where they are told to be.
std::vector<Pose> Aside(const Making& m, int a, const Pose& X_a, int b, const Pose& X_b) {
  std::vector<Pose> poses;
  double x = -0.28;
  for (int i = 0; i < static_cast<int>(m.task.parts.size()); ++i) {
    if (i == a || i == b) {
      poses.push_back(i == a ? X_a : X_b);
      continue;
    }
    poses.push_back(Flat(m, i, x, 0.19, 1.4));
    x += 0.09;
  }
  return poses;
}

/// The nearest place from X_W inwards at which a part can be put down from above.
Pose FreePlace(const Child& child, int part, Pose X_W) {
  const double inwards = X_W.translation().x() > 0 ? -0.03 : 0.03;
  const auto above = [&] {
    Pose X = X_W;
    X.translation().z() += 0.01;
    return X;
  };
  while (child.Blocked(part, X_W) || child.Blocked(part, above())) X_W.translation().x() += inwards;
  return X_W;
}

}  // namespace

void HiddenStill(Making* m) {
  const Screen screen = AddScreen(m, 0.3, 0.05, -0.13);
  m->Furnish({});
  m->Place(Row(*m, -0.065));
  for (int i = 0; i < 2; ++i) {
    m->child->Reach(Side::kRight, screen.thing);
    m->child->Carry(Side::kRight, screen.hiding, 0.05);
    m->child->Wait(2.2);
    m->child->Carry(Side::kRight, screen.away, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(1.5);
  }
}

void HiddenMoving(Making* m) {
  const Screen screen = AddScreen(m, 0.42, 0.05, -0.13);
  m->Furnish({});
  m->Place(Row(*m, -0.065));
  for (int i = 0; i < 2; ++i) {
    m->child->Reach(Side::kRight, screen.thing);
    m->child->Carry(Side::kRight, screen.hiding, 0.05);
    m->child->Wait(0.4);
    m->child->Reach(Side::kLeft, 0);
    Pose X = m->child->PoseOf(0);
    X.translation() += Vector3(i == 0 ? 0.1 : -0.1, 0.005, 0);
    m->child->Carry(Side::kLeft, X, 0, 0.9);
    m->child->Release(Side::kLeft);
    m->child->Wait(0.8);
    m->child->Carry(Side::kRight, screen.away, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(1.5);
  }
}

void PassOver(Making* m) {
  const auto [a, b] = EqualParts(m->task);
  m->Furnish({});
  m->Place(Aside(*m, a, Flat(*m, a, -0.16, -0.03, 1.2), b, Flat(*m, b, 0.02, -0.03, 1.4)));
  const double height =
      m->solids->Highest(b, m->child->PoseOf(b).linear()) - m->solids->Lowest(b, m->child->PoseOf(b).linear());
  double to = 0.2;
  for (int i = 0; i < 4; ++i) {
    m->child->Reach(Side::kRight, a);
    m->child->Carry(Side::kRight, Flat(*m, a, to, -0.03, 1.3), height + 0.008);
    m->child->Release(Side::kRight);
    m->child->Wait(0.8);
    to = -to;
  }
}

void Touching(Making* m) {
  const auto [a, b] = EqualParts(m->task);
  m->Furnish({});
  m->Place(Aside(*m, a, Flat(*m, a, -0.2, -0.05, 0.3), b, Flat(*m, b, 0.08, -0.03, 0.2)));
  const Pose away = m->child->PoseOf(a);
  const MeshExtent e = m->solids->extent(b);
  for (int i = 0; i < 3; ++i) {
    m->child->Reach(Side::kRight, a);
    Pose beside = m->child->PoseOf(b);
    // Side by side, then end to end.
    const int across = std::abs(beside.linear()(2, 1)) < std::abs(beside.linear()(2, 2)) ? 1 : 2;
    const int axis = i % 2 == 0 ? across : 0;
    const double step = e.high[axis] - e.low[axis] + 0.0006;
    beside.translation() += (axis == 0 ? -step : step) * beside.linear().col(axis);
    m->child->Carry(Side::kRight, beside, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(1.5);
    m->child->Reach(Side::kRight, a);
    m->child->Carry(Side::kRight, away, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(0.5);
  }
}

void Fast(Making* m) {
  m->Furnish({});
  m->Scatter(0.2);
  m->style.speed = 0.7;
  const Pose rest = m->child->PoseOf(0);
  for (int round = 0; round < 2; ++round) {
    const Side hand = m->child->NearerHand(m->child->PoseOf(0).translation());
    m->child->Reach(hand, 0);
    Pose up = m->child->PoseOf(0);
    up.translation().z() += 0.08;
    m->child->Carry(hand, up, 0);
    for (int i = 0; i < 4; ++i) {
      // A minimum-jerk movement's top speed is 1.875 times its average: here 1.2 m/s.
      Pose goal;
      goal.translation() << (i % 2 == 0 ? 0.2 : -0.2), m->random.Uniform(-0.1, 0.05), m->random.Uniform(0.06, 0.14);
      goal.linear() =
          ExpRotation(Vector3(m->random.Uniform(-0.4, 0.4), m->random.Uniform(-0.4, 0.4), i % 2 == 0 ? 1.5 : -1.5)) *
          m->child->PoseOf(0).linear();
      while (m->child->Blocked(0, goal)) goal.translation().z() += 0.02;
      const double way = (goal.translation() - m->child->PoseOf(0).translation()).norm();
      m->child->Carry(hand, goal, 0, 1.875 * way / 1.2);
      m->child->Wait(0.15);
    }
    m->child->Carry(hand, rest, 0);
    m->child->Release(hand);
    m->child->Wait(1.2);
  }
}

void LeaveAndReturn(Making* m) {
  m->Furnish({});
  m->Scatter(0.2);
  for (int round = 0; round < 2; ++round) {
    const Side hand = m->child->NearerHand(m->child->PoseOf(0).translation());
    const Pose lying = m->child->PoseOf(0);
    m->child->Reach(hand, 0);
    Pose up = lying;
    up.translation() = Vector3(hand == Side::kLeft ? 0.15 : -0.15, 0.35, 0.5);
    m->child->Carry(hand, up, 0);
    m->child->Wait(1.5);
    // Back on the other side of the table, turned.
    const double x = lying.translation().x() > 0 ? -0.06 - 0.05 * round : 0.06 + 0.05 * round;
    const Pose back = MakePose(Eigen::AngleAxisd(1.1, Vector3::UnitZ()).toRotationMatrix() * lying.linear(),
                               Vector3(x, -0.26, lying.translation().z()));
    m->child->Carry(hand, FreePlace(*m->child, 0, back), 0);
    m->child->Release(hand);
    m->child->Wait(1.2);
  }
}

void HandedOver(Making* m) {
  m->Furnish({});
  m->Scatter(0.2);
  const int n = static_cast<int>(m->task.parts.size());
  for (int part = 0; part < std::min(n, 3); ++part) {
    const Pose lying = m->child->PoseOf(part);
    const Side first = m->child->NearerHand(lying.translation());
    m->child->Reach(first, part);
    Pose middle = lying;
    middle.translation() = Vector3(0, -0.02, 0.14);
    m->child->Carry(first, middle, 0);
    m->child->Reach(Other(first), part);
    m->scenario.performance.events.push_back(
        {.time = m->child->now(), .kind = "handed_over", .parts = {part}, .hand = ToString(Other(first))});
    m->child->Release(first);
    Pose down = lying;
    down.translation().x() = -lying.translation().x();
    down.translation().y() = -0.27;
    m->child->Carry(Other(first), FreePlace(*m->child, part, down), 0);
    m->child->Release(Other(first));
    m->child->Wait(0.6);
  }
}

void HalfCovered(Making* m) {
  m->Furnish({});
  m->Scatter(0.3);
  for (int part = 0; part < static_cast<int>(m->task.parts.size()); ++part) {
    const Side hand = m->child->NearerHand(m->child->PoseOf(part).translation());
    m->child->Cover(hand, part, 1.6);
    m->child->Wait(0.4);
    m->child->Reach(hand, part);
    m->child->Wait(1.0);
    Pose nudge = m->child->PoseOf(part);
    nudge.translation() += Vector3(0.02, 0.015, 0);
    m->child->Carry(hand, nudge, 0);
    m->child->Release(hand);
    m->child->Wait(0.6);
  }
}

}  // namespace coach
