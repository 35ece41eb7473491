#include "tools/simulator/enactment.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace coach {
namespace {

constexpr double kReachX = 0.34;               // m: parts lie within this of the middle
constexpr double kNearY = -0.2, kFarY = 0.17;  // m
constexpr double kApart = 0.025;               // m between parts

Spot Footprint(const Solids& solids, int thing, const Pose& X_W) {
  const MeshExtent& e = solids.extent(thing);
  const Vector3 c = X_W * e.centre;
  Vector3 half = 0.5 * (e.high - e.low);
  const Vector3 reach = X_W.linear().cwiseAbs() * half;
  return {{c.x(), c.y()}, std::min(0.5 * e.diameter, reach.head<2>().norm())};
}

Pose Resting(const Solids& solids, int thing, const Matrix3& R, double x, double y) {
  return MakePose(R, Vector3(x, y, -solids.Lowest(thing, R)));
}

/// The task's joints in the order of building: each adds one slot to those already there.
struct BuildStep {
  int slot = 0;       ///< new
  int base_slot = 0;  ///< placed before
};
std::vector<BuildStep> BuildOrder(const Task& task, int* first_slot) {
  std::vector<int> order = task.steps;
  for (const int c : OwnConnections(task)) {
    if (std::find(order.begin(), order.end(), c) == order.end()) order.push_back(c);
  }
  std::vector<BuildStep> steps;
  if (order.empty()) return steps;
  std::vector<bool> placed(task.slots.size(), false);
  *first_slot = task.connections[static_cast<size_t>(order[0])].slot_a;
  placed[static_cast<size_t>(*first_slot)] = true;
  for (size_t round = 0; round < task.slots.size(); ++round) {
    for (int c : order) {
      const Connection& joint = task.connections[static_cast<size_t>(c)];
      const bool a = placed[static_cast<size_t>(joint.slot_a)], b = placed[static_cast<size_t>(joint.slot_b)];
      if (a == b) continue;
      steps.push_back(a ? BuildStep{joint.slot_b, joint.slot_a} : BuildStep{joint.slot_a, joint.slot_b});
      placed[static_cast<size_t>(steps.back().slot)] = true;
    }
  }
  return steps;
}

}  // namespace

Pose StructurePlace(const Task& task, const Structure& structure, const Solids& solids, Random& random) {
  const Matrix3 R = Eigen::AngleAxisd(random.Uniform(-M_PI, M_PI), Vector3::UnitZ()).toRotationMatrix();
  Vector3 middle = Vector3::Zero();
  double low = 1e9;
  int count = 0;
  for (size_t slot = 0; slot < task.slots.size(); ++slot) {
    if (!structure.reached[slot] || structure.part[slot] < 0) continue;
    const Pose X = MakePose(R, Vector3::Zero()) * structure.X_slot[slot];
    middle += X.translation();
    low = std::min(low, X.translation().z() + solids.Lowest(structure.part[slot], X.linear()));
    ++count;
  }
  if (count == 0) return Pose::Identity();
  middle /= count;
  return MakePose(R, Vector3(random.Uniform(-0.04, 0.04) - middle.x(), random.Uniform(-0.04, 0.04) - middle.y(), -low));
}

std::vector<Pose> ScatterParts(const Task& task, const Solids& solids, const Structure& structure,
                               const Pose& X_W_structure, const std::vector<Spot>& avoid, double any_face,
                               Random& random) {
  const int n = static_cast<int>(task.parts.size());
  std::vector<Matrix3> lying(static_cast<size_t>(n), Matrix3::Identity());
  std::vector<Spot> taken = avoid;
  int first = 0;
  const bool builds = !BuildOrder(task, &first).empty();
  const int base = builds ? structure.part[static_cast<size_t>(first)] : -1;
  for (size_t slot = 0; slot < task.slots.size(); ++slot) {
    const int part = structure.part[slot];
    if (part < 0 || !structure.reached[slot]) continue;
    const Pose X = X_W_structure * structure.X_slot[slot];
    lying[static_cast<size_t>(part)] = X.linear();
    if (builds) taken.push_back(Footprint(solids, part, X));
  }
  std::vector<Pose> poses(static_cast<size_t>(n), Pose::Identity());
  for (int part = 0; part < n; ++part) {
    if (part == base) {
      poses[static_cast<size_t>(part)] = X_W_structure * structure.X_slot[static_cast<size_t>(first)];
      continue;
    }
    double reach = 1, apart = kApart;
    for (int attempt = 0;; ++attempt) {
      if (attempt % 200 == 199) reach = std::min(1.3, 1.1 * reach), apart *= 0.6;
      Matrix3 R = lying[static_cast<size_t>(part)];
      if (random.Chance(any_face)) {
        const auto rests = solids.Rests(part);
        R = rests[static_cast<size_t>(random.Pick(static_cast<int>(rests.size())))];
      }
      R = Eigen::AngleAxisd(random.Uniform(-M_PI, M_PI), Vector3::UnitZ()).toRotationMatrix() * R;
      const Pose X = Resting(solids, part, R, reach * random.Uniform(-kReachX, kReachX),
                             random.Uniform(reach * kNearY, reach * kFarY));
      const Spot c = Footprint(solids, part, X);
      const bool free = std::none_of(taken.begin(), taken.end(), [&](const Spot& t) {
        return (c.centre - t.centre).norm() < c.radius + t.radius + apart;
      });
      if (!free && attempt < 3000) continue;
      poses[static_cast<size_t>(part)] = X;
      taken.push_back(c);
      break;
    }
  }
  return poses;
}

