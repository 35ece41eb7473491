#include "tools/simulator/child.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace coach {
namespace {

constexpr double kPi = std::numbers::pi;

double Yaw(const Vector3& v) { return std::atan2(v.y(), v.x()); }
double AngleBetween(double a, double b) { return std::abs(std::remainder(a - b, 2 * kPi)); }

Pose Shifted(const Pose& X, const Vector3& by) {
  Pose Y = X;
  Y.translation() += by;
  return Y;
}

}  // namespace

ChildStyle StyleByName(const std::string& name) {
  if (name == "normal") return {};
  if (name == "slow") return {.speed = 0.22, .pause = 0.9, .hesitation = 0.2, .dock_time = 1.4};
  if (name == "hasty") return {.speed = 0.6, .pause = 0.15, .hesitation = 0.02, .dock_time = 0.5};
  if (name == "hesitant") return {.speed = 0.3, .pause = 1.2, .hesitation = 0.6, .dock_time = 1.6};
  throw std::invalid_argument("style: found " + name + ", expected slow, normal, hasty or hesitant");
}

const char* ToString(Side hand) { return hand == Side::kLeft ? "left" : "right"; }
Side Other(Side hand) { return hand == Side::kLeft ? Side::kRight : Side::kLeft; }

HandPose HomeOf(Side hand) {
  HandPose home;
  home.p_W = Vector3(hand == Side::kLeft ? 0.2 : -0.2, 0.3, 0.012);
  home.yaw = -0.5 * kPi + (hand == Side::kLeft ? -0.3 : 0.3);
  home.spread = 0.05;
  home.flat = 0.85;
  return home;
}

Child::Child(const Task& task, const Solids& solids, const ChildStyle& style, Performance* performance, Random* random)
    : task_(task), solids_(solids), style_(style), performance_(performance), random_(random) {
  for (int i = 0; i < performance_->things.size(); ++i) group_.push_back(i);
}

double Child::TimeFor(double distance) const {
  return std::max(0.35, distance / style_.speed) * random_->Uniform(0.9, 1.15);
}

void Child::Event(const std::string& kind, std::vector<int> things, Side hand) {
  std::erase_if(things, [&](int t) { return t >= static_cast<int>(task_.parts.size()); });
  performance_->events.push_back({.time = now_, .kind = kind, .parts = things, .hand = ToString(hand)});
}

void Child::MoveHand(Side hand, const HandPose& to, double lift, double seconds) {
  const double start = std::max(now_, hand_free_[static_cast<size_t>(hand)]);
  HandSegment s{
      .start = start, .end = start + seconds, .from = performance_->HandAt(hand, start), .to = to, .lift = lift};
  performance_->hands[static_cast<size_t>(hand)].push_back(s);
  hand_free_[static_cast<size_t>(hand)] = s.end;
}

HandPose Child::GraspOf(Side hand, int thing, Vector3* p_thing) const {
  const Pose X = PoseOf(thing);
  const MeshExtent& e = solids_.extent(thing);
  // The horizontal sides of the box: the longer one is `along`.
  std::array<Vector3, 3> axes;
  for (int i = 0; i < 3; ++i) axes[static_cast<size_t>(i)] = X.linear().col(i) * (e.high[i] - e.low[i]);
  std::sort(axes.begin(), axes.end(),
            [](const Vector3& a, const Vector3& b) { return a.head<2>().norm() > b.head<2>().norm(); });
  const Vector3 along(axes[0].x(), axes[0].y(), 0);
  const double width = std::max(0.012, axes[1].head<2>().norm());
  const double top = X.translation().z() + solids_.Highest(thing, X.linear());
  Vector3 p = X * e.centre + random_->Uniform(-0.22, 0.22) * along;
  p.z() = std::max(0.011, top - 0.016);
  *p_thing = X.inverse() * p;
  const Vector3 shoulder(hand == Side::kLeft ? 0.15 : -0.15, 0.5, 0);
  const double natural = Yaw(p - shoulder);
  HandPose best;
  double least = 1e9;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double yaw = Yaw(along) + 0.5 * kPi * quarter;
    const double off = AngleBetween(yaw, natural) + (quarter % 2 ? 0.1 : 0);
    if (off >= least) continue;
    least = off;
    best.yaw = yaw;
    best.across = quarter % 2 ? 0 : 1;
    best.spread = quarter % 2 && width > 0.08 ? 0.05 : width + 0.004;
  }
  best.p_W = p;
  return best;
}

