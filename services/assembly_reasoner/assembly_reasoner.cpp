#include "services/assembly_reasoner/assembly_reasoner.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace coach {
namespace {

constexpr int64_t kLongestGap = 300000;   // us without evidence after which a decision has to mature anew
constexpr double kSamePlace = 0.003;      // m
constexpr double kReportedBelief = 0.05;  // connections less probable than this are not told to the filter

AssemblyBeliefOptions BeliefOptions(const AssemblyReasonerOptions& options) {
  if (!options.paper) return options.belief;
  AssemblyBeliefOptions memoryless;
  memoryless.forgetting_time = 0;
  memoryless.price_connection = memoryless.price_mistake = memoryless.stickiness = 0;
  return memoryless;
}

std::string Refusal(const PartPoses& poses, size_t parts, int64_t last) {
  if (poses.parts.size() != parts)
    return "poses of " + std::to_string(poses.parts.size()) + " parts, the task has " + std::to_string(parts);
  if (poses.utime <= last) return "utime " + std::to_string(poses.utime) + " is not after " + std::to_string(last);
  for (size_t i = 0; i < parts; ++i) {
    const PartEstimate& part = poses.parts[i];
    if (!part.X_TP.matrix().allFinite() || !std::isfinite(part.visible_fraction))
      return "the pose of part " + std::to_string(i) + " is not finite";
  }
  return "";
}

}  // namespace

struct AssemblyReasoner::Impl {
  Task task;
  AssemblyReasonerOptions options;
  ContactTable contacts;
  std::unique_ptr<ConnectionModel> model;
  AssemblyBelief belief;
  std::vector<BelievedJoint> joints;
  Placement placement;
  struct Pending {
    int label = kOpenLabel;
    int64_t start = 0, last = 0;  ///< us
  };
  std::map<PairKey, Pending> pending;
  std::map<PairKey, int> pinned;  ///< labels that the operator set and evidence has not confirmed yet
  HiddenParts hidden;
  std::set<PairKey> unseen;  ///< pairs whose joint, if any, was only inferred
  int64_t last_utime = INT64_MIN;

  Impl(Task t, const AssemblyReasonerOptions& o)
      : task(std::move(t)), options(o), contacts(task), belief(BeliefOptions(o)), hidden(o.hidden) {
    model = options.paper ? MakePaperConnectionModel(task, contacts)
                          : MakeCoachConnectionModel(task, contacts, options.model);
    placement = Place(task, {}, {}, 0);
  }

  const std::vector<ContactClass>& Classes(const PairKey& pair) const {
    return contacts.Classes(task.parts[pair.first].type, task.parts[pair.second].type);
  }
  std::vector<BelievedJoint>::iterator Find(const PairKey& pair) {
    return std::find_if(joints.begin(), joints.end(),
                        [&](const BelievedJoint& j) { return j.part_a == pair.first && j.part_b == pair.second; });
  }

  void Observe(const PartPoses& poses);
  void Learn(const PairView& view);
  void ExchangeIdentities(const PartPoses& poses);
  std::map<PairKey, int> Implied() const;
  void DecideAll(int64_t now, std::vector<ConnectionEvent>& events);
  double HoldFor(const PairKey& pair, int label) const;
  bool Explained(const PairKey& pair) const;
  void Change(const PairKey& pair, int label, int64_t since, int64_t now, std::vector<ConnectionEvent>& events);
  void PlaceAgain(int64_t now, std::vector<ConnectionEvent>& events);
  std::string NameOf(const BelievedJoint& joint) const;
  ConnectionEvent EventOf(const BelievedJoint& joint, const char* type, int64_t since, int64_t now) const;
  AssemblyState State(int64_t utime) const;
  ConnectionBelief Belief(int64_t utime) const;
};

