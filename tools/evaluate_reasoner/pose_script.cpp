#include "tools/evaluate_reasoner/pose_script.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "services/assembly_reasoner/contact_classes.h"
#include "services/assembly_reasoner/hidden_parts.h"

namespace coach {
namespace {

constexpr double kAnglePerLength = 0.6 * std::numbers::pi / 180 / 0.001;  // rad/m
constexpr double kPairDistance = 0.03;                                    // m, surfaces nearer than this are a pair
constexpr int kSurfacePoints = 48;

double Smooth(double s) { return s * s * s * (10 + s * (6 * s - 15)); }  // minimum jerk

Pose Interpolate(const Pose& from, const Pose& to, double s) {
  const Vector6 xi = Difference(from, to);
  return Perturb(from, s * xi);
}

Vector3 RandomVector(std::mt19937_64& random, double deviation) {
  std::normal_distribution<double> normal(0, deviation);
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

double Uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// The errors of one part over time.
class PartErrors {
 public:
  PartErrors(const TrackerErrors& errors, const SymmetryGroup& symmetries, std::mt19937_64& random) : errors_(errors) {
    bias_.head<3>() = Uniform(random, 0, errors.bias) * RandomVector(random, 1).normalized();
    bias_.tail<3>() = Uniform(random, 0, errors.bias) * kAnglePerLength * RandomVector(random, 1).normalized();
    std::uniform_int_distribution<size_t> pick(0, symmetries.discrete.size() - 1);
    flip_.linear() = symmetries.discrete[pick(random)];
    noise_ = Fresh(random);
  }
  Pose Measure(const Pose& X_TP, double dt, std::mt19937_64& random) {
    const double keep = std::exp(-dt / errors_.correlation_time);
    noise_ = keep * noise_ + std::sqrt(1 - keep * keep) * Fresh(random);
    if (frozen_for_ > 0) {
      frozen_for_ -= dt;
      return last_;
    }
    if (Uniform(random, 0, 1) < errors_.freezes * dt) frozen_for_ = Uniform(random, 0.2, 0.5);
    if (jump_frames_ == 0 && Uniform(random, 0, 1) < errors_.jumps * dt) {
      jump_frames_ = static_cast<int>(Uniform(random, 1, 5));
      jump_ = Uniform(random, 0.015, 0.04) * RandomVector(random, 1).normalized();
    }
    Vector6 xi = noise_ + bias_;
    if (jump_frames_ > 0) {
      xi.head<3>() += jump_;
      --jump_frames_;
    }
    return last_ = Perturb(X_TP, xi) * flip_;
  }
  Matrix6 Covariance() const {
    Vector6 d;
    const double p = std::max(errors_.position, 0.0005);
    d << Vector3::Constant(p * p), Vector3::Constant(std::pow(p * kAnglePerLength, 2));
    return errors_.covariance_scale * Matrix6(d.asDiagonal());
  }

 private:
  Vector6 Fresh(std::mt19937_64& random) const {
    Vector6 xi;
    xi.head<3>() = RandomVector(random, errors_.position);
    xi.tail<3>() = RandomVector(random, errors_.position * kAnglePerLength);
    return xi;
  }
  TrackerErrors errors_;
  Vector6 bias_, noise_;
  Pose flip_ = Pose::Identity(), last_ = Pose::Identity();
  double frozen_for_ = 0;
  int jump_frames_ = 0;
  Vector3 jump_ = Vector3::Zero();
};

class Stage {
 public:
  Stage(const Task& task, const TrackerErrors& errors, double fps, uint64_t seed)
      : task_(task), contacts_(task), dt_(1 / fps), random_(seed) {
    const int n = static_cast<int>(task.parts.size());
    for (int p = 0; p < n; ++p) {
      home_.push_back(Rest(p));
      X_.push_back(home_.back());
      errors_.emplace_back(errors, task.TypeOf(p).symmetries, random_);
      visible_.push_back(1);
      held_.push_back(Pose::Identity());
    }
    for (const PartType& type : task.types) {
      surface_.push_back(SampleSurface(type.mesh, kSurfacePoints));
      radius_.push_back(Extent(type.mesh).diameter / 2 + Extent(type.mesh).centre.norm());
    }
    group_.resize(n);
    std::iota(group_.begin(), group_.end(), 0);
    Wait(1.0);
  }

  void Play(const ScriptAction& action) {
    Wait(action.pause);
    switch (action.kind) {
      case ScriptAction::Kind::kConnect:
        return Join(action, false);
      case ScriptAction::Kind::kMistake:
      case ScriptAction::Kind::kUnknown:
        return Join(action, true);
      case ScriptAction::Kind::kUndo:
        return Part(action);
      case ScriptAction::Kind::kNearMiss:
        return Miss(action);
    }
  }
  void Wait(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / dt_); ++i) Emit(-1);
  }
  ScriptedLesson Finish() {
    Wait(2.0);
    for (TrueEvent& e : lesson_.events) e.due = Due(e);
    return std::move(lesson_);
  }