void Child::Reach(Side hand, int thing) {
  now_ = std::max(now_, hand_free_[static_cast<size_t>(hand)]);
  Vector3 p_thing;
  HandPose grasp = GraspOf(hand, thing, &p_thing);
  HandPose open = grasp;
  open.spread += 0.03;
  const HandPose from = performance_->HandAt(hand, now_);
  HandPose above = open;
  above.p_W.z() += 0.05;
  double distance = (above.p_W - from.p_W).norm();
  if (random_->Chance(style_.hesitation)) {
    const HandPose half = Between(from, above, 0.6);
    MoveHand(hand, half, 0.05, TimeFor(0.6 * distance));
    now_ = hand_free_[static_cast<size_t>(hand)] + random_->Uniform(0.3, 0.3 + style_.pause);
    distance *= 0.4;
  }
  MoveHand(hand, above, 0.03, TimeFor(distance));
  MoveHand(hand, open, 0, 0.25 * 0.35 / style_.speed);
  MoveHand(hand, grasp, 0, 0.15);
  now_ = hand_free_[static_cast<size_t>(hand)];
  performance_->hands[static_cast<size_t>(hand)].push_back(
      {.start = now_, .end = now_, .from = grasp, .to = grasp, .thing = thing, .p_thing = p_thing});
  held_[static_cast<size_t>(hand)] = thing;
  Event("grasp", {thing}, hand);
}

std::vector<int> Child::GroupMembers(int thing) const {
  std::vector<int> members;
  for (int i = 0; i < static_cast<int>(group_.size()); ++i) {
    if (Group(i) == Group(thing)) members.push_back(i);
  }
  return members;
}

void Child::CarryGroup(int thing, const Pose& X_W, double lift, double seconds) {
  const Pose from = PoseOf(thing);
  for (int member : GroupMembers(thing)) {
    if (member == thing) continue;
    performance_->things.Add(member, {.start = now_,
                                      .end = now_,
                                      .carrier = thing,
                                      .X_carrier_thing = from.inverse() * performance_->things.At(member, now_)});
  }
  performance_->things.Add(thing, {.start = now_, .end = now_ + seconds, .from = from, .to = X_W, .lift = lift});
}

/// The lift (m) from `least` on with which nothing is met on the way; `least` if there is none.
double Child::FreeLift(int thing, const Pose& X_W, double least) const {
  constexpr int kSamples = 80;
  const Pose from = PoseOf(thing);
  std::vector<int> others;
  for (int i = 0; i < static_cast<int>(group_.size()); ++i) {
    if (!Together(i, thing)) others.push_back(i);
  }
  for (double lift = least; lift < least + 0.25; lift += 0.03) {
    const ThingSegment way{.start = 0, .end = kSamples, .from = from, .to = X_W, .lift = lift};
    bool free = true;
    for (int k = 1; k < kSamples && free; ++k) {
      const Pose X_by = PoseDuring(way, k) * from.inverse();
      for (const int member : GroupMembers(thing)) free = free && !Blocked(member, X_by * PoseOf(member), others);
    }
    if (free) return lift;
  }
  return least;
}

void Child::Carry(Side hand, const Pose& X_W, double lift, double seconds) {
  const int thing = HeldBy(hand);
  lift = FreeLift(thing, X_W, lift);
  const Pose from = PoseOf(thing);
  const Matrix3 turn = X_W.linear() * from.linear().transpose();
  if (seconds <= 0) {
    seconds = std::max(TimeFor((X_W.translation() - from.translation()).norm() + lift),
                       RotationAngle(turn) / (3.5 * style_.speed / 0.35));
  }
  auto& track = performance_->hands[static_cast<size_t>(hand)];
  const HandPose held = performance_->HandAt(hand, now_);
  HandPose to = held;
  // The hand turns with what it holds, within what a wrist can do.
  const double yaw = std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
  const Vector3 shoulder(hand == Side::kLeft ? 0.15 : -0.15, 0.5, 0);
  const double natural = Yaw(X_W.translation() - shoulder);
  to.yaw = natural + std::clamp(std::remainder(held.yaw + yaw - natural, 2 * kPi), -1.9, 1.9);
  const Vector3 p_thing = track.back().p_thing;
  track.push_back({.start = now_, .end = now_ + seconds, .from = held, .to = to, .thing = thing, .p_thing = p_thing});
  CarryGroup(thing, X_W, lift, seconds);
  now_ += seconds;
  hand_free_[static_cast<size_t>(hand)] = now_;
}

void Child::Release(Side hand) {
  const int thing = HeldBy(hand);
  HandPose open = performance_->HandAt(hand, now_);
  open.spread += 0.03;
  hand_free_[static_cast<size_t>(hand)] = now_;
  Event("release", {thing}, hand);
  held_[static_cast<size_t>(hand)] = -1;
  MoveHand(hand, open, 0, 0.2);
  HandPose up = open;
  up.p_W += Vector3(0, 0.03, 0.07);
  MoveHand(hand, up, 0, 0.3 * 0.35 / style_.speed);
  const double left = hand_free_[static_cast<size_t>(hand)];
  const HandPose home = HomeOf(hand);
  MoveHand(hand, home, 0.03, TimeFor((home.p_W - up.p_W).norm()));
  now_ = left;
}

