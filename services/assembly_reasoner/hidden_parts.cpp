#include "services/assembly_reasoner/hidden_parts.h"

#include <algorithm>

namespace coach {
namespace {

constexpr double kFar = 0.030;  // m between surfaces: nothing is known of the gap

Matrix6 Isotropic(double position, double angle) {
  Vector6 d;
  d << Vector3::Constant(position * position), Vector3::Constant(angle * angle);
  return d.asDiagonal();
}

}  // namespace

Matrix6 RelativeCovariance(const Pose& X_TA, const Matrix6& covariance_A, const Pose& X_TB,
                           const Matrix6& covariance_B) {
  const Matrix3 R_AT = X_TA.linear().transpose();
  const Vector3 d = X_TB.translation() - X_TA.translation();
  Matrix3 D;
  D << 0, -d.z(), d.y(), d.z(), 0, -d.x(), -d.y(), d.x(), 0;
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = -R_AT;
  J.topRightCorner<3, 3>() = R_AT * D;
  J.bottomRightCorner<3, 3>() = -R_AT;
  return J * covariance_A * J.transpose() + RotateCovariance(R_AT, covariance_B);
}

void HiddenParts::Seat(const std::pair<int, int>& pair, const ContactClass& contact, const Pose& X_AB) {
  if (!contact.templates[0].freedom.empty()) return Unseat(pair);
  const ContactError error = NearestContact(contact, X_AB);
  const bool seated =
      error.xi.head<3>().norm() < options_.seat_position && error.xi.tail<3>().norm() < options_.seat_angle;
  if (seated) seats_[pair] = error.X_nominal;
}

void HiddenParts::Exchange(int i, int j) {
  const auto other = [&](int k) { return k == i ? j : k == j ? i : k; };
  std::map<std::pair<int, int>, Pose> exchanged;
  for (const auto& [pair, X_AB] : seats_) {
    const int a = other(pair.first), b = other(pair.second);
    exchanged[std::minmax(a, b)] = a < b ? X_AB : X_AB.inverse();
  }
  seats_ = std::move(exchanged);
}

std::vector<PairEvidence> HiddenParts::Infer(const PartPoses& poses) const {
  std::vector<PairEvidence> out;
  const auto is_seen = [&](int p) {
    return poses.parts[p].status == PartStatus::kTracked && poses.parts[p].visible_fraction >= options_.holder_visible;
  };
  const int n = static_cast<int>(poses.parts.size());
  for (int hidden = 0; hidden < n; ++hidden) {
    if (poses.parts[hidden].status != PartStatus::kOccluded) continue;
    if (poses.parts[hidden].visible_fraction >= options_.hidden_visible) continue;
    int holder = -1;
    Pose X_HP = Pose::Identity();  // the hidden part in its holder
    for (const auto& [pair, X_AB] : seats_) {
      const int partner = pair.first == hidden ? pair.second : pair.second == hidden ? pair.first : -1;
      if (partner < 0 || !is_seen(partner)) continue;
      if (holder >= 0 && poses.parts[partner].visible_fraction <= poses.parts[holder].visible_fraction) continue;
      holder = partner;
      X_HP = pair.first == partner ? X_AB : X_AB.inverse();
    }
    if (holder < 0) continue;
    const PartEstimate& h = poses.parts[holder];
    const Pose X_TP = h.X_TP * X_HP;
    const Matrix6 covariance =
        ComposeCovariance(h.X_TP, h.covariance, X_HP, Isotropic(options_.play_position, options_.play_angle));
    for (int third = 0; third < n; ++third) {
      if (third == hidden || third == holder || !is_seen(third)) continue;
      const PartEstimate& t = poses.parts[third];
      const bool first = third < hidden;
      PairEvidence pair;
      pair.part_a = std::min(third, hidden);
      pair.part_b = std::max(third, hidden);
      pair.X_AB = first ? t.X_TP.inverse() * X_TP : X_TP.inverse() * t.X_TP;
      pair.covariance = first ? RelativeCovariance(t.X_TP, t.covariance, X_TP, covariance)
                              : RelativeCovariance(X_TP, covariance, t.X_TP, t.covariance);
      pair.surface_distance = kFar;
      pair.visible_fraction = {h.visible_fraction, t.visible_fraction};
      out.push_back(pair);
    }
  }
  return out;
}

}  // namespace coach
