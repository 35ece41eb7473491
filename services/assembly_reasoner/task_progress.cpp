#include "services/assembly_reasoner/task_progress.h"

#include <algorithm>
#include <numeric>

namespace coach {
namespace {

constexpr int kLargestSearch = 20000;  // nodes; beyond, the best placement found so far is taken

class PlacementSearch {
 public:
  PlacementSearch(const Task& task, const std::vector<MadeJoint>& joints, const std::vector<int>& previous, int variant,
                  double bonus)
      : task_(task), joints_(joints), previous_(previous), bonus_(bonus) {
    state_.variant = variant;
    state_.part_in_slot.assign(task.slots.size(), -1);
    state_.connection_of.assign(joints.size(), -1);
    Try(0, 0);
  }
  const Placement& best() const { return best_; }
  double best_score() const { return best_score_ + bonus_; }

 private:
  void Try(size_t i, double score) {
    if (++nodes_ > kLargestSearch) return;
    // An upper bound: every joint left is placed where it was.
    if (score + 1.1 * static_cast<double>(joints_.size() - i) <= best_score_) return;
    if (i == joints_.size()) {
      best_score_ = score;
      best_ = state_;
      return;
    }
    const auto& set = task_.variants[state_.variant];
    for (const int c : joints_[i].connections) {
      const bool used =
          std::find(state_.connection_of.begin(), state_.connection_of.end(), c) != state_.connection_of.end();
      if (used || std::find(set.begin(), set.end(), c) == set.end()) continue;
      TryOrder(i, score, c, joints_[i].part_a, joints_[i].part_b);
      TryOrder(i, score, c, joints_[i].part_b, joints_[i].part_a);
    }
    Try(i + 1, score);
  }
  void TryOrder(size_t i, double score, int c, int in_a, int in_b) {
    const int slot_a = task_.connections[c].slot_a, slot_b = task_.connections[c].slot_b;
    if (!Fits(in_a, slot_a) || !Fits(in_b, slot_b)) return;
    const int old_a = state_.part_in_slot[slot_a], old_b = state_.part_in_slot[slot_b];
    state_.part_in_slot[slot_a] = in_a;
    state_.part_in_slot[slot_b] = in_b;
    state_.connection_of[i] = c;
    // What was placed stays, first come first served; then the task file's order.
    const double keep = i < previous_.size() && previous_[i] == c ? 0.05 : 0;
    const double early = 0.01 * static_cast<double>(joints_.size() - i) / static_cast<double>(joints_.size());
    const double order =
        0.001 * static_cast<double>(task_.connections.size() - c) / static_cast<double>(task_.connections.size());
    Try(i + 1, score + 1 + keep + early + order);
    state_.connection_of[i] = -1;
    state_.part_in_slot[slot_a] = old_a;
    state_.part_in_slot[slot_b] = old_b;
  }
  bool Fits(int part, int slot) const {
    if (task_.parts[part].type != task_.slots[slot].type) return false;
    if (state_.part_in_slot[slot] == part) return true;
    if (state_.part_in_slot[slot] >= 0) return false;
    return std::find(state_.part_in_slot.begin(), state_.part_in_slot.end(), part) == state_.part_in_slot.end();
  }