void AssemblyReasoner::Impl::Observe(const PartPoses& poses) {
  std::map<PairKey, const PairEvidence*> given;
  std::vector<bool> misfit(task.parts.size(), false), pressed(task.parts.size(), false);
  for (const PairEvidence& pair : poses.pairs) {
    given[{pair.part_a, pair.part_b}] = &pair;
    if (pair.surface_distance < -options.deepest_overlap) misfit[pair.part_a] = misfit[pair.part_b] = true;
    if (pair.surface_distance < -options.break_overlap) pressed[pair.part_a] = pressed[pair.part_b] = true;
  }
  const std::vector<PairEvidence> inferred = options.paper ? std::vector<PairEvidence>{} : hidden.Infer(poses);
  for (const PairEvidence& pair : inferred) given.try_emplace({pair.part_a, pair.part_b}, &pair);
  const int n = static_cast<int>(task.parts.size());
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < n; ++b) {
      const auto& classes = Classes({a, b});
      const auto found = given.find({a, b});
      PairView view{poses.utime, a, b, &poses.parts[a], &poses.parts[b]};
      view.evidence = found == given.end() ? nullptr : found->second;
      if (classes.empty() && view.evidence == nullptr) continue;
      view.inferred = !inferred.empty() && view.evidence >= &inferred.front() && view.evidence <= &inferred.back();
      view.misfit = misfit[a] || misfit[b];
      view.pressed = pressed[a] || pressed[b];
      const auto joint = Find({a, b});
      view.decided = joint == joints.end() ? kOpenLabel : joint->label;
      std::vector<bool> is_connection;
      for (const ContactClass& c : classes) is_connection.push_back(!c.connections.empty());
      const PairVerdict verdict = model->Judge(view);
      belief.Observe({a, b}, verdict, is_connection, poses.utime);
      if (verdict.has_evidence) Learn(view);
    }
  }
}

/// Keeps where seen joints put their parts, and which joints are known by a partner only.
void AssemblyReasoner::Impl::Learn(const PairView& view) {
  const PairKey pair{view.part_a, view.part_b};
  if (view.inferred) {
    if (view.decided == kOpenLabel) unseen.insert(pair);
    return;
  }
  unseen.erase(pair);
  if (view.evidence != nullptr && view.decided >= 0) {
    hidden.Seat(pair, Classes(pair)[view.decided], view.evidence->X_AB);
  }
}

void AssemblyReasoner::Impl::ExchangeIdentities(const PartPoses& poses) {
  for (size_t i = 0; i < poses.parts.size(); ++i) {
    const int j = poses.parts[i].identity_exchange;
    const int k = static_cast<int>(i);
    if (j <= k || j >= static_cast<int>(poses.parts.size()) || task.parts[j].type != task.parts[k].type) continue;
    model->Exchange(k, j);
    belief.Exchange(k, j);
    hidden.Exchange(k, j);
    unseen.clear();
    const auto other = [&](int p) { return p == k ? j : p == j ? k : p; };
    for (BelievedJoint& joint : joints) {
      const PairKey pair = std::minmax(other(joint.part_a), other(joint.part_b));
      joint.part_a = pair.first;
      joint.part_b = pair.second;
    }
    for (int& part : placement.part_in_slot) part = other(part);
    pending.clear();
  }
}

std::map<PairKey, int> AssemblyReasoner::Impl::Implied() const {
  std::map<PairKey, int> out;
  if (options.paper) return out;
  for (const int c : ImpliedConnections(task, placement)) {
    const PairKey pair = std::minmax(placement.part_in_slot[task.connections[c].slot_a],
                                     placement.part_in_slot[task.connections[c].slot_b]);
    const auto& classes = Classes(pair);
    for (size_t i = 0; i < classes.size(); ++i) {
      const auto& list = classes[i].connections;
      if (std::find(list.begin(), list.end(), c) != list.end()) out[pair] = static_cast<int>(i);
    }
  }
  return out;
}

double AssemblyReasoner::Impl::HoldFor(const PairKey& pair, int label) const {
  if (options.paper) return 0;
  if (label == kOpenLabel) return options.undo_hold;
  if (label == kUnknownLabel || Classes(pair)[label].connections.empty()) return options.wrong_hold;
  return options.decide_hold;
}

/// Two parts that other joints hold together do not need a contact of their own.
bool AssemblyReasoner::Impl::Explained(const PairKey& pair) const {
  std::vector<int> group(task.parts.size());
  for (size_t i = 0; i < group.size(); ++i) group[i] = static_cast<int>(i);
  for (const BelievedJoint& j : joints) {
    if (PairKey{j.part_a, j.part_b} == pair) continue;
    const int from = group[j.part_a], to = group[j.part_b];
    std::replace(group.begin(), group.end(), from, to);
  }
  return group[pair.first] == group[pair.second];
}

