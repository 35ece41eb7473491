#include "common/assembly/task_check.h"

#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <sstream>

namespace coach {
namespace {

constexpr double kAxisStep = std::numbers::pi / 36;  // of continuous symmetries, when two ends are compared

struct Gap {
  double position = 1e9, angle = 1e9;
};

/// The smallest difference of S_A X S_B from Y over the symmetries of the two ends.
Gap SmallestGap(const SymmetryGroup& a, const SymmetryGroup& b, const Pose& X, const Pose& Y) {
  Gap best;
  for (const Matrix3& S : SampledElements(a, kAxisStep)) {
    Pose turned = Pose::Identity();
    turned.linear() = S;
    const Pose X_turned = turned * X;
    const Gap gap{(X_turned.translation() - Y.translation()).norm(), RotationError(b, Y.linear(), X_turned.linear())};
    if (gap.position + 0.1 * gap.angle < best.position + 0.1 * best.angle) best = gap;
  }
  return best;
}

/// Pose of slot `to` in slot `from` along rigid connections of `connections` other than `without`; nothing if none.
std::optional<Pose> PathPose(const Task& task, const std::vector<int>& connections, int without, int from, int to) {
  std::vector<std::optional<Pose>> X(task.slots.size());
  X[from] = Pose::Identity();
  std::deque<int> queue{from};
  while (!queue.empty()) {
    const int at = queue.front();
    queue.pop_front();
    if (at == to) return X[to];
    for (const int i : connections) {
      const Connection& c = task.connections[i];
      if (i == without || !c.freedom.empty()) continue;
      if (c.slot_a == at && !X[c.slot_b]) {
        X[c.slot_b] = *X[at] * c.X_AB;
        queue.push_back(c.slot_b);
      } else if (c.slot_b == at && !X[c.slot_a]) {
        X[c.slot_a] = *X[at] * c.X_AB.inverse();
        queue.push_back(c.slot_a);
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::string RingProblem(const Task& task, const std::vector<int>& connections, double position_tolerance,
                        double angle_tolerance) {
  for (const int i : connections) {
    const Connection& c = task.connections[i];
    if (!c.freedom.empty()) continue;
    const auto round = PathPose(task, connections, i, c.slot_a, c.slot_b);
    if (!round) continue;
    const SymmetryGroup& a = task.types[task.slots[c.slot_a].type].symmetries;
    const SymmetryGroup& b = task.types[task.slots[c.slot_b].type].symmetries;
    const Gap gap = SmallestGap(a, b, *round, c.X_AB);
    if (gap.position > position_tolerance || gap.angle > angle_tolerance) {
      std::ostringstream out;
      out.precision(3);
      out << "a ring through " << c.name << " that misses by " << gap.position * 1000 << " mm and "
          << gap.angle * 180 / std::numbers::pi << " degrees";
      return out.str();
    }
  }
  return "";
}

}  // namespace coach
