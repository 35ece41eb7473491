#include "services/pose_filter/full_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace coach {

ParallelFor SerialFor() {
  return [](int n, const std::function<void(int)>& body) {
    for (int i = 0; i < n; ++i) body(i);
  };
}

FullFilter::FullFilter(const Task& task, const FullFilterOptions& options, uint64_t seed, ParallelFor parallel_for)
    : task_(task), options_(options), seed_(seed), parallel_for_(std::move(parallel_for)), camera_(options.camera) {
  for (const PartType& type : task_.types) {
    auto shape = std::make_unique<Shape>();
    shape->model = MakePartModel(type);
    shape->search_points = MakePointSet(shape->model, options.search.points);
    shape->particle_points = MakePointSet(shape->model, options.particle_points);
    shapes_.push_back(std::move(shape));
  }
  for (const Part& part : task_.parts) {
    class_of_part_.push_back(task_.ColourClass(part.type));
    bit_of_part_.push_back(static_cast<uint8_t>(1u << class_of_part_.back()));
  }
  Reset();
}

void FullFilter::Reset() {
  rng_.seed(seed_);
  last_utime_ = 0;
  steps_ = 0;
  camera_.Reset();
  distractors_ = Distractors();
  tracks_.assign(task_.parts.size(), Track());
  tiles_.assign(task_.parts.size(), DepthTile());
  suggested_.clear();
  owners_.Clear();
}

void FullFilter::Suggest(const std::vector<Pose>& X_CP) {
  if (X_CP.size() == task_.parts.size()) suggested_ = X_CP;
}

PartPoses FullFilter::Step(const FilterInput& input) {
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
  if (input.detections && input.detections->class_map.size() == static_cast<size_t>(size.area()))
    observation.class_map = input.detections->class_map.data();
  // Time that stands still or jumps back is no time at all; a long gap is as good as a second.
  const double dt =
      steps_ == 0 ? 1.0 / 30 : std::clamp(static_cast<double>(input.utime - last_utime_) * 1e-6, 1e-3, 1.0);
  last_utime_ = input.utime;

  LocateCamera(observation);
  observation.has_table = camera_.started();
  observation.table = PlaneOf(camera_.X_TC());
  BuildOwners(observation, dt);
  std::vector<int> order(tracks_.size());
  std::iota(order.begin(), order.end(), 0);
  const Pose X_CT = camera_.X_TC().inverse();
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const double za = (X_CT * tracks_[a].X_TP.translation()).z(), zb = (X_CT * tracks_[b].X_TP.translation()).z();
    return za != zb ? za < zb : a < b;
  });
  for (const int part : order) {
    if (tracks_[part].alive())
      UpdateTrack(part, observation, dt);
    else if (tracks_[part].status == PartStatus::kLost)
      Coast(PartStatus::kLost, dt, options_.track, tracks_[part]);
  }
  Recover(observation);
  suggested_.clear();
  ++steps_;
  return Output(input);
}