void AssemblyReasoner::Impl::DecideAll(int64_t now, std::vector<ConnectionEvent>& events) {
  const std::map<PairKey, int> implied = Implied();
  belief.Infer(implied);
  const double threshold = options.paper ? 0.5 : options.decide_probability;
  std::vector<PairKey> keys;
  for (const auto& [pair, state] : belief.pairs()) {
    if (state.last_evidence == now || implied.contains(pair)) keys.push_back(pair);
  }
  for (const PairKey& pair : keys) {
    const int decided = belief.pairs().at(pair).decided;
    const int best = belief.Best(pair);
    const auto pin = pinned.find(pair);
    if (pin != pinned.end()) {
      if (pin->second == best) pinned.erase(pin);
      continue;
    }
    const bool wanted =
        best != decided && belief.Probability(pair, best) >= threshold && !(best == kUnknownLabel && Explained(pair));
    if (!wanted) {
      pending.erase(pair);
      continue;
    }
    const auto [entry, is_new] = pending.try_emplace(pair, Pending{best, now, now});
    if (entry->second.label != best || now - entry->second.last > kLongestGap) entry->second = {best, now, now};
    entry->second.last = now;
    if (static_cast<double>(now - entry->second.start) * 1e-6 < HoldFor(pair, best)) continue;
    pending.erase(pair);
    Change(pair, best, model->ChangeTime(pair.first, pair.second, best, decided, now), now, events);
  }
}

/// The pair's label becomes `label`: what was ends, what is new begins.
void AssemblyReasoner::Impl::Change(const PairKey& pair, int label, int64_t since, int64_t now,
                                    std::vector<ConnectionEvent>& events) {
  const auto old = Find(pair);
  if (old != joints.end()) {
    events.push_back(EventOf(*old, "disconnect", std::max(since, old->since), now));
    joints.erase(old);
    hidden.Unseat(pair);
  }
  belief.Decide(pair, label);
  if (label != kOpenLabel) joints.push_back({pair.first, pair.second, label, -1, -1, since, now, false});
  PlaceAgain(now, events);
}

/// Works out anew which joint stands where, and tells of joints that became right or wrong by it.
void AssemblyReasoner::Impl::PlaceAgain(int64_t now, std::vector<ConnectionEvent>& events) {
  std::vector<MadeJoint> made;
  std::vector<int> previous;
  for (const BelievedJoint& j : joints) {
    const bool known = j.label >= 0;
    made.push_back(
        {j.part_a, j.part_b, known ? Classes({j.part_a, j.part_b})[j.label].connections : std::vector<int>{}});
    previous.push_back(j.connection);
  }
  placement = Place(task, made, previous, placement.variant);
  for (size_t i = 0; i < joints.size(); ++i) {
    BelievedJoint& j = joints[i];
    const bool is_new = !j.announced;
    j.announced = true;
    const bool was_right = j.connection >= 0;
    const BelievedJoint before = j;
    j.connection = placement.connection_of[i];
    j.mistake = -1;
    if (j.connection < 0 && j.label >= 0) {
      const auto& mistakes = Classes({j.part_a, j.part_b})[j.label].mistakes;
      if (!mistakes.empty()) j.mistake = mistakes[0];
    }
    const bool is_right = j.connection >= 0;
    if (!is_new && was_right == is_right) continue;
    if (!is_new) {
      events.push_back(EventOf(before, "disconnect", now, now));
      j.since = j.decided = now;
    }
    events.push_back(EventOf(j, is_right ? "connect" : "wrong", j.since, now));
  }
}

std::string AssemblyReasoner::Impl::NameOf(const BelievedJoint& joint) const {
  if (joint.connection >= 0) return task.connections[joint.connection].name;
  return joint.mistake >= 0 ? task.mistakes[joint.mistake].name : "unknown";
}

ConnectionEvent AssemblyReasoner::Impl::EventOf(const BelievedJoint& joint, const char* type, int64_t since,
                                                int64_t now) const {
  const double p = belief.Probability({joint.part_a, joint.part_b}, joint.label);
  const bool ends = std::string(type) == "disconnect";
  return {since, now, type, NameOf(joint), joint.part_a, joint.part_b, ends ? 1 - p : p};
}