 private:
  Pose Rest(int p) {
    const double turn = Uniform(random_, -3.1, 3.1);
    Pose X = Pose::Identity();
    X.linear() = ExpRotation({0, 0, turn});
    X.translation() = Vector3(0.26 * (p % 3) - 0.26, 0.26 * (p / 3), 0.015);
    return X;
  }
  std::vector<int> Members(int part) const {
    std::vector<int> out;
    for (size_t p = 0; p < group_.size(); ++p) {
      if (group_[p] == group_[part]) out.push_back(static_cast<int>(p));
    }
    return out;
  }
  /// Moves a group rigidly so that `part` goes to X in `seconds`, smoothly.
  void Move(const std::vector<int>& members, int part, const Pose& X, double seconds) {
    const Pose from = X_[part];
    std::vector<Pose> relative;
    for (const int m : members) relative.push_back(from.inverse() * X_[m]);
    const int frames = std::max(1, static_cast<int>(std::lround(seconds / dt_)));
    for (int f = 1; f <= frames; ++f) {
      const Pose at = Interpolate(from, X, Smooth(static_cast<double>(f) / frames));
      for (size_t i = 0; i < members.size(); ++i) X_[members[i]] = at * relative[i];
      Emit(part);
    }
  }
  /// Which of the two moves (the smaller group), where to, along which way.
  struct Plan {
    int mover, other;
    Pose X_goal, X_before;
  };
  Plan PlanJoin(const ScriptAction& action, const Pose& X_AB) {
    const bool a_moves = Members(action.part_a).size() < Members(action.part_b).size();
    Plan plan;
    plan.mover = a_moves ? action.part_a : action.part_b;
    plan.other = a_moves ? action.part_b : action.part_a;
    plan.X_goal = X_[plan.other] * (a_moves ? X_AB.inverse() : X_AB);
    Vector3 away = plan.X_goal.translation() - X_[plan.other].translation();
    away.z() = 0;
    away = away.norm() > 1e-3 ? away.normalized() : Vector3::UnitX();
    plan.X_before = plan.X_goal;
    plan.X_before.translation() += 0.06 * away + Vector3(0, 0, 0.02);
    plan.X_before.linear() = ExpRotation({0, 0, Uniform(random_, -0.25, 0.25)}) * plan.X_goal.linear();
    return plan;
  }
  /// B flat on the table beside A, touching it, as in no class.
  Pose Touching(int a, int b) {
    const int type_a = task_.parts[a].type, type_b = task_.parts[b].type;
    while (true) {
      Pose X_AB = Pose::Identity();
      X_AB.linear() = ExpRotation({0, 0, Uniform(random_, -3.14, 3.14)});
      const double angle = Uniform(random_, -3.14, 3.14);
      for (double r = 0.25; r > 0 && Gap(type_a, type_b, X_AB) > 5e-4; r -= 0.001)
        X_AB.translation() = Vector3(r * std::cos(angle), r * std::sin(angle), 0);
      const auto& classes = contacts_.Classes(type_a, type_b);
      const bool known = std::any_of(classes.begin(), classes.end(), [&](const ContactClass& c) {
        const ContactError error = NearestContact(c, X_AB);
        return error.xi.head<3>().norm() < 0.02 && error.xi.tail<3>().norm() < 0.35;
      });
      if (!known) return X_AB;
    }
  }
  Pose Desired(const ScriptAction& action) {
    if (action.kind == ScriptAction::Kind::kUnknown) return Touching(action.part_a, action.part_b);
    if (action.kind == ScriptAction::Kind::kMistake) return task_.mistakes[action.index].X_AB;
    const Connection& c = task_.connections[action.index];
    std::vector<double> q;
    for (const JointFreedom& f : c.freedom) q.push_back(Uniform(random_, f.low, f.high));
    return MoveJoint({c.X_AB, c.freedom}, q);
  }