  const Task& task_;
  const std::vector<MadeJoint>& joints_;
  const std::vector<int>& previous_;
  double bonus_;
  Placement state_, best_;
  double best_score_ = -1;
  int nodes_ = 0;
};

bool IsMade(const Placement& placement, int connection) {
  return std::find(placement.connection_of.begin(), placement.connection_of.end(), connection) !=
         placement.connection_of.end();
}

/// Sub-assembly of every slot: slots joined by made connections share a number.
std::vector<int> Groups(const Task& task, const Placement& placement, bool rigid_only) {
  std::vector<int> group(task.slots.size());
  std::iota(group.begin(), group.end(), 0);
  for (const int c : placement.connection_of) {
    if (c < 0 || (rigid_only && !task.connections[c].freedom.empty())) continue;
    const int from = group[task.connections[c].slot_a], to = group[task.connections[c].slot_b];
    std::replace(group.begin(), group.end(), from, to);
  }
  return group;
}

/// The steps of a variant in the order of asking, what closes by itself last.
std::vector<int> StepsOf(const Task& task, int variant) {
  std::vector<int> steps, closing;
  if (variant == 0) steps = task.steps;
  for (const int c : task.variants[variant]) {
    if (std::find(steps.begin(), steps.end(), c) != steps.end()) continue;
    const bool asked = variant != 0 && !task.connections[c].closes_by_itself;
    (asked ? steps : closing).push_back(c);
  }
  steps.insert(steps.end(), closing.begin(), closing.end());
  return steps;
}

}  // namespace

Placement Place(const Task& task, const std::vector<MadeJoint>& joints, const std::vector<int>& previous,
                int previous_variant) {
  Placement best;
  best.part_in_slot.assign(task.slots.size(), -1);
  best.connection_of.assign(joints.size(), -1);
  double best_score = -1;
  for (size_t v = 0; v < task.variants.size(); ++v) {
    const bool stays = static_cast<int>(v) == previous_variant;
    const PlacementSearch search(task, joints, previous, static_cast<int>(v), stays ? 0.02 : 0);
    if (search.best_score() > best_score) {
      best_score = search.best_score();
      best = search.best();
    }
  }
  return best;
}

std::vector<int> ImpliedConnections(const Task& task, const Placement& placement) {
  std::vector<int> out;
  if (task.variants.empty()) return out;
  const std::vector<int> group = Groups(task, placement, true);
  for (const int c : task.variants[placement.variant]) {
    const Connection& connection = task.connections[c];
    if (IsMade(placement, c) || !connection.freedom.empty()) continue;
    if (group[connection.slot_a] != group[connection.slot_b]) continue;
    if (placement.part_in_slot[connection.slot_a] >= 0 && placement.part_in_slot[connection.slot_b] >= 0)
      out.push_back(c);
  }
  return out;
}

int NextConnection(const Task& task, const Placement& placement, const std::vector<int>& skipped) {
  if (task.variants.empty()) return -1;
  const std::vector<int> group = Groups(task, placement, false);
  const auto size = [&](int slot) {
    return placement.part_in_slot[slot] < 0 ? 0 : std::count(group.begin(), group.end(), group[slot]);
  };
  int next = -1;
  std::ptrdiff_t largest = -1;
  const std::vector<int> steps = StepsOf(task, placement.variant);
  for (const int c : steps) {
    const bool skip = std::find(skipped.begin(), skipped.end(), c) != skipped.end();
    if (IsMade(placement, c) || skip) continue;
    const Connection& connection = task.connections[c];
    if (connection.closes_by_itself && next >= 0) continue;
    const std::ptrdiff_t grows = std::max(size(connection.slot_a), size(connection.slot_b));
    if (grows > largest) {
      largest = grows;
      next = c;
    }
  }
  return next;
}

std::pair<int, int> PartsFor(const Task& task, const Placement& placement, int connection,
                             const std::vector<bool>& unavailable) {
  std::vector<int> taken = placement.part_in_slot;
  const auto choose = [&](int slot) {
    if (placement.part_in_slot[slot] >= 0) return placement.part_in_slot[slot];
    int any = -1;
    for (size_t p = 0; p < task.parts.size(); ++p) {
      const int part = static_cast<int>(p);
      if (task.parts[p].type != task.slots[slot].type) continue;
      if (std::find(taken.begin(), taken.end(), part) != taken.end()) continue;
      if (p >= unavailable.size() || !unavailable[p]) {
        taken.push_back(part);
        return part;
      }
      if (any < 0) any = part;
    }
    if (any >= 0) taken.push_back(any);
    return any;
  };
  const int a = choose(task.connections[connection].slot_a);
  return {a, choose(task.connections[connection].slot_b)};
}

}  // namespace coach