struct Enactment::Impl {
  Impl(const Task& task, const Structure& structure, const Solids& solids, Child* child, Performance* performance,
       Random& random)
      : task_(task),
        structure_(structure),
        solids_(solids),
        child_(*child),
        performance_(*performance),
        random_(random),
        made_(task.connections.size(), false) {}

  void Play(const LessonPlan& plan) {
    int mistakes =
        static_cast<int>(plan.mistakes) + (random_.Chance(plan.mistakes - std::floor(plan.mistakes)) ? 1 : 0);
    const size_t away = steps_.size() > 1 ? static_cast<size_t>(random_.Pick(2)) : 0;
    for (size_t i = 0; i < steps_.size(); ++i) {
      const bool last = i + 1 == steps_.size();
      if (plan.out_of_view && i == away) LeaveAndReturn(Part(steps_.back().slot));
      if (plan.cover && i == (steps_.size() > 1 ? 1u : 0u)) CoverSomething();
      if (mistakes > 0 && (i + static_cast<size_t>(mistakes) >= steps_.size() || random_.Chance(0.5)) && Err()) {
        child_.Wait(random_.Uniform(2.2, 3.2));
        Undo();
        --mistakes;
      }
      if (plan.turn && last) TurnStructure();
      BuildOn(steps_[i], Part(steps_[i].slot), plan.near_miss && last);
    }
    child_.Wait(1.5);
  }

  void Build(int connection, bool near_miss) {
    if (mistake_) return;
    const BuildStep* chosen = nullptr;
    for (const BuildStep& step : steps_) {
      if (Placed(step.slot) || !Placed(step.base_slot)) continue;
      const Connection* asked = connection < 0 ? nullptr : &task_.connections[static_cast<size_t>(connection)];
      const bool fits = asked && ((asked->slot_a == step.slot && asked->slot_b == step.base_slot) ||
                                  (asked->slot_b == step.slot && asked->slot_a == step.base_slot));
      if (!chosen || fits) chosen = &step;
    }
    if (chosen) BuildOn(*chosen, Part(chosen->slot), near_miss);
  }

  bool complete() const { return !mistake_ && placed_.size() == steps_.size() + 1; }

  int Part(int slot) const { return structure_.part[static_cast<size_t>(slot)]; }
  Side HandFor(int thing) const { return child_.NearerHand(child_.PoseOf(thing).translation()); }

  void BuildOn(const BuildStep& step, int part, bool near_miss) {
    Child::Joint joint;
    joint.base = Part(step.base_slot);
    joint.part = part;
    joint.X_base_part = structure_.X_slot[static_cast<size_t>(step.base_slot)].inverse() *
                        structure_.X_slot[static_cast<size_t>(step.slot)];
    joint.steady = random_.Chance(0.6);
    joint.keep = true;
    placed_.push_back(step.slot);
    std::vector<int> closed;
    for (const int c : OwnConnections(task_)) {
      const Connection& connection = task_.connections[static_cast<size_t>(c)];
      if (!made_[static_cast<size_t>(c)] && Placed(connection.slot_a) && Placed(connection.slot_b)) closed.push_back(c);
    }
    if (near_miss && !closed.empty()) {
      joint.near_miss = random_.Uniform(0.010, 0.016);
      joint.near_miss_name = task_.connections[static_cast<size_t>(closed[0])].name;
    }
    MakeRoom(part, child_.PoseOf(joint.base) * joint.X_base_part);
    const Side hand = HandFor(part);
    const double time = child_.Join(hand, joint);
    for (int c : closed) {
      const Connection& connection = task_.connections[static_cast<size_t>(c)];
      made_[static_cast<size_t>(c)] = true;
      Declare(time, "connect", connection.name, Part(connection.slot_a), Part(connection.slot_b));
    }
    LetGo();
  }