  void Join(const ScriptAction& action, bool wrong) {
    if (group_[action.part_a] == group_[action.part_b]) return;  // closed by itself
    const Plan plan = PlanJoin(action, Desired(action));
    Move(Members(plan.mover), plan.mover, plan.X_before, Uniform(random_, 0.9, 1.5));
    const double slide = Uniform(random_, 0.35, 0.7);
    if (action.hidden) hidden_ = {plan.mover, plan.other};
    Move(Members(plan.mover), plan.mover, plan.X_goal, slide);
    const int from = group_[plan.mover];
    std::replace(group_.begin(), group_.end(), from, group_[plan.other]);
    TellNewJoints(wrong);
    if (action.kind == ScriptAction::Kind::kUnknown) {
      const auto [a, b] = std::minmax(action.part_a, action.part_b);
      joints_.push_back({now_, now_, "wrong", {"unknown"}, a, b});
      lesson_.events.push_back(joints_.back());
    }
    if (action.hidden) Wait(0.5);
    hidden_ = {-1, -1};
    Wait(Uniform(random_, 0.3, 0.8));
    if (action.carried) {
      Pose X = X_[plan.mover];
      const double far = action.kind == ScriptAction::Kind::kUnknown ? 0.06 : 0;
      X.translation() += Vector3(Uniform(random_, -0.05, 0.05), far + Uniform(random_, 0.03, 0.06), 0.03);
      X.linear() = ExpRotation({0, 0, Uniform(random_, -0.4, 0.4)}) * X.linear();
      const Pose back = X_[plan.mover];
      Move(Members(plan.mover), plan.mover, X, 0.8);
      Move(Members(plan.mover), plan.mover, back, 0.8);
    }
    Wait(Uniform(random_, 1.0, 2.5));
  }
  /// Every pair of the grown group that now stands at the pose of a class.
  void TellNewJoints(bool wrong) {
    const int n = static_cast<int>(task_.parts.size());
    for (int a = 0; a < n; ++a) {
      for (int b = a + 1; b < n; ++b) {
        const bool known = std::any_of(joints_.begin(), joints_.end(),
                                       [&](const TrueEvent& j) { return j.part_a == a && j.part_b == b; });
        if (known || group_[a] != group_[b]) continue;
        for (const ContactClass& c : contacts_.Classes(task_.parts[a].type, task_.parts[b].type)) {
          if (NearestContact(c, X_[a].inverse() * X_[b]).distance > 0.3) continue;
          TrueEvent e{now_, now_, wrong ? "wrong" : "connect", {}, a, b};
          for (const int i : c.connections) e.names.push_back(task_.connections[i].name);
          if (wrong) e.names.clear();
          for (const int i : c.mistakes) e.names.push_back(task_.mistakes[i].name);
          if (wrong && c.mistakes.empty()) e.names.push_back("unknown");
          joints_.push_back(e);
          lesson_.events.push_back(e);
        }
      }
    }
  }
  /// part_b (a leaf: nothing else hangs on it) is pulled off and put back to its place.
  void Part(const ScriptAction& action) {
    for (TrueEvent e : joints_) {
      if (e.part_a != action.part_b && e.part_b != action.part_b) continue;
      e.type = "disconnect";
      e.moment = e.due = now_;
      lesson_.events.push_back(e);
    }
    std::erase_if(joints_, [&](const TrueEvent& e) { return e.part_a == action.part_b || e.part_b == action.part_b; });
    group_[action.part_b] = static_cast<int>(group_.size()) + fresh_group_++;
    Vector3 away = X_[action.part_b].translation() - X_[action.part_a].translation();
    away.z() = 0.01;
    Pose X = X_[action.part_b];
    X.translation() += 0.07 * away.normalized();
    Move({action.part_b}, action.part_b, X, 0.5);
    Move({action.part_b}, action.part_b, home_[action.part_b], 1.0);
    Wait(Uniform(random_, 0.5, 1.0));
  }
  void Miss(const ScriptAction& action) {
    if (group_[action.part_a] == group_[action.part_b]) return;
    const Plan plan = PlanJoin(action, Desired(action));
    Pose X = plan.X_goal;
    const double angle = Uniform(random_, -3.14, 3.14);
    const Vector3 outward = (plan.X_before.translation() - plan.X_goal.translation()).normalized();
    Vector3 direction(std::cos(angle), std::sin(angle), 0);
    if (direction.dot(outward) < 0) direction = -direction;
    X.translation() += action.gap * direction;
    X.linear() = ExpRotation({0, 0, Uniform(random_, -0.05, 0.05)}) * X.linear();
    Move(Members(plan.mover), plan.mover, plan.X_before, Uniform(random_, 0.9, 1.5));
    Move(Members(plan.mover), plan.mover, X, Uniform(random_, 0.35, 0.7));
    Wait(Uniform(random_, 1.2, 2.5));
    ++lesson_.near_misses;
    Move(Members(plan.mover), plan.mover, plan.X_before, 0.5);
    Wait(0.3);
  }

