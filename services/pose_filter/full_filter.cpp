#include "services/pose_filter/full_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace coach {

FullFilter::FullFilter(const Task& task, const FullFilterOptions& options, uint64_t seed)
    : task_(task),
      options_(options),
      seed_(seed),
      camera_(options.camera),
      foreign_(options.foreign),
      pairs_(task, options.pairs) {
  for (const PartType& type : task_.types) {
    auto shape = std::make_unique<Shape>();
    shape->model = MakePartModel(type);
    shape->search_points = MakePointSet(shape->model, options.search.points);
    shapes_.push_back(std::move(shape));
  }
  for (const Part& part : task_.parts) {
    class_of_part_.push_back(task_.ColourClass(part.type));
    bit_of_part_.push_back(static_cast<uint8_t>(1u << class_of_part_.back()));
  }
  num_classes_ = task_.NumColourClasses();
  Reset();
}

void FullFilter::Reset() {
  rng_.seed(seed_);
  last_utime_ = 0;
  steps_ = 0;
  camera_.Reset();
  distractors_ = Distractors();
  area_.Reset();
  foreign_.Reset();
  pairs_.Reset();
  tracks_.assign(task_.parts.size(), Track());
  tiles_.assign(task_.parts.size(), DepthTile());
  suggested_.clear();
  owners_.Clear();
}

void FullFilter::Suggest(const std::vector<Pose>& X_CP) {
  if (X_CP.size() == task_.parts.size()) suggested_ = X_CP;
}

const PartPoses& FullFilter::Step(const FilterInput& input) {
  Observation observation;
  observation.camera = input.camera;
  if (!(input.camera == camera_model_)) {
    camera_model_ = input.camera;
    owners_.Resize(input.camera);
  }
  const cv::Size size(input.camera.width, input.camera.height);
  if (input.depth.type() == CV_16UC1 && input.depth.size() == size && input.depth.isContinuous())
    observation.depth = input.depth.ptr<uint16_t>();
  observation.metres_per_unit = input.metres_per_unit;
  if (input.colour.type() == CV_8UC3 && input.colour.size() == size && input.colour.isContinuous())
    observation.bgr = input.colour.ptr<uint8_t>();
  if (input.detections && input.detections->class_map.size() == static_cast<size_t>(size.area()))
    observation.class_map = input.detections->class_map.data();
  // Time that stands still or jumps back is no time at all; a long gap is as good as a second.
  const double dt =
      steps_ == 0 ? 1.0 / 30 : std::clamp(static_cast<double>(input.utime - last_utime_) * 1e-6, 1e-3, 1.0);
  last_utime_ = input.utime;

  LocateCamera(observation);
  observation.has_table = camera_.started();
  observation.table = PlaneOf(camera_.X_TC());
  if (steps_ % 15 == 0) area_.Add(observation, camera_.X_TC());
  depth_only_ = observation.DepthOnly();
  BuildOwners(observation, dt);
  OrderParts();
  UpdateLinks(input);
  FollowBodies(observation, dt);
  updated_.assign(tracks_.size(), false);
  std::vector<Pose>& before = poses_before_;
  before.clear();
  for (const Track& track : tracks_) before.push_back(track.X_TP);
  TrySuggestions(observation);
  for (const int part : order_) {
    Track& track = tracks_[part];
    if (updated_[part]) continue;
    if (track.status == PartStatus::kLost) {
      Matrix6 covariance;
      if (const auto carried = CarriedBy(part, covariance)) {
        // Its partner knows where it must be: believed there until the image says otherwise.
        track.X_TP = track.X_TP_free = *carried;
        track.covariance = track.covariance_free = covariance;
        track.status = PartStatus::kOccluded;
      } else {
        Coast(PartStatus::kLost, dt, options_.track, track);
      }
    }
    if (track.alive()) UpdateTrack(part, ViewFor(part, observation), dt);
  }
  Recover(observation);
  FindOnTable(observation);
  for (size_t k = 0; k < tracks_.size(); ++k) Settle(before[k], dt, options_.track, tracks_[k]);
  RepairIdentities(observation);
  foreign_.Find(observation, owners_, camera_.X_TC(), area_, dt);
  ++steps_;
  Output(input);
  return output_;
}

void FullFilter::OrderParts() {
  order_.resize(tracks_.size());
  std::iota(order_.begin(), order_.end(), 0);
  const auto seen = [&](int part) { return tracks_[part].visible_fraction * tracks_[part].confidence; };
  std::sort(order_.begin(), order_.end(),
            [&](int a, int b) { return seen(a) > seen(b) || (seen(a) == seen(b) && a < b); });
}