  /// Lays aside what lies where a part is to go.
  void MakeRoom(int part, const Pose& X_W) {
    for (const int other : Others(part)) {
      if (!Lying(other) || !child_.Blocked(part, X_W, {other})) continue;
      const Side hand = HandFor(other);
      child_.Reach(hand, other);
      child_.Carry(hand, FreePlace(other, hand), 0.05);
      child_.Release(hand);
      child_.Wait(0.3);
    }
  }

  void Declare(double time, const std::string& kind, const std::string& connection, int a, int b) {
    performance_.events.push_back({.time = time, .kind = kind, .parts = {a, b}, .connection = connection});
  }

  void LetGo() {
    for (const Side hand : {Side::kLeft, Side::kRight}) {
      if (child_.HeldBy(hand) >= 0) {
        child_.Release(hand);
        child_.Wait(0.3);
      }
    }
    child_.Wait(random_.Uniform(0.2, 0.7));
  }

  bool Placed(int slot) const { return std::find(placed_.begin(), placed_.end(), slot) != placed_.end(); }
  bool Lying(int part) const {
    return std::none_of(placed_.begin(), placed_.end(), [&](int slot) { return Part(slot) == part; });
  }
  std::vector<int> Others(int part) const {
    std::vector<int> others;
    for (int i = 0; i < static_cast<int>(task_.parts.size()); ++i) {
      if (i != part) others.push_back(i);
    }
    return others;
  }

  void CoverSomething() {
    std::vector<int> lying;
    for (int i = 0; i < static_cast<int>(task_.parts.size()); ++i) {
      if (Lying(i)) lying.push_back(i);
    }
    if (lying.empty()) return;
    const int part = lying[static_cast<size_t>(random_.Pick(static_cast<int>(lying.size())))];
    child_.Cover(HandFor(part), part, random_.Uniform(1.8, 2.6));
  }

  void LeaveAndReturn(int part) {
    const Side hand = HandFor(part);
    child_.Reach(hand, part);
    Pose up = child_.PoseOf(part);
    up.translation() = Vector3(hand == Side::kLeft ? 0.12 : -0.12, 0.33, 0.48);
    child_.Carry(hand, up, 0);
    child_.Wait(random_.Uniform(0.8, 1.8));
    Pose lying = FreePlace(part, hand);
    child_.Carry(hand, lying, 0);
    child_.Release(hand);
    child_.Wait(0.5);
  }
  /// A place on the hand's side of the table, apart from everything and from what will be built. Lying as before.
  Pose FreePlace(int part, Side hand) const {
    for (int attempt = 0; attempt < 80; ++attempt) {
      const double x = (hand == Side::kLeft ? 1 : -1) * random_.Uniform(0.1, kReachX);
      const Matrix3 R =
          Eigen::AngleAxisd(random_.Uniform(-1, 1), Vector3::UnitZ()).toRotationMatrix() * child_.PoseOf(part).linear();
      const Pose X = Resting(solids_, part, R, x, random_.Uniform(kNearY, kFarY));
      if (IsApart(part, X) && !IsInStructure(part, X)) return X;
    }
    return Resting(solids_, part, child_.PoseOf(part).linear(), hand == Side::kLeft ? 0.3 : -0.3, -0.2);
  }
  bool IsApart(int part, const Pose& X) const {
    const Spot c = Footprint(solids_, part, X);
    const auto others = Others(part);
    return std::all_of(others.begin(), others.end(), [&](int other) {
      const Spot o = Footprint(solids_, other, child_.PoseOf(other));
      return (c.centre - o.centre).norm() > c.radius + o.radius + 0.01;
    });
  }
  /// True if a part is in the way of the finished structure.
  bool IsInStructure(int part, const Pose& X) const {
    const Pose X_W = child_.PoseOf(Part(first_slot_)) * structure_.X_slot[static_cast<size_t>(first_slot_)].inverse();
    return std::any_of(steps_.begin(), steps_.end(), [&](const BuildStep& step) {
      return solids_.Overlap(part, X, Part(step.slot), X_W * structure_.X_slot[static_cast<size_t>(step.slot)]);
    });
  }