  void Emit(int moving) {
    PartPoses out;
    now_ += static_cast<int64_t>(dt_ * 1e6);
    out.utime = now_;
    out.sequence = static_cast<int64_t>(lesson_.frames.size());
    out.table_found = true;
    const int n = static_cast<int>(task_.parts.size());
    std::vector<Pose> measured;
    for (int p = 0; p < n; ++p) {
      const bool covered = p == hidden_[0] || p == hidden_[1];
      const double goal = covered ? 0.0 : moving >= 0 && group_[p] == group_[moving] ? 0.55 : 0.95;
      visible_[p] += std::clamp(goal - visible_[p], -4 * dt_, 4 * dt_);
      if (covered) visible_[p] = std::min(visible_[p], 0.03);
      PartEstimate part;
      const Pose seen = errors_[p].Measure(X_[p], dt_, random_);
      if (visible_[p] >= 0.05) held_[p] = seen;
      part.X_TP = held_[p];
      part.covariance = errors_[p].Covariance();
      if (!truth_.empty()) part.velocity = Difference(truth_.back()[p], X_[p]) / dt_;
      part.visible_fraction = visible_[p];
      part.status = visible_[p] >= 0.05 ? PartStatus::kTracked : PartStatus::kOccluded;
      part.confidence = visible_[p];
      out.parts.push_back(part);
    }
    if (moving >= 0) out.foreign.push_back({X_[moving].translation() + Vector3(0, 0, 0.05), 0.06, Vector3(0.1, 0, 0)});
    truth_.push_back(X_);
    for (int a = 0; a < n; ++a) {
      for (int b = a + 1; b < n; ++b) AddPair(a, b, out);
    }
    lesson_.frames.push_back(std::move(out));
  }
  double Gap(int ta, int tb, const Pose& X_AB) const {
    if (X_AB.translation().norm() > radius_[ta] + radius_[tb] + kPairDistance) return 1;
    double best = 1;
    for (const SurfacePoint& q : surface_[tb]) {
      const Vector3 p_A = X_AB * q.p;
      for (const SurfacePoint& p : surface_[ta]) best = std::min(best, (p.p - p_A).squaredNorm());
    }
    return std::max(0.0, std::sqrt(best) - 0.008);  // the points are about 15 mm apart
  }
  void AddPair(int a, int b, PartPoses& out) const {
    if (std::min(visible_[a], visible_[b]) < 0.05) return;
    PairEvidence pair;
    pair.surface_distance = Gap(task_.parts[a].type, task_.parts[b].type, X_[a].inverse() * X_[b]);
    if (pair.surface_distance > kPairDistance) return;
    pair.part_a = a;
    pair.part_b = b;
    pair.X_AB = out.parts[a].X_TP.inverse() * out.parts[b].X_TP;
    pair.covariance =
        RelativeCovariance(out.parts[a].X_TP, out.parts[a].covariance, out.parts[b].X_TP, out.parts[b].covariance);
    const size_t half_second = static_cast<size_t>(0.5 / dt_);
    const std::vector<Pose>& then = truth_[truth_.size() > half_second ? truth_.size() - 1 - half_second : 0];
    const Vector6 moved = Difference(then[a], X_[a]);
    pair.motion = {moved.head<3>().norm(), moved.tail<3>().norm()};
    const Vector6 relative = Difference(then[a].inverse() * then[b], X_[a].inverse() * X_[b]);
    pair.relative_motion = {relative.head<3>().norm(), relative.tail<3>().norm()};
    pair.visible_fraction = {visible_[a], visible_[b]};
    pair.pixels = 400;
    out.pairs.push_back(pair);
  }
  int64_t Due(const TrueEvent& e) const {
    for (const PartPoses& f : lesson_.frames) {
      if (f.utime >= e.moment && f.parts[e.part_a].visible_fraction >= 0.3 && f.parts[e.part_b].visible_fraction >= 0.3)
        return f.utime;
    }
    return e.moment;
  }

