// The robot's body over time: which joints are under way, arms that are raised, held and taken down again, and the
// hands that make them stop.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "services/robot_bridge/back_end.h"
#include "services/robot_bridge/gesture.h"

namespace coach {

/// What became of a wish to point.
enum class Pointing {
  kNone,         ///< nobody asked
  kWaiting,      ///< a hand is in the way; tried again
  kRaising,      ///< on the way
  kHolding,      ///< there
  kGivenUp,      ///< a hand stayed in the way or came near
  kUnreachable,  ///< behind the robot or out of its limits by far
};

class Body {
 public:
  Body(const GestureOptions& options, const Pose& X_TR, BackEnd& back_end)
      : options_(options), back_end_(back_end), X_TR_(X_TR) {}

  /// Hands seen on the table (table frame) and when, us. A moving robot does not raise an arm while this is older than
  /// a second, or was never told.
  void SeeHands(const std::vector<ForeignBlob>& hands, int64_t now);

  void PointAt(const Vector3& p_T, int64_t now);
  void LookAt(const Vector3& p_T, int64_t now);
  void LookStraight(int64_t now);
  /// Takes raised arms down as soon as nothing is in the way.
  void LowerArms();
  /// Everything stays where it is until the next order.
  void Freeze(int64_t now);
  /// The robot was away: nothing is known of its joints but what it measures.
  void Forget();

  /// Follows the clock. Call at 20 Hz or more.
  void Step(int64_t now);

  Pointing pointing() const { return pointing_; }
  bool head_moving() const { return head_.moving; }
  bool arms_down() const { return arms_[0].state == ArmState::kDown && arms_[1].state == ArmState::kDown; }
  bool point_clamped() const { return point_clamped_; }
  bool gaze_clamped() const { return gaze_clamped_; }
  const JointAngles& angles() const { return angles_; }
  /// Forgets the last wish to point and the clamped flags.
  void ClearWish();

 private:
  struct Limb {
    JointPath path;
    int64_t start = 0;  // us
    bool moving = false;
  };
  enum class ArmState { kDown, kRaising, kHolding, kStopped, kLowering };
  struct ArmMotion : Limb {
    ArmState state = ArmState::kDown;
    int64_t since = 0;      // us
    bool lower = false;     // wanted down
    bool heedless = false;  // comes down slowly, hand or not
  };

  ArmMotion& Motion(Arm arm) { return arms_[arm == Arm::kLeft ? 0 : 1]; }
  Surroundings Around(int64_t now) const;
  bool HandsKnown(int64_t now) const;
  void Start(Limb& limb, const JointPath& path, int64_t now);
  void Advance(Limb& limb, int64_t now);
  void TryPointing(int64_t now);
  void StepArm(Arm arm, int64_t now);
  void TryLowering(Arm arm, int64_t now);
  bool HandAhead(Arm arm, int64_t now) const;
  void StopForHand(int64_t now);

  GestureOptions options_;
  BackEnd& back_end_;
  Pose X_TR_;
  std::vector<ForeignBlob> hands_;
  std::optional<int64_t> hands_at_;
  JointAngles angles_ = RestAngles();
  Limb head_;
  std::array<ArmMotion, 2> arms_;
  Arm last_arm_ = Arm::kRight;
  std::optional<Vector3> target_;
  int64_t target_since_ = 0;
  Pointing pointing_ = Pointing::kNone;
  bool point_clamped_ = false, gaze_clamped_ = false;
};

}  // namespace coach
