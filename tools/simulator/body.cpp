#include "tools/simulator/body.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coach {
namespace {

constexpr double kPi = std::numbers::pi;

double WrapAngle(double a) { return std::remainder(a, 2 * kPi); }

/// The joint between two bones that reach from a to b, bent towards `pole`.
Vector3 Elbow(const Vector3& a, const Vector3& b, double first, double second, const Vector3& pole) {
  const Vector3 way = b - a;
  const double distance = std::clamp(way.norm(), 1e-3, first + second - 1e-3);
  const Vector3 axis = way.normalized();
  const double along = (first * first - second * second + distance * distance) / (2 * distance);
  const double aside = std::sqrt(std::max(0.0, first * first - along * along));
  const Vector3 out = (pole - axis * pole.dot(axis)).normalized();
  return a + along * axis + aside * out;
}

/// Three bones from a to b with equal bends, bulging towards `pole`: the inner two joints.
std::array<Vector3, 2> Finger(const Vector3& a, const Vector3& b, const std::array<double, 3>& bones,
                              const Vector3& pole) {
  const Vector3 way = b - a;
  const double distance = std::min(way.norm(), 0.995 * (bones[0] + bones[1] + bones[2]));
  const auto chain = [&](double bend) {
    std::array<Eigen::Vector2d, 4> p{Eigen::Vector2d::Zero()};
    for (size_t i = 0; i < 3; ++i) {
      p[i + 1] = p[i] + bones[i] * Eigen::Vector2d(std::cos(bend * static_cast<double>(i)),
                                                   std::sin(bend * static_cast<double>(i)));
    }
    return p;
  };
  double low = 0, high = 2.0;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (low + high);
    (chain(middle)[3].norm() > distance ? low : high) = middle;
  }
  const auto p = chain(0.5 * (low + high));
  const Vector3 x = way.normalized();
  const Vector3 y = (pole - x * pole.dot(x)).normalized();
  const Eigen::Vector2d e = p[3].normalized();
  const auto place = [&](const Eigen::Vector2d& q) -> Vector3 {
    // The chain bends to its left; seen from its end-to-end line it bulges to the right.
    return a + x * e.dot(q) - y * (e.x() * q.y() - e.y() * q.x());
  };
  return {place(p[1]), place(p[2])};
}

struct HandFrame {
  Vector3 p, x, y, z;
  Vector3 At(double a, double b, double c) const { return p + a * x + b * y + c * z; }
};

HandFrame Frame(const HandPose& hand) {
  const Vector3 x(std::cos(hand.yaw), std::sin(hand.yaw), 0);
  return {hand.p_W, x, Vector3(-x.y(), x.x(), 0), Vector3::UnitZ()};
}

double Mix(double a, double b, double t) { return a + t * (b - a); }
Vector3 Mix(const Vector3& a, const Vector3& b, double t) { return a + t * (b - a); }

Vector3 Wrist(const HandPose& hand, double size) {
  return Frame(hand).At(Mix(-0.105, -0.125, hand.flat) * size, 0, Mix(0.075, 0.03, hand.flat) * size);
}

void AddHand(const HandPose& hand, Side side, double size, std::vector<RoundSegment>* skin) {
  const HandFrame h = Frame(hand);
  const double mirror = side == Side::kLeft ? -1 : 1;  // the thumb is on +y of the right hand (palm down)
  const Vector3 wrist = Wrist(hand, size);
  const double half = 0.5 * hand.spread;
  const std::array<double, 4> beside{1, 0.35, -0.35, -1};          // index .. little, in units of 24 mm
  const std::array<double, 4> length{0.066, 0.074, 0.068, 0.054};  // m
  for (size_t i = 0; i < 4; ++i) {
    const double b = mirror * beside[i] * size;
    const Vector3 knuckle =
        Mix(h.At(-0.045 * size, 0.030 * b, 0.068 * size), h.At(-0.055 * size, 0.030 * b, 0.022 * size), hand.flat);
    // Sideways grasp: the fingers stand in a row on the far side; forward grasp: in a row across.
    const double row = 0.013 * (static_cast<double>(i) - 0.5) * size;
    const Vector3 sideways = h.At(-row + 0.008, -mirror * half, 0.002 * static_cast<double>(i));
    const Vector3 forward = h.At(half, 0.016 * b, 0.002 * static_cast<double>(i));
    const Vector3 pinch = Mix(forward, sideways, hand.across);
    const Vector3 open = h.At((0.012 + 0.3 * (length[i] - 0.05)) * size, 0.042 * b, 0.008);
    const Vector3 tip = Mix(pinch, open, hand.flat);
    const std::array<double, 3> bones{0.46 * length[i] * size, 0.30 * length[i] * size, 0.24 * length[i] * size};
    const auto joints = Finger(knuckle, tip, bones, h.At(0.3, -0.3 * mirror * hand.across, 1) - h.p);
    const double r = (i == 3 ? 0.0062 : 0.0072) * size;
    skin->push_back({wrist, knuckle, 0.0165 * size, 0.0105 * size});
    skin->push_back({knuckle, joints[0], 1.15 * r, r});
    skin->push_back({joints[0], joints[1], r, 0.93 * r});
    skin->push_back({joints[1], joints[1] + (tip - joints[1]).normalized() * bones[2], 0.93 * r, 0.8 * r});
  }
  const Vector3 base = Mix(wrist, h.At(-0.05 * size, 0.02 * mirror * size, 0.05 * size), 0.45);
  const Vector3 pinch = Mix(h.At(-half, 0.006 * mirror, 0), h.At(0.0, mirror * half, 0), hand.across);
  const Vector3 tip = Mix(pinch, h.At(-0.045 * size, 0.062 * mirror * size, 0.01), hand.flat);
  const auto joints =
      Finger(base, tip, {0.042 * size, 0.032 * size, 0.026 * size}, h.At(-0.6, 1.0 * mirror, 0.4) - h.p);
  skin->push_back({base, joints[0], 0.014 * size, 0.0105 * size});
  skin->push_back({joints[0], joints[1], 0.0105 * size, 0.009 * size});
  skin->push_back({joints[1], joints[1] + (tip - joints[1]).normalized() * 0.026 * size, 0.009 * size, 0.007 * size});
  skin->push_back({Mix(wrist, h.At(-0.05 * size, 0.02 * size, 0.05 * size), 0.6),
                   h.At(-0.05 * size, -0.012 * size, Mix(0.062, 0.022, hand.flat) * size), 0.014 * size, 0.012 * size});
}

}  // namespace