void FullFilter::LocateCamera(const Observation& observation) {
  if (camera_.started()) {
    camera_.Step(observation, owners_);
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

Pose FullFilter::BestParticle(int part, const Observation& observation, const Pose& predicted, const Pose& rest,
                              double dt) {
  const Track& track = tracks_[part];
  const Shape& shape = ShapeOf(part);
  std::normal_distribution<double> normal;
  const double speed = track.velocity.head<3>().norm(), turn = track.velocity.tail<3>().norm();
  const double position = track.moving ? 0.006 + 0.6 * speed * dt + 0.3 * dt : 0.004;
  const double rotation = track.moving ? 0.06 + 0.6 * turn * dt + 1.0 * dt : 0.04;
  const Pose X_CT = camera_.X_TC().inverse();
  Pose best = X_CT * predicted;
  float best_score = ScorePoints(shape.particle_points, observation, owners_, part, bit_of_part_[part], best);
  for (int i = 1; i < options_.particles; ++i) {
    Vector6 xi;
    const double wide = i % 4 == 0 ? 3.0 : 1.0;  // heavy tails
    for (int d = 0; d < 6; ++d) xi[d] = normal(rng_) * wide * (d < 3 ? position : rotation);
    const Pose X = X_CT * Perturb(i % 2 ? predicted : rest, xi);
    const float score = ScorePoints(shape.particle_points, observation, owners_, part, bit_of_part_[part], X);
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
  const Pose predicted = PredictPose(track, dt);
  const uint8_t bit = bit_of_part_[part];
  PoseCandidate best =
      Polish(shape.model, observation, owners_, part, bit, X_CT * predicted, options_.refinement, scratch_);
  const auto consider = [&](const Pose& X_CP) {
    const PoseCandidate c = Polish(shape.model, observation, owners_, part, bit, X_CP, options_.refinement, scratch_);
    if (c.score.log_likelihood > best.score.log_likelihood) best = c;
  };
  const Pose particle = BestParticle(part, observation, predicted, track.X_TP, dt);
  const Vector6 away = Difference(best.X_CP, particle);
  if (best.score.agreement() < 0.9 || away.head<3>().norm() > 0.015) consider(particle);
  if (track.moving) consider(X_CT * track.X_TP);
  // One of the poses that look almost the same, in turn: a slip is noticed within a few frames.
  if (!shape.model.near_symmetries.empty() && best.score.open() > 30) {
    Pose X = best.X_CP;
    X.linear() =
        X.linear() * shape.model.near_symmetries[static_cast<size_t>(steps_) % shape.model.near_symmetries.size()];
    consider(X);
  }
  const double in_image = InImageFraction(shape.model, observation.camera, best.X_CP);
  const double open = best.full_samples > 0 ? best.score.open() / best.full_samples : 0;
  if (!observation.depth && !observation.class_map) {
    Coast(PartStatus::kOccluded, dt, options_.track, track);
  } else if (in_image < 0.15) {
    Coast(PartStatus::kOutOfView, dt, options_.track, track);
  } else if (open < options_.track.least_open) {
    Coast(PartStatus::kOccluded, dt, options_.track, track);
  } else if (best.score.agreement() >= options_.track.least_agreement) {
    Fuse(best, camera_.X_TC(), dt, options_.track, track);
  } else {
    const int bad = track.bad + 1;
    Coast(bad >= options_.track.bad_frames ? PartStatus::kLost : track.status, dt, options_.track, track);
    track.bad = bad;
  }
  Place(part, observation);
}

void FullFilter::Recover(const Observation& observation) {
  if (!observation.class_map || !observation.depth) return;
  const bool any = std::any_of(tracks_.begin(), tracks_.end(), [](const Track& t) { return t.missing(); });
  if (!any) {
    if (steps_ % 5 == 0) {
      const auto& blobs =
          blob_finder_.FindUnexplained(observation, owners_, class_of_part_, task_.NumColourClasses(), camera_.X_TC());
      distractors_.Remember(blobs, camera_.X_TC());
    }
    return;
  }
  int left = steps_ < 3 ? 1000 : options_.searches;
  for (size_t round = 0; round < tracks_.size() && left > 0; ++round) {
    const auto& blobs =
        blob_finder_.FindUnexplained(observation, owners_, class_of_part_, task_.NumColourClasses(), camera_.X_TC());
    int best_part = -1;
    PoseCandidate best;
    double best_gain = options_.relocation_gain;
    for (const Blob& blob : blobs) {
      if (distractors_.Known(blob, camera_.X_TC())) continue;
      std::vector<int> tried_types;
      for (size_t k = 0; k < tracks_.size() && left > 0; ++k) {
        if (!tracks_[k].missing() || class_of_part_[k] != blob.colour_class) continue;
        const int type = task_.parts[k].type;
        if (std::find(tried_types.begin(), tried_types.end(), type) != tried_types.end()) continue;
        tried_types.push_back(type);
        --left;
        const auto found =
            SearchPose(ShapeOf(static_cast<int>(k)).model, ShapeOf(static_cast<int>(k)).search_points, observation,
                       owners_, static_cast<int>(k), bit_of_part_[k], blob, camera_.X_TC(), options_.search, scratch_);
        if (!found || found->score.log_likelihood <= best_gain) continue;
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
    Restart(best, camera_.X_TC(), tracks_[chosen]);
    Place(chosen, observation);
  }
}

PartPoses FullFilter::Output(const FilterInput& input) const {
  PartPoses out;
  out.utime = input.utime;
  out.received_utime = input.received_utime;
  out.sequence = input.sequence;
  out.X_TC = camera_.X_TC();
  out.X_TC_covariance = camera_.covariance();
  out.table_found = camera_.table_seen();
  out.table_residual = camera_.table().residual;
  for (const Track& track : tracks_) out.parts.push_back(Publish(track, options_.track));
  return out;
}

}  // namespace coach