void FullFilter::LocateCamera(const Observation& observation) {
  if (camera_.started()) {
    if (options_.follow_camera) camera_.Step(observation, owners_);
    return;
  }
  const auto table = FindTable(observation, seed_, options_.table);
  if (table) camera_.Start(observation, *table);
}

void FullFilter::BuildOwners(const Observation& observation, double dt) {
  owners_.Clear();
  const Pose X_CT = camera_.X_TC().inverse();
  for (size_t k = 0; k < tracks_.size(); ++k) {
    tiles_[k].width = tiles_[k].height = 0;
    tiles_[k].depth.clear();
    if (!tracks_[k].alive()) continue;
    RenderTile(ShapeOf(static_cast<int>(k)).model, observation.camera, X_CT * PredictPose(tracks_[k], dt),
               OwnerMap::kStep, 0, tiles_[k]);
    if (tracks_[k].status == PartStatus::kTracked) owners_.Add(static_cast<int>(k), tiles_[k]);
  }
}

void FullFilter::Place(int part, const Observation& observation) {
  owners_.Remove(part, tiles_[part]);
  RenderTile(ShapeOf(part).model, observation.camera, camera_.X_TC().inverse() * tracks_[part].X_TP, OwnerMap::kStep, 0,
             tiles_[part]);
  if (tracks_[part].status == PartStatus::kTracked && tracks_[part].bad == 0) owners_.Add(part, tiles_[part]);
}

std::optional<Pose> FullFilter::BestParticle(int part, const Observation& observation, const Pose& predicted,
                                             const Pose& rest, const Pose& refined, double dt) {
  const Track& track = tracks_[part];
  const Shape& shape = ShapeOf(part);
  std::normal_distribution<double> normal;
  const double speed = track.velocity.head<3>().norm(), turn = track.velocity.tail<3>().norm();
  const double position = track.moving ? 0.006 + 0.6 * speed * dt + 0.3 * dt : 0.004;
  const double rotation = track.moving ? 0.06 + 0.6 * turn * dt + 1.0 * dt : 0.04;
  const Pose X_CT = camera_.X_TC().inverse();
  // Only a particle that is clearly better than what refinement found is worth refining itself.
  SelectVisible(shape.model, refined, scratch_.visible, options_.particle_points, particle_points_);
  const float refined_score = ScoreVisible(particle_points_, observation, owners_, part, bit_of_part_[part], refined);
  float best_score = refined_score + 0.05f * std::abs(refined_score);
  std::optional<Pose> best;
  for (int i = 1; i < options_.particles; ++i) {
    Vector6 xi;
    const double wide = i % 4 == 0 ? 3.0 : 1.0;  // heavy tails
    for (int d = 0; d < 6; ++d) xi[d] = normal(rng_) * wide * (d < 3 ? position : rotation);
    const Pose X = X_CT * Perturb(i % 2 ? predicted : rest, xi);
    const float score = ScoreVisible(particle_points_, observation, owners_, part, bit_of_part_[part], X);
    if (score > best_score) {
      best_score = score;
      best = X;
    }
  }
  return best;
}

