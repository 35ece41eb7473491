// A child at the table: what it can do, written into a Performance one act after the other.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/assembly/task.h"
#include "tools/simulator/performance.h"
#include "tools/simulator/random.h"
#include "tools/simulator/solids.h"

namespace coach {

struct ChildStyle {
  double speed = 0.35;       ///< m/s, average of a movement
  double pause = 0.5;        ///< s, between acts
  double hesitation = 0.15;  ///< chance to stop on the way and look
  double dock_time = 0.9;    ///< s, for the last centimetres of a connection
};

/// "slow", "normal", "hasty" or "hesitant". @throws std::invalid_argument for another name.
ChildStyle StyleByName(const std::string& name);

/// Acts are planned at now() and move it on. Things are the task's parts, then others.
class Child {
 public:
  Child(const Task& task, const Solids& solids, const ChildStyle& style, Performance* performance, Random* random);

  double now() const { return now_; }
  void set_now(double time) { now_ = time; }
  void Wait(double seconds) { now_ += seconds; }
  Pose PoseOf(int thing) const { return performance_->things.At(thing, now_); }
  bool Together(int a, int b) const { return Group(a) == Group(b); }
  int HeldBy(Side hand) const { return held_[static_cast<size_t>(hand)]; }
  Side NearerHand(const Vector3& p_W) const { return p_W.x() > 0 ? Side::kLeft : Side::kRight; }

  void Reach(Side hand, int thing);
  /// Moves what the hand holds (with all that is connected to it). @param lift m over the straight way, more if
  /// something is in the way. @param seconds 0: by the style's speed.
  void Carry(Side hand, const Pose& X_W, double lift, double seconds = 0);
  /// Opens the hand; it goes home while other acts go on.
  void Release(Side hand);
  /// Lays a flat hand over a thing for a while.
  void Cover(Side hand, int thing, double seconds);

  /// Picks a lying part and joins it to `base` at X_base_part; `name` of the connection or mistake; `steady`: the
  /// other hand holds the base. Leaves the part in the hand if `keep`.
  struct Joint {
    int base = 0, part = 0;
    Pose X_base_part = Pose::Identity();
    bool steady = false, keep = false;
    double near_miss = 0;  ///< m: first stops this far before the joint, for 1.7 s
    std::string near_miss_name{};
  };
  /// @returns when the joint closed, s
  double Join(Side hand, const Joint& joint);
  /// Pulls `part` off its group and lays it down at X_W.
  void TakeOff(Side hand, int part, const std::string& connection, int from, const Pose& X_W);

  /// Free direction (world, unit) along which a part comes to X_W without passing through another thing, or up.
  Vector3 Approach(int part, const Pose& X_W) const;
  std::vector<int> GroupMembers(int thing) const;
  /// True if a part at X_W would pass through one of these things, or through any.
  bool Blocked(int part, const Pose& X_W, const std::vector<int>& things) const;
  bool Blocked(int part, const Pose& X_W) const;

 private:
  int Group(int thing) const { return group_[static_cast<size_t>(thing)]; }
  HandPose GraspOf(Side hand, int thing, Vector3* p_thing) const;
  void MoveHand(Side hand, const HandPose& to, double lift, double seconds);
  double TimeFor(double distance) const;
  double FreeLift(int thing, const Pose& X_W, double least) const;
  void CarryGroup(int thing, const Pose& X_W, double lift, double seconds);
  void Event(const std::string& kind, std::vector<int> things, Side hand);

  const Task& task_;
  const Solids& solids_;
  ChildStyle style_;
  Performance* performance_;
  Random* random_;
  double now_ = 0.5;
  std::vector<int> group_;
  std::array<int, 2> held_{-1, -1};
  std::array<double, 2> hand_free_{0, 0};
};

const char* ToString(Side hand);
Side Other(Side hand);
/// Where a resting hand lies.
HandPose HomeOf(Side hand);

}  // namespace coach