AssemblyState AssemblyReasoner::Impl::State(int64_t utime) const {
  AssemblyState state;
  state.utime = utime;
  state.task = task.name;
  if (!task.variants.empty()) {
    for (const int c : task.variants[placement.variant]) {
      ConnectionState s;
      s.connection = c;
      const Connection& connection = task.connections[c];
      s.part_a = placement.part_in_slot[connection.slot_a];
      s.part_b = placement.part_in_slot[connection.slot_b];
      for (const BelievedJoint& j : joints) {
        if (j.connection != c) continue;
        s.since = j.since;
        s.decided = j.decided;
        s.probability = belief.Probability({j.part_a, j.part_b}, j.label);
        s.state = ConnectionState::State::kMade;
        ++state.made;
      }
      ++state.required;
      state.connections.push_back(s);
    }
    state.step = NextConnection(task, placement, {});
  }
  for (const BelievedJoint& j : joints) {
    if (j.connection >= 0) continue;
    ConnectionState s;
    s.connection = j.mistake >= 0 ? -1 - j.mistake : kUnknownContact;
    s.part_a = j.part_a;
    s.part_b = j.part_b;
    s.probability = belief.Probability({j.part_a, j.part_b}, j.label);
    s.state = ConnectionState::State::kMade;
    s.since = j.since;
    s.decided = j.decided;
    state.connections.push_back(s);
  }
  return state;
}

ConnectionBelief AssemblyReasoner::Impl::Belief(int64_t utime) const {
  ConnectionBelief out;
  out.utime = utime;
  for (const auto& [pair, state] : belief.pairs()) {
    if (unseen.contains(pair)) continue;
    const auto& classes = Classes(pair);
    for (size_t k = 0; k < classes.size(); ++k) {
      const double p = belief.Probability(pair, static_cast<int>(k));
      if (p < kReportedBelief) continue;
      const ContactClass& contact = classes[k];
      const bool is_connection = !contact.connections.empty();
      const int type_a = task.parts[pair.first].type;
      const int index = is_connection ? contact.connections[0] : contact.mistakes[0];
      const bool in_order = is_connection ? FirstIsSlotA(task, index, type_a) : task.mistakes[index].type_a == type_a;
      out.connections.push_back({is_connection ? index : -1 - index, in_order ? pair.first : pair.second,
                                 in_order ? pair.second : pair.first, p});
    }
  }
  return out;
}

AssemblyReasoner::AssemblyReasoner(Task task, const AssemblyReasonerOptions& options)
    : impl_(std::make_unique<Impl>(std::move(task), options)) {}
AssemblyReasoner::~AssemblyReasoner() = default;

ReasonerOutput AssemblyReasoner::Step(const PartPoses& poses) {
  ReasonerOutput out;
  out.refused = Refusal(poses, impl_->task.parts.size(), impl_->last_utime);
  out.accepted = out.refused.empty();
  const int64_t now = out.accepted ? poses.utime : impl_->last_utime;
  if (out.accepted) {
    impl_->last_utime = now;
    impl_->ExchangeIdentities(poses);
    impl_->Observe(poses);
    impl_->DecideAll(now, out.events);
  }
  out.state = impl_->State(now);
  out.belief = impl_->Belief(now);
  return out;
}

std::vector<ConnectionEvent> AssemblyReasoner::Override(int connection, bool made, int64_t utime) {
  std::vector<ConnectionEvent> events;
  Impl& r = *impl_;
  const auto joint = std::find_if(r.joints.begin(), r.joints.end(),
                                  [&](const BelievedJoint& j) { return j.connection == connection; });
  if (made == (joint != r.joints.end())) return events;
  if (!made) {
    const PairKey pair{joint->part_a, joint->part_b};
    r.pinned[pair] = kOpenLabel;
    r.Change(pair, kOpenLabel, utime, utime, events);
    return events;
  }
  const auto [a, b] = PartsFor(r.task, r.placement, connection, {});
  if (a < 0 || b < 0) return events;
  const PairKey pair = std::minmax(a, b);
  const auto& classes = r.Classes(pair);
  for (size_t k = 0; k < classes.size(); ++k) {
    const auto& list = classes[k].connections;
    if (std::find(list.begin(), list.end(), connection) == list.end()) continue;
    std::vector<bool> is_connection;
    for (const ContactClass& c : classes) is_connection.push_back(!c.connections.empty());
    r.belief.Observe(pair, {}, is_connection, utime);
    r.pinned[pair] = static_cast<int>(k);
    r.Change(pair, static_cast<int>(k), utime, utime, events);
  }
  return events;
}