void Child::Cover(Side hand, int thing, double seconds) {
  now_ = std::max(now_, hand_free_[static_cast<size_t>(hand)]);
  const Pose X = PoseOf(thing);
  HandPose over = HomeOf(hand);
  over.flat = 1;
  over.p_W = X * solids_.extent(thing).centre + Vector3(0, -0.01, 0);
  over.p_W.z() = X.translation().z() + solids_.Highest(thing, X.linear()) + 0.012;
  const Vector3 shoulder(hand == Side::kLeft ? 0.15 : -0.15, 0.5, 0);
  over.yaw = Yaw(over.p_W - shoulder);
  MoveHand(hand, over, 0.04, TimeFor((over.p_W - performance_->HandAt(hand, now_).p_W).norm()));
  now_ = hand_free_[static_cast<size_t>(hand)];
  Event("cover_start", {thing}, hand);
  now_ += seconds;
  hand_free_[static_cast<size_t>(hand)] = now_;
  Event("cover_end", {thing}, hand);
  const HandPose home = HomeOf(hand);
  MoveHand(hand, home, 0.05, TimeFor((home.p_W - over.p_W).norm()));
}

bool Child::Blocked(int part, const Pose& X_W, const std::vector<int>& things) const {
  return std::any_of(things.begin(), things.end(),
                     [&](int t) { return t != part && solids_.Overlap(part, X_W, t, PoseOf(t)); });
}

bool Child::Blocked(int part, const Pose& X_W) const {
  std::vector<int> things(group_.size());
  std::iota(things.begin(), things.end(), 0);
  return Blocked(part, X_W, things);
}

Vector3 Child::Approach(int part, const Pose& X_W) const {
  std::vector<Vector3> directions{Vector3::UnitZ()};
  for (int i = 0; i < 3; ++i) {
    const Vector3 axis = X_W.linear().col(i);
    const Vector3 flat(axis.x(), axis.y(), 0);
    if (flat.norm() < 0.7) continue;
    directions.push_back(flat.normalized());
    directions.push_back(-flat.normalized());
  }
  const size_t first = static_cast<size_t>(random_->Pick(static_cast<int>(directions.size())));
  for (size_t k = 0; k < directions.size(); ++k) {
    const Vector3& d = directions[k == 0 ? 0 : 1 + (first + k) % (directions.size() - 1)];
    bool free = true;
    for (const double way : {0.004, 0.01, 0.02, 0.03, 0.045, 0.06})
      free = free && !Blocked(part, Shifted(X_W, way * d));
    if (free) return d;
  }
  return Vector3::UnitZ();
}

double Child::Join(Side hand, const Joint& joint) {
  if (joint.steady && HeldBy(Other(hand)) < 0) Reach(Other(hand), joint.base);
  if (HeldBy(hand) != joint.part) {
    Reach(hand, joint.part);
    Wait(random_->Uniform(0, 0.3));
  }
  const Pose X_W = PoseOf(joint.base) * joint.X_base_part;
  const Vector3 d = Approach(joint.part, X_W);
  const Pose before = Shifted(X_W, 0.05 * d);
  Carry(hand, before, 0.07);
  if (joint.near_miss > 0) {
    Carry(hand, Shifted(X_W, joint.near_miss * d), 0, style_.dock_time);
    performance_->events.push_back({.time = now_,
                                    .kind = "near_miss_start",
                                    .parts = {joint.base, joint.part},
                                    .connection = joint.near_miss_name});
    Wait(1.7);
    performance_->events.push_back(
        {.time = now_, .kind = "near_miss_end", .parts = {joint.base, joint.part}, .connection = joint.near_miss_name});
  }
  Carry(hand, X_W, 0, style_.dock_time * random_->Uniform(0.8, 1.2));
  const int merged = Group(joint.base), old = Group(joint.part);
  std::replace(group_.begin(), group_.end(), old, merged);
  const double closed = now_;
  Wait(0.25);
  if (joint.keep) return closed;
  Release(hand);
  if (HeldBy(Other(hand)) == joint.base) Release(Other(hand));
  Wait(style_.pause * random_->Uniform(0.5, 1.5));
  return closed;
}

void Child::TakeOff(Side hand, int part, const std::string& connection, int from, const Pose& X_W) {
  if (HeldBy(hand) != part) Reach(hand, part);
  std::vector<int> others = GroupMembers(part);
  std::erase(others, part);
  const Vector3 d = Approach(part, PoseOf(part));
  // The others stay where they are: they must not follow the part any more.
  for (int other : others) {
    const Pose X = PoseOf(other);
    performance_->things.Add(other, {.start = now_, .end = now_, .from = X, .to = X});
  }
  group_[static_cast<size_t>(part)] = part;
  if (!others.empty()) {
    for (int other : others) group_[static_cast<size_t>(other)] = others[0];
  }
  performance_->events.push_back(
      {.time = now_ + 0.1, .kind = "disconnect", .parts = {from, part}, .connection = connection});
  Carry(hand, Shifted(PoseOf(part), 0.05 * d), 0, style_.dock_time);
  Carry(hand, X_W, 0.06);
  Release(hand);
  Wait(style_.pause);
}

}  // namespace coach
