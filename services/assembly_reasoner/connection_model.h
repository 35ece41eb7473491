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
  double slack_position = 0.0010;  ///< m, play of a made joint and constant bias of the tracker, standard deviation
  double slack_angle = 0.020;      ///< rad, the same
  double smallest_visible = 0.05;  ///< visible fraction of either part under which a frame says nothing
  double full_visible = 0.12;      ///< from here on evidence counts in full; its precision is in the covariance
  double apart_visible = 0.30;     ///< of both parts, for a missing pair to mean that they are apart
  double largest_log_odds = 10;    ///< nats, of one judgement
  double far_distance = 0.020;     ///< m from every class: certainly open, if both parts are visible and no pair given
  double together_travel = 0.025;  ///< m that a pair moves as one before that counts
  double together_turn = 0.26;     ///< rad, the same
  double together_time = 0.5;      ///< s for which its relative pose stayed constant
  double together_bonus = 2.0;     ///< nats
  double image_weight = 0.1;       ///< of PairEvidence::log_evidence: neighbouring pixels are no independent witnesses
  double image_limit = 2.0;        ///< nats, of that term
  double unknown_travel = 0.06;    ///< m moved as one, touching, before an unknown contact is considered
  double unknown_time = 1.2;       ///< s of it
  double unknown_gap = 0.003;      ///< m between the surfaces at most
};

/// Coach's own: the free relative pose over the longest window in which it was constant, as a likelihood ratio of
/// 'made' against an explicit alternative that has its mass in near misses, with moving-together and one-body-or-two
/// evidence.
std::unique_ptr<ConnectionModel> MakeCoachConnectionModel(const Task& task, const ContactTable& contacts,
                                                          const CoachConnectionModelOptions& options = {});

}  // namespace coach
