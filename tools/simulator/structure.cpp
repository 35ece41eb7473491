#include "tools/simulator/structure.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace coach {
namespace {

constexpr double kSamePosition = 1e-3;  // m
constexpr double kSameAngle = 0.01;     // rad
constexpr double kAxisStep = 0.1;       // rad, between the samples of a free axis

bool Same(const Pose& X, const Pose& Y) {
  return (X.translation() - Y.translation()).norm() < kSamePosition &&
         RotationAngle(X.linear().transpose() * Y.linear()) < kSameAngle;
}

struct TypedJoint {
  int type_a = 0, type_b = 0;
  Pose X_AB = Pose::Identity();
};

bool Equivalent(const Task& task, const TypedJoint& x, const TypedJoint& y) {
  for (const bool reversed : {false, true}) {
    const TypedJoint z = reversed ? TypedJoint{y.type_b, y.type_a, y.X_AB.inverse()} : y;
    if (x.type_a != z.type_a || x.type_b != z.type_b) continue;
    const auto all = Equivalents(task.types[static_cast<size_t>(x.type_a)].symmetries, x.X_AB,
                                 task.types[static_cast<size_t>(x.type_b)].symmetries);
    if (std::any_of(all.begin(), all.end(), [&](const Pose& X) { return Same(X, z.X_AB); })) return true;
  }
  return false;
}

}  // namespace

std::vector<int> OwnConnections(const Task& task) {
  if (!task.variants.empty()) return task.variants[0];
  std::vector<int> all(task.connections.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

Structure FinishedStructure(const Task& task) {
  Structure s;
  s.X_slot.assign(task.slots.size(), Pose::Identity());
  s.reached.assign(task.slots.size(), false);
  s.part.assign(task.slots.size(), -1);
  if (task.slots.empty()) return s;
  s.reached[0] = true;
  for (size_t round = 0; round < task.slots.size(); ++round) {
    for (const int index : OwnConnections(task)) {
      const Connection& c = task.connections[static_cast<size_t>(index)];
      const size_t a = static_cast<size_t>(c.slot_a), b = static_cast<size_t>(c.slot_b);
      if (s.reached[a] && !s.reached[b]) s.X_slot[b] = s.X_slot[a] * c.X_AB, s.reached[b] = true;
      if (s.reached[b] && !s.reached[a]) s.X_slot[a] = s.X_slot[b] * c.X_AB.inverse(), s.reached[a] = true;
    }
  }
  std::vector<bool> used(task.parts.size(), false);
  for (size_t slot = 0; slot < task.slots.size(); ++slot) {
    for (size_t p = 0; p < task.parts.size() && s.part[slot] < 0; ++p) {
      if (used[p] || task.parts[p].type != task.slots[slot].type) continue;
      s.part[slot] = static_cast<int>(p);
      used[p] = true;
    }
  }
  return s;
}

std::vector<Pose> Equivalents(const SymmetryGroup& a, const Pose& X_AB, const SymmetryGroup& b) {
  std::vector<Pose> all{X_AB};
  for (const Matrix3& sa : SampledElements(a, kAxisStep)) {
    for (const Matrix3& sb : SampledElements(b, kAxisStep)) {
      Pose X;
      X.linear() = sa.transpose() * X_AB.linear() * sb;
      X.translation() = sa.transpose() * X_AB.translation();
      if (std::none_of(all.begin(), all.end(), [&](const Pose& Y) { return Same(X, Y); })) all.push_back(X);
    }
  }
  return all;
}

std::vector<std::string> JointClasses(const Task& task) {
  std::vector<TypedJoint> joints;
  for (const Connection& c : task.connections) {
    joints.push_back(
        {task.slots[static_cast<size_t>(c.slot_a)].type, task.slots[static_cast<size_t>(c.slot_b)].type, c.X_AB});
  }
  for (const Mistake& m : task.mistakes) joints.push_back({m.type_a, m.type_b, m.X_AB});
  std::vector<std::string> classes;
  std::map<std::pair<int, int>, int> count;
  for (size_t i = 0; i < joints.size(); ++i) {
    size_t first = 0;
    while (first < i && !Equivalent(task, joints[first], joints[i])) ++first;
    if (first < i) {
      classes.push_back(classes[first]);
      continue;
    }
    const auto pair = std::minmax(joints[i].type_a, joints[i].type_b);
    classes.push_back(task.types[static_cast<size_t>(pair.first)].name + "-" +
                      task.types[static_cast<size_t>(pair.second)].name + "-" + std::to_string(count[pair]++));
  }
  return classes;
}

}  // namespace coach