HandPose Between(const HandPose& a, const HandPose& b, double progress) {
  HandPose h;
  h.p_W = Mix(a.p_W, b.p_W, progress);
  h.yaw = a.yaw + progress * WrapAngle(b.yaw - a.yaw);
  h.spread = Mix(a.spread, b.spread, progress);
  h.across = Mix(a.across, b.across, progress);
  h.flat = Mix(a.flat, b.flat, progress);
  return h;
}

BodySegments PoseBody(const BodyShape& shape, const std::array<HandPose, 2>& hands) {
  BodySegments body;
  const double s = shape.size;
  const double upper = 0.235 * s, lower = 0.215 * s;
  const Vector3 chest_at_rest = shape.seat + Vector3(0, -0.03, 0.33 * s);
  // The trunk leans towards what the arms can't reach.
  Vector3 lean = Vector3::Zero();
  for (const HandPose& hand : hands) {
    Vector3 way = Wrist(hand, s) - chest_at_rest;
    const double missing = way.norm() - 0.93 * (upper + lower);
    if (missing > 0) lean += missing * Vector3(way.x(), way.y(), 0.25 * way.z()).normalized();
  }
  if (lean.norm() > 0.3) lean *= 0.3 / lean.norm();
  const Vector3 chest = chest_at_rest + lean;
  const Vector3 hips = shape.seat + Vector3(0, 0.02, -0.05);
  const Vector3 waist = Mix(hips, chest, 0.5);
  for (const double side : {-1.0, 1.0}) {
    const Vector3 out(side * 0.055 * s, 0, 0);
    body.clothes.push_back({hips + out, waist + out, 0.085 * s, 0.085 * s});
    body.clothes.push_back({waist + out, chest + 1.1 * out, 0.085 * s, 0.08 * s});
  }
  for (size_t i = 0; i < 2; ++i) {
    // The child faces the camera (-y): its left is at +x.
    const double side = i == 0 ? 1 : -1;
    const Vector3 shoulder = chest + Vector3(side * 0.135 * s, 0, 0.035 * s);
    const Vector3 wrist = Wrist(hands[i], s);
    const Vector3 reach =
        shoulder + (wrist - shoulder) * std::min(1.0, (upper + lower - 0.002) / (wrist - shoulder).norm());
    const Vector3 elbow = Elbow(shoulder, reach, upper, lower, Vector3(side * 0.9, 0.35, -0.35));
    body.clothes.push_back({chest + Vector3(side * 0.05 * s, 0, 0.04 * s), shoulder, 0.06 * s, 0.052 * s});
    body.clothes.push_back({shoulder, elbow, 0.05 * s, 0.042 * s});
    const double covered = std::clamp((shape.sleeve * (upper + lower) - upper) / lower, 0.02, 0.95);
    const Vector3 cuff = Mix(elbow, wrist, covered);
    body.clothes.push_back({elbow, cuff, 0.042 * s, Mix(0.042, 0.031, covered) * s});
    body.skin.push_back({elbow, wrist, 0.032 * s, 0.0215 * s});
    AddHand(hands[i], static_cast<Side>(i), s, &body.skin);
  }
  const Vector3 neck = chest + Vector3(0, -0.01, 0.09 * s);
  const Vector3 head = neck + Vector3(0, -0.03, 0.13 * s) + 0.15 * lean;
  body.skin.push_back({chest, head, 0.042 * s, 0.042 * s});
  body.skin.push_back({head, head + Vector3(0, 0, 0.045 * s), 0.072 * s, 0.075 * s});
  body.hair.push_back({head + Vector3(0, 0.02, 0.06 * s), head + Vector3(0, 0.03, 0.03 * s), 0.078 * s, 0.07 * s});
  return body;
}

}  // namespace coach