  bool Err() {
    if (mistake_) return false;
    struct Option {
      int mistake, base, part;
      Pose X_base_part;
    };
    std::vector<Option> options;
    for (int part = 0; part < static_cast<int>(task_.parts.size()); ++part) {
      if (!Lying(part)) continue;
      for (int slot : placed_) {
        const int base = Part(slot);
        for (int m = 0; m < static_cast<int>(task_.mistakes.size()); ++m) {
          const Mistake& mistake = task_.mistakes[static_cast<size_t>(m)];
          if (placed_.size() < 2 && StartsVariant(m)) continue;
          const int tb = task_.parts[static_cast<size_t>(base)].type, tp = task_.parts[static_cast<size_t>(part)].type;
          if (mistake.type_a == tb && mistake.type_b == tp) options.push_back({m, base, part, mistake.X_AB});
          if (mistake.type_a == tp && mistake.type_b == tb) options.push_back({m, base, part, mistake.X_AB.inverse()});
        }
      }
    }
    while (!options.empty()) {
      const size_t pick = static_cast<size_t>(random_.Pick(static_cast<int>(options.size())));
      const Option o = options[pick];
      options.erase(options.begin() + static_cast<long>(pick));
      const Pose X_W = child_.PoseOf(o.base) * o.X_base_part;
      const double low = X_W.translation().z() + solids_.Lowest(o.part, X_W.linear());
      if (low < -0.001 || low > 0.05 || child_.Blocked(o.part, X_W)) continue;
      const Pose back = child_.PoseOf(o.part);
      const std::string& name = task_.mistakes[static_cast<size_t>(o.mistake)].name;
      const Side hand = HandFor(o.part);
      Child::Joint joint{.base = o.base, .part = o.part, .X_base_part = o.X_base_part, .keep = true};
      const double time = child_.Join(hand, joint);
      Declare(time, "wrong_connect", name, o.base, o.part);
      LetGo();
      mistake_ = OpenMistake{o.base, o.part, name, back};
      return true;
    }
    return false;
  }

  /// The first joint of a variant is no mistake as long as no other joint is made.
  bool StartsVariant(int mistake) const {
    const std::string& own_class = classes_[task_.connections.size() + static_cast<size_t>(mistake)];
    return std::find(classes_.begin(), classes_.begin() + static_cast<long>(task_.connections.size()), own_class) !=
           classes_.begin() + static_cast<long>(task_.connections.size());
  }

  void Undo() {
    if (!mistake_) return;
    const OpenMistake m = *mistake_;
    mistake_.reset();
    child_.TakeOff(HandFor(m.part), m.part, m.name, m.base, m.back);
  }

  void TurnStructure() {
    const int base = Part(placed_[0]);
    const Side hand = HandFor(base);
    const Pose X = child_.PoseOf(base);
    for (int attempt = 0; attempt < 12; ++attempt) {
      const double yaw = random_.Uniform(0.2, 0.5) * (random_.Chance(0.5) ? 1 : -1);
      Pose Y = X;
      Y.linear() = Eigen::AngleAxisd(yaw, Vector3::UnitZ()).toRotationMatrix() * X.linear();
      Y.translation() += Vector3(random_.Uniform(-0.03, 0.03), random_.Uniform(-0.03, 0.03), 0);
      bool free = true;
      for (int member : child_.GroupMembers(base)) {
        const Pose X_member = Y * X.inverse() * child_.PoseOf(member);
        std::vector<int> others;
        for (int i = 0; i < static_cast<int>(task_.parts.size()); ++i) {
          if (!child_.Together(i, base)) others.push_back(i);
        }
        free = free && !child_.Blocked(member, X_member, others);
      }
      if (!free) continue;
      child_.Reach(hand, base);
      child_.Carry(hand, Y, 0.03);
      child_.Release(hand);
      child_.Wait(0.3);
      return;
    }
  }

  const Task& task_;
  const Structure& structure_;
  const Solids& solids_;
  Child& child_;
  Performance& performance_;
  Random& random_;
  struct OpenMistake {
    int base, part;
    std::string name;
    Pose back;  // where the part came from
  };
  int first_slot_ = 0;
  const std::vector<BuildStep> steps_ = BuildOrder(task_, &first_slot_);
  std::vector<int> placed_{first_slot_};  // slots
  std::optional<OpenMistake> mistake_;
  std::vector<bool> made_;
  const std::vector<std::string> classes_ = JointClasses(task_);  // of connections, then mistakes
};

Enactment::Enactment(const Task& task, const Structure& structure, const Solids& solids, Child* child,
                     Performance* performance, Random* random)
    : impl_(std::make_unique<Impl>(task, structure, solids, child, performance, *random)) {}
Enactment::~Enactment() = default;

void Enactment::Play(const LessonPlan& plan) { impl_->Play(plan); }
void Enactment::Build(int connection, bool near_miss) { impl_->Build(connection, near_miss); }
bool Enactment::Err() { return impl_->Err(); }
void Enactment::Undo() { impl_->Undo(); }
bool Enactment::mistaken() const { return impl_->mistake_.has_value(); }
bool Enactment::complete() const { return impl_->complete(); }

}  // namespace coach
