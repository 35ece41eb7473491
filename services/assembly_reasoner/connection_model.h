// How it is judged whether two parts are connected: one interface, two models.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"
#include "services/assembly_reasoner/contact_classes.h"

namespace coach {

/// Two parts in one frame.
struct PairView {
  int64_t utime = 0;                ///< us
  int part_a = 0, part_b = 0;       ///< part_a < part_b
  const PartEstimate* a = nullptr;  ///< never null
  const PartEstimate* b = nullptr;
  const PairEvidence* evidence = nullptr;  ///< null: the tracker said nothing of this pair
  bool inferred = false;                   ///< the evidence is of a hidden part that a seen one holds (hidden_parts.h)
  bool misfit = false;                     ///< one of the two is measured inside another part, where nothing can be
  bool pressed = false;                    ///< one of the two stands in another part by more than it is measured wrong
  int decided = -1;                        ///< class that the pair is believed to be in; negative: none
};

/// What a frame says of a pair.
struct PairVerdict {
  bool has_evidence = false;     ///< false: nothing can be said, belief stays as it is
  std::vector<double> log_odds;  ///< nats against 'not connected', one a class of the pair
  double unknown = -1e9;         ///< nats, of a rigid contact that is in no class
};

class ConnectionModel {
 public:
  virtual ~ConnectionModel() = default;
  virtual PairVerdict Judge(const PairView& view) = 0;
  /// Estimated moment (us) at which the pair came into class `label` (or, with label -1, left class `former`), decided
  /// now.
  virtual int64_t ChangeTime(int part_a, int part_b, int label, int former, int64_t now) const = 0;
  /// Parts i and j turn out to have been taken for each other.
  virtual void Exchange(int i, int j) = 0;
};

/// Equations [1] and [2] of the paper on the poses, frame by frame; [1] above one half counts as connected. It has no
/// notion of an unknown contact.
std::unique_ptr<ConnectionModel> MakePaperConnectionModel(const Task& task, const ContactTable& contacts);

struct CoachConnectionModelOptions {
  double correlation_time = 0.15;  ///< s, of the tracker's errors: successive frames are not independent
  double blur_time = 0.010;        ///< s of a part's motion by which its measured place may be off
  double blur_turn = 0.15;         ///< rad per m/s, by which its measured direction may be off
  double hidden_blur = 0.0010;     ///< m a part is worse measured when it is all but hidden, in proportion
  double slack_position = 0.0010;  ///< m, play of a made joint and constant bias of the tracker, standard deviation
  double slack_angle = 0.020;      ///< rad, the same
  double smallest_visible = 0.05;  ///< visible fraction of either part under which a frame says nothing
  double full_visible = 0.12;      ///< from here on evidence counts in full; its precision is in the covariance
  double apart_visible = 0.20;     ///< of both parts, for a missing pair to mean that they are apart
  double largest_log_odds = 10;    ///< nats, of one judgement
  double far_distance = 0.020;     ///< m from every class: certainly open, if both parts are visible and no pair given
  double together_travel = 0.025;  ///< m that a pair moves as one before that counts
  double together_turn = 0.26;     ///< rad, the same
  double together_time = 0.5;      ///< s for which its relative pose stayed constant
  double together_bonus = 2.0;     ///< nats
  double image_weight = 0.1;       ///< of PairEvidence::log_evidence: neighbouring pixels are no independent witnesses
  double image_limit = 2.0;        ///< nats, of that term
  double pressed_limit = 3.0;      ///< nats at most for parts that are measured in each other: they touch
  double inferred_price = 1.0;     ///< nats against what is known by a partner only
  double calm_speed = 0.15;        ///< m/s of either part up to which a small separation counts as coming apart
  double clear_gap = 0.008;        ///< m of air between the surfaces that counts as coming apart at any speed
  double break_visible = 0.12;     ///< visible fraction of either part under which no joint is seen to come apart
  double fastest_pull = 0.8;       ///< m/s at which hands take parts apart; faster: the tracker lost one
  double fastest_twist = 8.0;      ///< rad/s, the same
  double jump_time = 1.5;          ///< s after such a jump for which a pair is not seen to come apart
  double dating_limit = 2.0;       ///< nats of one measurement for or against, when a change is dated
  double dating_visible = 0.25;    ///< visible fraction from which on a measurement counts in full for that
  double least_approach = 0.03;    ///< m/s at which parts came together when last seen, to tell when they met
  double unknown_travel = 0.06;    ///< m moved as one, touching, before an unknown contact is considered
  double unknown_time = 1.2;       ///< s of it
  double unknown_slip = 0.008;     ///< m of relative motion in the last half second at most
  double unknown_twist = 0.15;     ///< rad, the same
  double unknown_gap = 0.003;      ///< m between the surfaces at most
};

/// Coach's own: the free relative pose over the longest window in which it was constant, as a likelihood ratio of
/// 'made' against an explicit alternative that has its mass in near misses, with moving-together and one-body-or-two
/// evidence.
std::unique_ptr<ConnectionModel> MakeCoachConnectionModel(const Task& task, const ContactTable& contacts,
                                                          const CoachConnectionModelOptions& options = {});

}  // namespace coach
