// The part of the filter that looks for parts where they are not expected: bodies in fast motion, parts that are
// missing.
#include <algorithm>

#include "services/pose_filter/full_filter.h"

namespace coach {

std::vector<RigidBody> FullFilter::Bodies() const {
  std::vector<RigidBody> bodies;
  std::vector<bool> taken(tracks_.size(), false);
  const auto add = [&](RigidBody& body, int part, const Pose& X_GP) {
    taken[part] = true;
    body.push_back({&ShapeOf(part).model, &ShapeOf(part).search_points, part, bit_of_part_[part], X_GP});
  };
  for (const int root : order_) {
    if (taken[root] || tracks_[root].missing()) continue;
    RigidBody body;
    add(body, root, Pose::Identity());
    for (size_t i = 0; i < body.size(); ++i) {
      const int at = body[i].part;
      for (const Link& link : links_) {
        if (!link.known || (link.part_a != at && link.part_b != at)) continue;
        const int other = link.part_a == at ? link.part_b : link.part_a;
        if (taken[other] || !tracks_[other].alive()) continue;
        add(body, other, body[i].X_GP * (link.part_a == at ? link.X_AB : link.X_AB.inverse()));
      }
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

void FullFilter::FollowBodies(const Observation& observation, double dt) {
  followed_.assign(tracks_.size(), std::nullopt);
  if (!options_.follow_bodies || !observation.depth || !observation.class_map) return;
  const auto at_prediction = [&](int part) {
    return ScoreTile(tiles_[part], ViewFor(part, observation), owners_, part, bit_of_part_[part]);
  };
  const auto astray = [&](const Score& score) {
    return score.open() >= 20 && score.agreement() < options_.follow_agreement;
  };
  if (std::none_of(order_.begin(), order_.end(),
                   [&](int part) { return !tracks_[part].missing() && astray(at_prediction(part)); }))
    return;
  const Pose X_CT = camera_.X_TC().inverse();
  for (const RigidBody& body : Bodies()) {
    Score score;
    for (const RigidMember& m : body) score += at_prediction(m.part);
    if (!astray(score)) continue;
    for (const RigidMember& m : body) owners_.Remove(m.part, tiles_[m.part]);
    // What the prediction explains must be explained better elsewhere: a sleeve of the part's colour is larger than
    // what a hand leaves of the part.
    BodySearchOptions search = options_.body;
    search.far_likelihood = options_.follow_gain * std::max(0.0, score.log_likelihood);
    const std::optional<Pose> X_CG =
        SearchBody(body, observation, owners_, X_CT * PredictPose(tracks_[body.front().part], dt), X_CT.linear().col(2),
                   dt, search, scratch_);
    for (const RigidMember& m : body) {
      if (X_CG) {
        followed_[m.part] = camera_.X_TC() * *X_CG * m.X_GP;
        RenderTile(*m.model, observation.camera, *X_CG * m.X_GP, OwnerMap::kStep, 0, tiles_[m.part]);
      }
      if (!tracks_[m.part].missing()) owners_.Add(m.part, tiles_[m.part]);
    }
  }
}

void FullFilter::TrySuggestions(const Observation& observation) {
  for (size_t k = 0; k < suggested_.size(); ++k) {
    const int part = static_cast<int>(k);
    if (tracks_[k].alive()) continue;
    const PoseCandidate c = Polish(ShapeOf(part).model, observation, owners_, part, bit_of_part_[k], suggested_[k],
                                   options_.refinement, scratch_);
    if (!Acceptable(c, options_.search)) continue;
    Restart(c, camera_.X_TC(), tracks_[k]);
    updated_[k] = true;
    Place(part, observation);
  }
  suggested_.clear();
}

bool FullFilter::InReach(const Vector3& p_T) const { return p_T.z() > -0.10 && p_T.z() < 0.80 && area_.Over(p_T); }

bool FullFilter::Plausible(int part, const PoseCandidate& found, bool unlikely) const {
  // A part that lay still when something moved in front of it is most likely still there: to be found elsewhere it must
  // be seen well. So must one that is unlikely there: in the place of a distractor, or away from where a seen part is
  // believed.
  if (!InReach(camera_.X_TC() * found.X_CP.translation())) return false;
  const Track& track = tracks_[part];
  const bool at_rest =
      (track.status == PartStatus::kOccluded || track.status == PartStatus::kOutOfView) && !track.carried;
  if (!at_rest && !unlikely) return true;
  return found.score.agreement() > 0.8 && found.outline_support() > 0.85 &&
         found.score.open() > 0.5 * found.full_samples;
}

void FullFilter::Recover(const Observation& observation) {
  if (!observation.class_map || !observation.depth) return;
  const bool any = std::any_of(tracks_.begin(), tracks_.end(), [](const Track& t) { return t.missing(); });
  if (!any) {
    if (steps_ % options_.relocation_period == 0) {
      const auto& blobs =
          blob_finder_.FindUnexplained(observation, owners_, class_of_part_, num_classes_, camera_.X_TC(), area_);
      Relocate(blobs, observation);
      distractors_.Remember(blobs, camera_.X_TC());
    }
    return;
  }
  int left = steps_ < 3 ? 1000 : options_.searches;
  for (size_t round = 0; round < tracks_.size() && left > 0; ++round) {
    const auto& blobs =
        blob_finder_.FindUnexplained(observation, owners_, class_of_part_, num_classes_, camera_.X_TC(), area_);
    int best_part = -1;
    PoseCandidate best;
    double best_gain = options_.relocation_gain;
    // Another blob comes first in every frame, so that each has its turn however many there are.
    for (size_t b = 0; b < blobs.size(); ++b) {
      const Blob& blob = blobs[(b + static_cast<size_t>(steps_)) % blobs.size()];
      // What was taken for a distractor is looked at now and then: a part may have been mistaken for it.
      const bool distractor = distractors_.Known(blob, camera_.X_TC());
      if (distractor && steps_ % 8 != 0) continue;
      std::vector<int> tried_types;
      for (size_t k = 0; k < tracks_.size() && left > 0; ++k) {
        if (!tracks_[k].missing() || class_of_part_[k] != blob.colour_class) continue;
        const int type = task_.parts[k].type;
        if (std::find(tried_types.begin(), tried_types.end(), type) != tried_types.end()) continue;
        tried_types.push_back(type);
        --left;
        const std::optional<Pose> former = tracks_[k].status == PartStatus::kAbsent
                                               ? std::nullopt
                                               : std::optional<Pose>(camera_.X_TC().inverse() * tracks_[k].X_TP);
        const auto found = SearchPose(ShapeOf(static_cast<int>(k)).model, ShapeOf(static_cast<int>(k)).search_points,
                                      observation, owners_, static_cast<int>(k), bit_of_part_[k], blob, camera_.X_TC(),
                                      options_.search, former ? &*former : nullptr, scratch_);
        if (!found || found->score.log_likelihood <= best_gain || !Plausible(static_cast<int>(k), *found, distractor))
          continue;
        best_gain = found->score.log_likelihood;
        best = *found;
        best_part = static_cast<int>(k);
      }
    }
    if (best_part < 0) return;
    // Of equal parts that are missing, the one that was last believed nearest.
    const Vector3 at = camera_.X_TC() * best.X_CP.translation();
    double nearest = 1e9;
    int chosen = best_part;
    for (size_t k = 0; k < tracks_.size(); ++k) {
      if (!tracks_[k].missing() || task_.parts[k].type != task_.parts[static_cast<size_t>(best_part)].type) continue;
      const double d = tracks_[k].status == PartStatus::kAbsent ? 10.0 : (tracks_[k].X_TP.translation() - at).norm();
      if (d < nearest - 1e-9) {
        nearest = d;
        chosen = static_cast<int>(k);
      }
    }
    if (tracks_[chosen].status != PartStatus::kAbsent) {
      // Of the poses that look the same, the one nearest to what was known: links to partners stay valid.
      best.X_CP = NearestEquivalent(ShapeOf(chosen).model.symmetries, best.X_CP,
                                    camera_.X_TC().inverse() * tracks_[chosen].X_TP);
    }
    Restart(best, camera_.X_TC(), tracks_[chosen]);
    Place(chosen, observation);
  }
}

void FullFilter::Relocate(const std::vector<Blob>& blobs, const Observation& observation) {
  if (blobs.empty()) return;
  // One search a time: each blob has its turn.
  const Blob& blob = blobs[static_cast<size_t>(steps_ / options_.relocation_period) % blobs.size()];
  if (distractors_.Known(blob, camera_.X_TC())) return;
  int chosen = -1;
  double least = options_.relocation_visible;
  for (size_t k = 0; k < tracks_.size(); ++k) {
    const Track& track = tracks_[k];
    if (class_of_part_[k] != blob.colour_class || track.visible_fraction >= least) continue;
    if (track.visible_fraction >= options_.relocation_small && track.confidence >= options_.relocation_sure) continue;
    least = track.visible_fraction;
    chosen = static_cast<int>(k);
  }
  if (chosen < 0) return;
  const Pose former = camera_.X_TC().inverse() * tracks_[chosen].X_TP;
  const auto found = SearchPose(ShapeOf(chosen).model, ShapeOf(chosen).search_points, observation, owners_, chosen,
                                bit_of_part_[chosen], blob, camera_.X_TC(), options_.search, &former, scratch_);
  if (!found || !Plausible(chosen, *found, true)) return;
  const double least_likelihood = options_.relocation_ratio * tracks_[chosen].log_likelihood + options_.relocation_gain;
  if (found->score.log_likelihood < least_likelihood) return;
  Restart(*found, camera_.X_TC(), tracks_[chosen]);
  Place(chosen, observation);
}

void FullFilter::FindOnTable(const Observation& observation) {
  if (!observation.depth || !observation.class_map || options_.surface_search_period <= 0 ||
      steps_ % options_.surface_search_period != 0)
    return;
  for (size_t k = 0; k < tracks_.size(); ++k) {
    if (tracks_[k].status != PartStatus::kAbsent) continue;
    const int part = static_cast<int>(k);
    std::optional<PoseCandidate> best;
    bool best_by_depth = false;
    const auto& blobs = blob_finder_.FindSurfaces(observation, owners_, camera_.X_TC(), area_);
    for (size_t b = 0; b < blobs.size(); ++b) {
      // All of them at the start, later another one each time.
      if (steps_ > 0 && b != static_cast<size_t>(steps_ / options_.surface_search_period) % blobs.size()) continue;
      const double own = ShareOfClass(blobs[b].pixels, observation, bit_of_part_[k]);
      if (own < options_.surface_own_colour) continue;
      const bool by_depth = own < options_.surface_good_colour;
      const auto found =
          SearchPose(ShapeOf(part).model, ShapeOf(part).search_points, by_depth ? depth_only_ : observation, owners_,
                     part, bit_of_part_[k], blobs[b], camera_.X_TC(), options_.surface_search, nullptr, scratch_);
      if (!found || found->score.log_likelihood <= options_.relocation_gain || !Plausible(part, *found, false))
        continue;
      if (by_depth && (found->score.agreement() < options_.depth_agreement)) continue;
      if (best && found->score.log_likelihood <= best->score.log_likelihood) continue;
      best = found;
      best_by_depth = by_depth;
    }
    if (!best) continue;
    Restart(*best, camera_.X_TC(), tracks_[k]);
    tracks_[k].by_depth = best_by_depth;
    Place(part, observation);
  }
}

}  // namespace coach