  const Task& task_;
  ContactTable contacts_;
  double dt_;
  std::mt19937_64 random_;
  std::vector<Pose> home_, X_, held_;
  std::vector<PartErrors> errors_;
  std::vector<double> visible_, radius_;
  std::vector<std::vector<SurfacePoint>> surface_;
  std::vector<int> group_;
  std::array<int, 2> hidden_{-1, -1};
  std::vector<TrueEvent> joints_;
  std::vector<std::vector<Pose>> truth_;
  int fresh_group_ = 0;
  int64_t now_ = 1000000;
  ScriptedLesson lesson_;
};

/// Parts with no joint yet, of a type.
int FreePart(const Task& task, int type, const std::vector<bool>& used, int other, std::mt19937_64& random) {
  std::vector<int> free;
  for (size_t p = 0; p < task.parts.size(); ++p) {
    if (task.parts[p].type == type && !used[p] && static_cast<int>(p) != other) free.push_back(static_cast<int>(p));
  }
  if (free.empty()) return -1;
  return free[std::uniform_int_distribution<size_t>(0, free.size() - 1)(random)];
}

}  // namespace

ScriptedLesson PlayScript(const Task& task, const std::vector<ScriptAction>& actions, const TrackerErrors& errors,
                          double fps, uint64_t seed) {
  Stage stage(task, errors, fps, seed);
  for (const ScriptAction& action : actions) stage.Play(action);
  return stage.Finish();
}

std::vector<ScriptAction> PlainScript(const Task& task, const std::vector<int>& order,
                                      const std::vector<int>& part_in_slot) {
  std::vector<ScriptAction> out;
  for (const int c : order) {
    const Connection& connection = task.connections[c];
    out.push_back({ScriptAction::Kind::kConnect, c, part_in_slot[connection.slot_a], part_in_slot[connection.slot_b]});
  }
  return out;
}

