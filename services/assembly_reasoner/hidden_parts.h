// What is known of hidden parts by the parts they are joined to.
//
// A part under a hand is not seen, but if it hangs on one that is seen, it is where their joint puts it: a third part
// that comes to rest in a joint with it can be noticed before the hand leaves. Such evidence is never told to the
// tracker, so that it can't confirm itself.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "common/assembly/part_poses.h"
#include "services/assembly_reasoner/contact_classes.h"

namespace coach {

struct HiddenPartOptions {
  double hidden_visible = 0.05;   ///< visible fraction under which a part counts as hidden
  double holder_visible = 0.30;   ///< of the part that holds it, and of the third part, at least
  double seat_position = 0.008;   ///< m, as near a joint's pose a pair has been seen to be known in it
  double seat_angle = 0.15;       ///< rad, the same
  double play_position = 0.0015;  ///< m, of a joint, standard deviation
  double play_angle = 0.015;      ///< rad, the same
};

/// Covariance of X_AB = X_TA^-1 X_TB for independent errors of both, each in the table frame.
Matrix6 RelativeCovariance(const Pose& X_TA, const Matrix6& covariance_A, const Pose& X_TB,
                           const Matrix6& covariance_B);

class HiddenParts {
 public:
  explicit HiddenParts(const HiddenPartOptions& options = {}) : options_(options) {}

  /// Two parts, first < second, believed to be joined in a class, were seen at this relative pose.
  void Seat(const std::pair<int, int>& pair, const ContactClass& contact, const Pose& X_AB);
  /// The joint is open, or of a kind that does not say where the parts are.
  void Unseat(const std::pair<int, int>& pair) { seats_.erase(pair); }
  /// Parts i and j turn out to have been taken for each other.
  void Exchange(int i, int j);

  /// Evidence of every pair of a hidden part that is held and a part that is seen.
  std::vector<PairEvidence> Infer(const PartPoses& poses) const;

 private:
  HiddenPartOptions options_;
  std::map<std::pair<int, int>, Pose> seats_;  // nominal X_AB of joints that were seen
};

}  // namespace coach