void FullFilter::UpdateTrack(int part, const Observation& observation, double dt) {
  Track& track = tracks_[part];
  const Shape& shape = ShapeOf(part);
  const Pose X_CT = camera_.X_TC().inverse();
  const Pose coasted = PredictPose(track, dt);
  const Pose predicted = followed_[part].value_or(coasted);
  const uint8_t bit = bit_of_part_[part];
  Matrix6 carried_covariance;
  const std::optional<Pose> carried = CarriedBy(part, carried_covariance);
  PoseCandidate best =
      Polish(shape.model, observation, owners_, part, bit, X_CT * predicted, options_.refinement, scratch_);
  // Between likely poses the expected one wins: another may be the empty place of an equal part, or one of the turns
  // that look almost the same when little is seen. The likelihood counts neighbouring pixels as witnesses of their own,
  // so the prior is measured in shares of it.
  // A part that lay still before it was covered still does, as far as what is left of it can tell.
  const bool resting = !carried && track.X_TP_rest && best.visible_fraction() < options_.track.rest_visible;
  const Pose expected = X_CT * (carried ? *carried : resting ? *track.X_TP_rest : predicted);
  const double reach = carried   ? options_.link_reach
                       : resting ? options_.rest_reach
                                 : 0.03 + 0.5 * track.velocity.head<3>().norm() * dt;
  const double turn = carried ? options_.link_turn : resting ? options_.rest_turn : track.moving ? 0.7 : 0.4;
  const auto posterior = [&](const PoseCandidate& c) {
    const double no_edge = options_.outline_cost * (1 - c.outline_support()) * std::abs(c.score.log_likelihood);
    return c.score.log_likelihood - no_edge - JumpCost(expected, reach, turn, c) - CollisionCost(part, c);
  };
  const auto consider = [&](const Pose& X_CP, const RefinementOptions& refinement) {
    const PoseCandidate c = Polish(shape.model, observation, owners_, part, bit, X_CP, refinement, scratch_);
    if (posterior(c) > posterior(best)) best = c;
  };
  const Pose first = best.X_CP;
  if (const auto particle = BestParticle(part, observation, predicted, track.X_TP, best.X_CP, dt))
    consider(*particle, options_.refinement);
  const Pose rest = X_CT * track.X_TP;
  if (followed_[part]) consider(X_CT * coasted, options_.refinement);
  if (track.moving && StepLength(Difference(first, rest), 0.05) > 0.004) consider(rest, options_.refinement);
  if (carried || resting) {
    const Vector6 away = Difference(best.X_CP, expected);
    if (StepLength(away, 0.05) > 0.004) consider(expected, resting ? options_.rest_refinement : options_.refinement);
  }
  if (carried) DropEmptyLinks(part, observation);
  if (resting && StepLength(Difference(best.X_CP, expected), 0.05) > options_.rest_left) track.X_TP_rest.reset();
  TestRivals(part, observation, dt, carried ? &expected : nullptr, best);
  const double in_image = InImageFraction(shape.model, observation.camera, best.X_CP);
  const double open = best.full_samples > 0 ? best.score.open() / best.full_samples : 0;
  if (!observation.depth && !observation.class_map) {
    Coast(PartStatus::kOccluded, dt, options_.track, track);
  } else if (in_image < 0.15) {
    Coast(PartStatus::kOutOfView, dt, options_.track, track);
  } else if (open < options_.track.least_open) {
    Coast(PartStatus::kOccluded, dt, options_.track, track);
  } else if (Believable(best, options_.track) && (track.moving || InReach(camera_.X_TC() * best.X_CP.translation()))) {
    Fuse(best, camera_.X_TC(), dt, options_.track, track);
  } else {
    const int bad = track.bad + 1;
    Coast(bad >= options_.track.bad_frames ? PartStatus::kLost : track.status, dt, options_.track, track);
    track.bad = bad;
  }
  if (carried) {
    if (track.missing()) {
      // Not seen: it is where its partner takes it.
      track.X_TP = *carried;
      track.covariance = carried_covariance;
      track.X_TP_free = track.X_TP;
      track.covariance_free = track.covariance;
      if (track.status == PartStatus::kLost) track.status = PartStatus::kOccluded;
    } else {
      Constrain(*carried, carried_covariance, track);
    }
  }
  updated_[part] = !track.missing() || carried;
  Place(part, observation);
}

double FullFilter::JumpCost(const Pose& expected, double reach, double turn, const PoseCandidate& candidate) const {
  const Vector6 away = Difference(expected, candidate.X_CP);
  const double distance = away.head<3>().squaredNorm() / (reach * reach) + away.tail<3>().squaredNorm() / (turn * turn);
  return std::max(options_.least_jump_cost, options_.jump_cost * candidate.score.log_likelihood) *
         std::min(3.0, distance);
}

double FullFilter::CollisionCost(int part, const PoseCandidate& candidate) const {
  const Pose X_TP = camera_.X_TC() * candidate.X_CP;
  double overlap = 0;
  for (size_t k = 0; k < tracks_.size(); ++k) {
    // What is joined overlaps a little, as measured.
    const int other = static_cast<int>(k);
    if (other == part || tracks_[k].missing() || InJoint(part, X_TP, other)) continue;
    overlap += pairs_.Overlap(part, X_TP, other, tracks_[k].X_TP, options_.allowed_overlap);
  }
  return std::min(1.0, overlap / options_.full_overlap) * options_.collision_cost *
         std::abs(candidate.score.log_likelihood);
}

