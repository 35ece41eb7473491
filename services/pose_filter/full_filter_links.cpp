// The part of the filter that lets believed connections carry parts.
#include <algorithm>

#include "services/pose_filter/full_filter.h"

namespace coach {

void FullFilter::UpdateLinks(const FilterInput& input) {
  std::vector<Link> links;
  if (input.belief && input.utime - input.belief->utime < 500000) {
    for (const ConnectionProbability& c : input.belief->connections) {
      const int n = static_cast<int>(tracks_.size());
      if (c.probability < options_.link_probability || c.part_a < 0 || c.part_b < 0 || c.part_a >= n || c.part_b >= n)
        continue;
      Link link{c.part_a, c.part_b, false, Pose::Identity()};
      for (const Link& old : links_) {
        if (old.part_a == link.part_a && old.part_b == link.part_b) link = old;
      }
      if (!tracks_[link.part_a].missing() && !tracks_[link.part_b].missing()) {
        const Pose seen = tracks_[link.part_a].X_TP_free.inverse() * tracks_[link.part_b].X_TP_free;
        double nearest = 0.025;  // m, a radian counting as 5 cm
        for (const PairFinder::Candidate& joint : pairs_.CandidatesOf(link.part_a, link.part_b)) {
          const Vector6 e = Difference(joint.X_AB, seen);
          const double distance = e.head<3>().norm() + 0.05 * e.tail<3>().norm();
          if (distance >= nearest) continue;
          nearest = distance;
          link.X_AB = joint.X_AB;
          link.known = true;
        }
      }
      links.push_back(link);
    }
  }
  links_ = std::move(links);
}

void FullFilter::DropEmptyLinks(int part, const Observation& observation) {
  for (Link& link : links_) {
    if (!link.known || (link.part_a != part && link.part_b != part)) continue;
    const int partner = link.part_a == part ? link.part_b : link.part_a;
    const Track& p = tracks_[partner];
    if (!updated_[partner] || p.missing() || p.confidence < 0.5) continue;
    if (StepLength(Difference(poses_before_[partner], p.X_TP), 0.05) > options_.link_rest) continue;
    const Pose X_CP = camera_.X_TC().inverse() * p.X_TP * (link.part_a == part ? link.X_AB.inverse() : link.X_AB);
    RenderTile(ShapeOf(part).model, observation.camera, X_CP, OwnerMap::kStep, 0, scratch_.tile);
    const Score score = ScoreTile(scratch_.tile, observation, owners_, part, bit_of_part_[part]);
    if (score.open() > 0.3 * score.covered && score.open() >= 20 && score.agreement() < 0.2) link.known = false;
  }
}

bool FullFilter::InJoint(int part, const Pose& X_TP, int other) const {
  for (const Link& link : links_) {
    if (!link.known || std::minmax(link.part_a, link.part_b) != std::minmax(part, other)) continue;
    const Pose& X_TA = link.part_a == part ? X_TP : tracks_[link.part_a].X_TP;
    const Pose& X_TB = link.part_a == part ? tracks_[link.part_b].X_TP : X_TP;
    if (StepLength(Difference(link.X_AB, X_TA.inverse() * X_TB), 0.05) < options_.link_overlap) return true;
  }
  return false;
}

std::optional<Pose> FullFilter::CarriedBy(int part, Matrix6& covariance) const {
  std::optional<Pose> best;
  double best_spread = 1e9;
  Matrix6 play = Matrix6::Zero();
  play.diagonal().head<3>().setConstant(options_.link_position * options_.link_position);
  play.diagonal().tail<3>().setConstant(options_.link_rotation * options_.link_rotation);
  for (const Link& link : links_) {
    if (!link.known || (link.part_a != part && link.part_b != part)) continue;
    const int partner = link.part_a == part ? link.part_b : link.part_a;
    if (!updated_[partner] && tracks_[partner].missing()) continue;
    const Pose X_PQ = link.part_a == part ? link.X_AB.inverse() : link.X_AB;  // this part in its partner's frame
    const Track& p = tracks_[partner];
    Matrix6 spread = ComposeCovariance(p.X_TP, p.covariance, X_PQ, play);
    if (!updated_[partner]) spread += Matrix6::Identity() * 1e-4;  // its pose is that of the frame before
    if (spread.topLeftCorner<3, 3>().trace() >= best_spread) continue;
    best_spread = spread.topLeftCorner<3, 3>().trace();
    best = p.X_TP * X_PQ;
    covariance = spread;
  }
  return best;
}

}  // namespace coach