const Task& AssemblyReasoner::task() const { return impl_->task; }
const std::vector<BelievedJoint>& AssemblyReasoner::joints() const { return impl_->joints; }
const Placement& AssemblyReasoner::placement() const { return impl_->placement; }

double AssemblyReasoner::Probability(int connection, int part_a, int part_b) const {
  if (part_a < 0 || part_b < 0) return 0;
  const PairKey pair = std::minmax(part_a, part_b);
  const auto& classes = impl_->Classes(pair);
  for (size_t k = 0; k < classes.size(); ++k) {
    const auto& list = classes[k].connections;
    if (std::find(list.begin(), list.end(), connection) != list.end())
      return impl_->belief.Probability(pair, static_cast<int>(k));
  }
  return 0;
}

double AssemblyReasoner::ProbabilityOf(int part_a, int part_b, int label) const {
  return impl_->belief.Probability(std::minmax(part_a, part_b), label);
}

double AssemblyReasoner::BestRight(int part_a, int part_b, int label) const {
  const PairKey pair = std::minmax(part_a, part_b);
  const auto& classes = impl_->Classes(pair);
  double best = 0;
  for (size_t k = 0; k < classes.size(); ++k) {
    const int other = static_cast<int>(k);
    if (other != label && !classes[k].connections.empty())
      best = std::max(best, impl_->belief.Probability(pair, other));
  }
  return best;
}

bool AssemblyReasoner::IsSeen(const BelievedJoint& joint) const {
  return !impl_->unseen.contains({joint.part_a, joint.part_b});
}

bool AssemblyReasoner::IsTurned(const BelievedJoint& joint) const {
  if (joint.label < 0) return false;
  const auto& classes = impl_->Classes({joint.part_a, joint.part_b});
  const auto turn = [&](const ContactClass& right, const ContactTemplate& wrong) {
    // Turned about its long axis the part meets the other at the same place.
    const Vector3 p = right.templates[0].X_AB.translation(), q = wrong.X_AB.translation();
    const bool upside_down = right.templates[0].X_AB.linear().col(2).dot(wrong.X_AB.linear().col(2)) < -0.5;
    return upside_down && std::abs(p.x() - q.x()) < kSamePlace &&
           std::abs(std::abs(p.y()) - std::abs(q.y())) < kSamePlace &&
           std::abs(std::abs(p.z()) - std::abs(q.z())) < kSamePlace;
  };
  for (const ContactClass& right : classes) {
    if (right.connections.empty() || &right == &classes[joint.label]) continue;
    for (const ContactTemplate& wrong : classes[joint.label].templates) {
      if (turn(right, wrong)) return true;
    }
  }
  return false;
}

AssemblyMemory AssemblyReasoner::Save() const { return {impl_->joints, impl_->pinned, impl_->placement.variant}; }

void AssemblyReasoner::Restore(const AssemblyMemory& memory) {
  const int parts = static_cast<int>(impl_->task.parts.size());
  const auto fits = [&](const PairKey& pair, int label) {
    return pair.first >= 0 && pair.first < pair.second && pair.second < parts && label >= kUnknownLabel &&
           label < static_cast<int>(impl_->Classes(pair).size());
  };
  bool good = true;
  for (const BelievedJoint& j : memory.joints)
    good = good && j.label != kOpenLabel && fits({j.part_a, j.part_b}, j.label);
  for (const auto& [pair, label] : memory.pinned) good = good && fits(pair, label);
  if (!good) throw std::invalid_argument("the stored joints do not fit the task");
  impl_->joints.clear();
  impl_->placement = Place(impl_->task, {}, {}, memory.variant);
  std::vector<ConnectionEvent> ignored;
  for (const BelievedJoint& j : memory.joints) {
    std::vector<bool> is_connection;
    for (const ContactClass& c : impl_->Classes({j.part_a, j.part_b})) is_connection.push_back(!c.connections.empty());
    impl_->belief.Observe({j.part_a, j.part_b}, {}, is_connection, 0);
    impl_->belief.Decide({j.part_a, j.part_b}, j.label);
    impl_->joints.push_back(j);
    impl_->joints.back().announced = true;
  }
  impl_->pinned = memory.pinned;
  impl_->PlaceAgain(0, ignored);
}

}  // namespace coach