void FullFilter::RepairIdentities(const Observation& observation) {
  for (Track& track : tracks_) {
    track.exchanged_with = track.ambiguous_with = -1;
    track.ambiguous_probability = 0;
  }
  for (size_t i = 0; i < tracks_.size(); ++i) {
    for (size_t j = i + 1; j < tracks_.size(); ++j) {
      Track &a = tracks_[i], &b = tracks_[j];
      if (task_.parts[i].type != task_.parts[j].type || a.missing() || b.missing()) continue;
      if (a.settled_for > options_.track.settle_time && b.settled_for > options_.track.settle_time) continue;
      // If only one of the two was moved, keeping the names is the shorter way by the triangle inequality.
      const auto way = [](const Track& from, const Track& to) {
        return (from.anchor.translation() - to.X_TP.translation()).norm();
      };
      const double kept = way(a, a) + way(b, b), exchanged = way(a, b) + way(b, a);
      if (exchanged + options_.exchange_margin <= kept) Exchange(static_cast<int>(i), static_cast<int>(j), observation);
      // Half the margin as the unit of a logistic law: by how much a hand may have gone farther than it had to.
      const double probability = 1 / (1 + std::exp(2 * std::abs(kept - exchanged) / options_.exchange_margin));
      for (const auto& [track, other] : {std::pair(&a, j), std::pair(&b, i)}) {
        if (probability <= std::max(0.02, track->ambiguous_probability)) continue;
        track->ambiguous_probability = probability;
        track->ambiguous_with = static_cast<int>(other);
      }
    }
  }
}

void FullFilter::Exchange(int i, int j, const Observation& observation) {
  Track &a = tracks_[i], &b = tracks_[j];
  std::swap(a, b);
  std::swap(a.anchor, b.anchor);
  for (Track* track : {&a, &b}) {
    const SymmetryGroup& symmetries = ShapeOf(i).model.symmetries;
    track->X_TP = NearestEquivalent(symmetries, track->X_TP, track->anchor);
    track->X_TP_free = NearestEquivalent(symmetries, track->X_TP_free, track->anchor);
  }
  a.exchanged_with = j;
  b.exchanged_with = i;
  owners_.Remove(i, tiles_[i]);
  owners_.Remove(j, tiles_[j]);
  Place(i, observation);
  Place(j, observation);
}

void FullFilter::TestRivals(int part, const Observation& observation, double dt, const Pose* linked_X_CP,
                            PoseCandidate& best) {
  Track& track = tracks_[part];
  const Shape& shape = ShapeOf(part);
  const auto value = [&](const PoseCandidate& c) {
    return c.score.log_likelihood - CollisionCost(part, c) -
           (linked_X_CP ? JumpCost(*linked_X_CP, options_.link_reach, options_.link_turn, c) : 0);
  };
  const size_t n = shape.model.near_symmetries.size();
  track.rival.resize(n, 0.0f);
  track.seen_for = track.missing() ? 0 : track.seen_for + dt;
  if (track.missing()) std::fill(track.rival.begin(), track.rival.end(), 0.0f);
  if (n == 0 || !options_.test_rivals || best.score.open() < options_.rival_open * best.full_samples ||
      best.score.open() < 30)
    return;
  // In turn; more often while the part was seen for less than a second.
  const bool settled = track.seen_for > 1.0;
  if (settled && (steps_ + part) % 4 != 0) return;
  const int tests = std::min(static_cast<int>(n), settled ? 1 : 3);
  for (int i = 0; i < tests; ++i) {
    const size_t which = static_cast<size_t>(track.next_rival++) % n;
    const PoseCandidate c = Polish(shape.model, observation, owners_, part, bit_of_part_[part],
                                   best.X_CP * shape.model.near_symmetries[which], options_.refinement, scratch_);
    // Small but lasting differences decide: pixels are no independent witnesses, frames nearly are.
    const double gain = value(c) - value(best);
    const double unit = std::max(60.0, options_.rival_gain * std::abs(best.score.log_likelihood));
    track.rival[which] = static_cast<float>(std::clamp(track.rival[which] + gain / unit - 0.5, -4.0, 3.0));
    if (track.rival[which] < 1.5f) continue;
    best = c;
    std::fill(track.rival.begin(), track.rival.end(), -1.0f);
    track.seen_for = 0;
    return;
  }
}

void FullFilter::Output(const FilterInput& input) {
  output_.utime = input.utime;
  output_.received_utime = input.received_utime;
  output_.sequence = input.sequence;
  output_.X_TC = camera_.X_TC();
  output_.X_TC_covariance = camera_.covariance();
  output_.table_found = camera_.table_seen();
  output_.table_residual = camera_.table().residual;
  output_.parts.clear();
  for (const Track& track : tracks_) output_.parts.push_back(Publish(track, options_.track));
  pairs_.Find(input.utime, tracks_, output_.pairs);
  output_.foreign = foreign_.blobs();
}

}  // namespace coach
