#include "services/pose_filter/connection_constraint.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "common/assembly/connection_probability.h"

namespace coach {
namespace {

constexpr double kFreeAxisStep = 30 * std::numbers::pi / 180;
/// Metres that a radian counts when looking for the nearest symmetric equivalent.
constexpr double kRadian = 0.05;

/// The relative pose, among those that look like `desired`, nearest to `estimated`.
Pose Nearest(const PartType& a, const PartType& b, const Pose& desired, const Pose& estimated) {
  Pose best = desired;
  double least = std::numeric_limits<double>::infinity();
  for (const Matrix3& Sa : SampledElements(a.symmetries, kFreeAxisStep)) {
    for (const Matrix3& Sb : SampledElements(b.symmetries, kFreeAxisStep)) {
      Pose candidate;
      candidate.linear() = Sa * desired.linear() * Sb.transpose();
      candidate.translation() = Sa * desired.translation();
      const Vector6 error = Difference(candidate, estimated);
      const double distance = error.head<3>().norm() + kRadian * error.tail<3>().norm();
      if (distance < least) {
        least = distance;
        best = candidate;
      }
    }
  }
  return best;
}

class LinkList {
 public:
  LinkList(const Task& task, const std::vector<Pose>& X_CP, const std::vector<bool>& known)
      : task_(task), X_CP_(X_CP), known_(known) {}

  bool Known(int part) const {
    return part >= 0 && static_cast<size_t>(part) < known_.size() && known_[static_cast<size_t>(part)];
  }
  Pose Relative(int a, int b) const { return X_CP_[static_cast<size_t>(a)].inverse() * X_CP_[static_cast<size_t>(b)]; }

  /// Adds the link, or replaces the one between the same parts if that is less probable or farther from the estimate.
  void Offer(int a, int b, const Pose& desired, double probability) {
    if (!(probability > 0)) return;
    RigidLink link{a, b, Nearest(task_.TypeOf(a), task_.TypeOf(b), desired, Relative(a, b)),
                   std::min(probability, 1.0)};
    if (a > b) link = {b, a, link.X_AB.inverse(), link.probability};
    const double distance = (link.X_AB.translation() - Relative(link.part_a, link.part_b).translation()).norm();
    const auto rank = std::pair(-link.probability, distance);
    auto [at, added] = best_.try_emplace({link.part_a, link.part_b}, rank, link);
    if (!added && rank < at->second.first) at->second = {rank, link};
  }

  std::vector<RigidLink> Sorted() const {
    std::vector<std::pair<std::pair<double, double>, RigidLink>> entries;
    for (const auto& [parts, entry] : best_) entries.push_back(entry);
    std::stable_sort(entries.begin(), entries.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    std::vector<RigidLink> links;
    for (const auto& entry : entries) links.push_back(entry.second);
    return links;
  }

 private:
  const Task& task_;
  const std::vector<Pose>& X_CP_;
  const std::vector<bool>& known_;
  std::map<std::pair<int, int>, std::pair<std::pair<double, double>, RigidLink>> best_;
};

}  // namespace

std::vector<RigidLink> FindLinks(const Task& task, const std::vector<Pose>& X_CP, const std::vector<bool>& known) {
  LinkList links(task, X_CP, known);
  const int parts = static_cast<int>(task.parts.size());
  for (const Connection& connection : task.connections) {
    const int type_a = task.slots[static_cast<size_t>(connection.slot_a)].type;
    const int type_b = task.slots[static_cast<size_t>(connection.slot_b)].type;
    for (int a = 0; a < parts; ++a) {
      if (task.parts[static_cast<size_t>(a)].type != type_a || !links.Known(a)) continue;
      for (int b = 0; b < parts; ++b) {
        if (b == a || task.parts[static_cast<size_t>(b)].type != type_b || !links.Known(b)) continue;
        links.Offer(a, b, connection.X_AB,
                    PaperConnectionProbability(task.TypeOf(a).symmetries, task.TypeOf(b).symmetries, connection.X_AB,
                                               links.Relative(a, b)));
      }
    }
  }
  return links.Sorted();
}

std::vector<RigidLink> FindLinks(const Task& task, const std::vector<Pose>& X_CP, const std::vector<bool>& known,
                                 const ConnectionBelief& belief) {
  LinkList links(task, X_CP, known);
  for (const ConnectionProbability& c : belief.connections) {
    if (!links.Known(c.part_a) || !links.Known(c.part_b) || c.part_a == c.part_b) continue;
    const int mistake = -1 - c.connection;
    if (c.connection >= 0 && static_cast<size_t>(c.connection) < task.connections.size()) {
      links.Offer(c.part_a, c.part_b, task.connections[static_cast<size_t>(c.connection)].X_AB, c.probability);
    } else if (mistake >= 0 && static_cast<size_t>(mistake) < task.mistakes.size()) {
      links.Offer(c.part_a, c.part_b, task.mistakes[static_cast<size_t>(mistake)].X_AB, c.probability);
    }
  }
  return links.Sorted();
}

RigidBodies::RigidBodies(int parts, const std::vector<RigidLink>& links, size_t num_links)
    : followers_(static_cast<size_t>(parts)), leads_(static_cast<size_t>(parts), true) {
  std::vector<bool> placed(static_cast<size_t>(parts));
  for (int first = 0; first < parts; ++first) {
    if (placed[static_cast<size_t>(first)]) continue;
    placed[static_cast<size_t>(first)] = true;
    auto& followers = followers_[static_cast<size_t>(first)];
    // Breadth first: `first`, then what hangs on it.
    for (size_t next = 0; next <= followers.size(); ++next) {
      const int leader = next == 0 ? first : followers[next - 1].part;
      for (size_t l = 0; l < num_links; ++l) {
        const RigidLink& link = links[l];
        if (link.part_a != leader && link.part_b != leader) continue;
        const int part = link.part_a == leader ? link.part_b : link.part_a;
        if (placed[static_cast<size_t>(part)]) continue;
        placed[static_cast<size_t>(part)] = true;
        leads_[static_cast<size_t>(part)] = false;
        followers.push_back({part, leader, link.part_a == leader ? link.X_AB : link.X_AB.inverse()});
      }
    }
  }
}

size_t NumEnforced(const std::vector<RigidLink>& links, double level, double cap) {
  size_t n = 0;
  while (n < links.size() && level < std::min(links[n].probability, cap)) ++n;
  return n;
}

}  // namespace coach