int64_t CountPlainScripts(const Task& task) {
  int64_t count = 1;
  for (size_t i = 2; i <= task.variants.at(0).size(); ++i) count *= static_cast<int64_t>(i);
  for (size_t type = 0; type < task.types.size(); ++type) {
    const auto of_type = [&](const auto& x) { return x.type == static_cast<int>(type); };
    int64_t parts = std::count_if(task.parts.begin(), task.parts.end(), of_type);
    for (auto slots = std::count_if(task.slots.begin(), task.slots.end(), of_type); slots > 0; --slots)
      count *= parts--;
  }
  return count;
}

std::vector<ScriptAction> PlainScriptAt(const Task& task, int64_t index) {
  // Digits of a number with a base of its own each: which of those that are left comes next.
  const auto take = [&](std::vector<int>& left) {
    const auto size = static_cast<int64_t>(left.size());
    const auto at = left.begin() + static_cast<std::ptrdiff_t>(index % size);
    index /= size;
    const int taken = *at;
    left.erase(at);
    return taken;
  };
  std::vector<int> left = task.variants.at(0), order, part_in_slot;
  while (!left.empty()) order.push_back(take(left));
  std::vector<std::vector<int>> free(task.types.size());
  for (size_t p = 0; p < task.parts.size(); ++p) free[task.parts[p].type].push_back(static_cast<int>(p));
  for (const Slot& slot : task.slots) part_in_slot.push_back(take(free[slot.type]));
  return PlainScript(task, order, part_in_slot);
}

bool IsOnlyWrong(const Task& task, int mistake) {
  const auto [low, high] = std::minmax(task.mistakes[mistake].type_a, task.mistakes[mistake].type_b);
  const ContactTable contacts(task);
  const auto& classes = contacts.Classes(low, high);
  return std::any_of(classes.begin(), classes.end(), [&](const ContactClass& c) {
    return c.connections.empty() && std::find(c.mistakes.begin(), c.mistakes.end(), mistake) != c.mistakes.end();
  });
}

std::vector<ScriptAction> RandomScript(const Task& task, const ScriptOptions& options, std::mt19937_64& random) {
  const auto number = std::uniform_int_distribution<int64_t>(0, CountPlainScripts(task) - 1)(random);
  std::vector<ScriptAction> out;
  std::vector<bool> used(task.parts.size(), false);
  for (const ScriptAction& step : PlainScriptAt(task, number)) {
    if (!task.mistakes.empty() && Uniform(random, 0, 1) < options.mistakes) {
      const int m = std::uniform_int_distribution<int>(0, static_cast<int>(task.mistakes.size()) - 1)(random);
      const int a = IsOnlyWrong(task, m) ? FreePart(task, task.mistakes[m].type_a, used, -1, random) : -1;
      const int b = FreePart(task, task.mistakes[m].type_b, used, a, random);
      if (a >= 0 && b >= 0) {
        out.push_back({ScriptAction::Kind::kMistake, m, a, b});
        out.push_back({ScriptAction::Kind::kUndo, m, a, b});
      }
    }
    if (options.unknown > 0 && !used[step.part_b] && Uniform(random, 0, 1) < options.unknown) {
      ScriptAction unknown{ScriptAction::Kind::kUnknown, 0, step.part_a, step.part_b};
      unknown.carried = true;
      out.push_back(unknown);
      out.push_back({ScriptAction::Kind::kUndo, 0, step.part_a, step.part_b});
    }
    if (Uniform(random, 0, 1) < options.near_misses) {
      ScriptAction miss = step;
      miss.kind = ScriptAction::Kind::kNearMiss;
      miss.gap = Uniform(random, 0.005, 0.03);
      out.push_back(miss);
    }
    ScriptAction real = step;
    real.hidden = Uniform(random, 0, 1) < options.hidden;
    real.carried = Uniform(random, 0, 1) < 0.4;
    out.push_back(real);
    const bool leaf = !used[step.part_b];
    used[step.part_a] = used[step.part_b] = true;
    if (leaf && Uniform(random, 0, 1) < options.undone) {
      ScriptAction undo = step;
      undo.kind = ScriptAction::Kind::kUndo;
      out.push_back(undo);
      out.push_back(real);
    }
  }
  return out;
}

}  // namespace coach
