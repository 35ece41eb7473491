#include "services/robot_bridge/body.h"

namespace coach {
namespace {

constexpr int64_t kHandsFresh = 1000000;      // us
constexpr int64_t kPatience = 3000000;        // us, how long a wish to point waits for a hand to go away
constexpr int64_t kLowerPatience = 20000000;  // us, then an arm is taken down slowly though a hand is near
constexpr double kSlow = 0.1;                 // fraction of the joints' speed

}  // namespace

void Body::SeeHands(const std::vector<ForeignBlob>& hands, int64_t now) {
  hands_ = hands;
  hands_at_ = now;
}

bool Body::HandsKnown(int64_t now) const { return hands_at_ && now - *hands_at_ <= kHandsFresh; }

Surroundings Body::Around(int64_t now) const { return {X_TR_, HandsKnown(now) ? hands_ : std::vector<ForeignBlob>{}}; }

void Body::Start(Limb& limb, const JointPath& path, int64_t now) {
  limb.path = path;
  limb.start = now;
  limb.moving = path.duration() > 0;
  if (limb.moving) back_end_.Move(path);
}

void Body::Advance(Limb& limb, int64_t now) {
  if (!limb.moving) return;
  const double time = static_cast<double>(now - limb.start) * 1e-6;
  const JointAngles at = limb.path.At(time);
  for (size_t j = 0; j < angles_.size(); ++j) {
    if (limb.path.moves[j]) angles_[j] = at[j];
  }
  limb.moving = time < limb.path.duration();
}

void Body::PointAt(const Vector3& p_T, int64_t now) {
  target_ = p_T;
  target_since_ = now;
  pointing_ = Pointing::kWaiting;
  TryPointing(now);
}

void Body::TryPointing(int64_t now) {
  if (now - target_since_ > kPatience) {
    pointing_ = Pointing::kGivenUp;
    target_.reset();
    return;
  }
  if (back_end_.physical() && !HandsKnown(now)) return;
  const PointingPlan plan = PlanPointing(*target_, angles_, last_arm_, Around(now), options_);
  point_clamped_ = plan.clamped;
  if (!plan.possible) {
    if (plan.obstacle == Obstacle::kHand) return;
    pointing_ = Pointing::kUnreachable;
    target_.reset();
    return;
  }
  target_.reset();
  pointing_ = Pointing::kRaising;
  last_arm_ = plan.arm;
  ArmMotion& motion = Motion(plan.arm);
  Start(motion, plan.path, now);
  motion.state = ArmState::kRaising;
  motion.since = now;
  motion.lower = motion.heedless = false;
  ArmMotion& other = Motion(Other(plan.arm));
  if (other.state != ArmState::kDown) other.lower = true;
}

void Body::LookAt(const Vector3& p_T, int64_t now) {
  const GazePlan plan = PlanGaze(p_T, angles_, Around(now), options_);
  gaze_clamped_ = plan.clamped;
  Start(head_, plan.path, now);
}

void Body::LookStraight(int64_t now) {
  gaze_clamped_ = false;
  Start(head_, PlanHeadStraight(angles_, options_).path, now);
}

void Body::LowerArms() {
  target_.reset();
  for (ArmMotion& arm : arms_) arm.lower = arm.state != ArmState::kDown;
}

void Body::Freeze(int64_t now) {
  back_end_.Freeze();
  target_.reset();
  head_.moving = false;
  for (ArmMotion& arm : arms_) {
    arm.lower = false;
    if (arm.state == ArmState::kDown) continue;
    arm.moving = false;
    arm.state = ArmState::kStopped;
    arm.since = now;
  }
}

void Body::Forget() {
  target_.reset();
  pointing_ = Pointing::kNone;
  head_.moving = false;
  for (ArmMotion& arm : arms_) arm = {};
}

void Body::ClearWish() {
  target_.reset();
  pointing_ = Pointing::kNone;
  point_clamped_ = gaze_clamped_ = false;
}

bool Body::HandAhead(Arm arm, int64_t now) const {
  const ArmMotion& motion = arms_[arm == Arm::kLeft ? 0 : 1];
  const double time = static_cast<double>(now - motion.start) * 1e-6;
  return FirstObstacle(arm, motion.path, time, Around(now), options_) == Obstacle::kHand;
}

void Body::StopForHand(int64_t now) {
  Freeze(now);
  pointing_ = Pointing::kGivenUp;
  for (ArmMotion& arm : arms_) arm.lower = arm.state != ArmState::kDown;
}

void Body::TryLowering(Arm arm, int64_t now) {
  ArmMotion& motion = Motion(arm);
  GestureOptions options = options_;
  Surroundings around = Around(now);
  const bool waited = now - motion.since > kLowerPatience;
  if (waited) {
    options.speed_fraction = kSlow;
    around.hands.clear();
  }
  PointingPlan plan = PlanArmDown(arm, angles_, around, options);
  if (!plan.possible && plan.obstacle == Obstacle::kHand) return;
  if (!plan.possible) {
    // From an odd place no clear way is known: the shortest one, slowly.
    JointAngles goal = angles_;
    for (int j = FirstJoint(arm); j < FirstJoint(arm) + 5; ++j) {
      goal[static_cast<size_t>(j)] = RestAngles()[static_cast<size_t>(j)];
    }
    plan.path = SmoothPath({angles_, goal}, kSlow);
  }
  Start(motion, plan.path, now);
  motion.state = ArmState::kLowering;
  motion.since = now;
  motion.lower = false;
  motion.heedless = waited;
}

void Body::StepArm(Arm arm, int64_t now) {
  ArmMotion& motion = Motion(arm);
  if (motion.moving && !motion.heedless && HandAhead(arm, now)) {
    Advance(motion, now);
    StopForHand(now);
    return;
  }
  Advance(motion, now);
  switch (motion.state) {
    case ArmState::kDown:
      break;
    case ArmState::kRaising:
      if (motion.moving) break;
      motion.state = ArmState::kHolding;
      motion.since = now;
      if (pointing_ == Pointing::kRaising) pointing_ = Pointing::kHolding;
      break;
    case ArmState::kHolding:
      if (now - motion.since >= static_cast<int64_t>(options_.hold_s * 1e6)) motion.lower = true;
      break;
    case ArmState::kStopped:
      break;
    case ArmState::kLowering:
      if (!motion.moving) motion.state = ArmState::kDown;
      break;
  }
  const bool up = motion.state == ArmState::kHolding || motion.state == ArmState::kStopped;
  if (motion.lower && (up || motion.state == ArmState::kRaising)) TryLowering(arm, now);
}

void Body::Step(int64_t now) {
  Advance(head_, now);
  StepArm(Arm::kLeft, now);
  StepArm(Arm::kRight, now);
  if (!head_.moving && !arms_[0].moving && !arms_[1].moving) {
    if (const auto measured = back_end_.MeasuredAngles()) angles_ = *measured;
  }
  if (target_) TryPointing(now);
}

}  // namespace coach
