#include "services/pose_filter/paper_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "services/pose_filter/particle_weights.h"
#include "services/pose_filter/table_plane.h"

namespace coach {
namespace {

constexpr double kStepsPerSecond = 30;

void Check(const PaperFilterOptions& o) {
  const auto need = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("paper filter options: ") + what);
  };
  need(o.particles >= 2 && o.particles <= 100000, "particles must be in 2..100000");
  need(o.step >= 1 && o.step <= 64, "step must be in 1..64 px");
  need(o.constraint_cap >= 0 && o.constraint_cap <= 1, "constraint_cap must be in 0..1");
  need(o.collision.factor > 0 && o.collision.factor <= 1, "collision.factor must be in (0, 1]");
}

/// A depth image that fits the camera, or an empty one.
cv::Mat UsableDepth(const FilterInput& input) {
  const bool usable = input.depth.type() == CV_16UC1 && input.depth.cols == input.camera.width &&
                      input.depth.rows == input.camera.height && input.metres_per_unit > 0 &&
                      std::isfinite(input.metres_per_unit);
  return usable ? input.depth : cv::Mat();
}

}  // namespace

PaperFilter::PaperFilter(const Task& task, const PaperFilterOptions& options, uint64_t seed)
    : task_(task), options_(options), seed_(seed), model_(options.observation, OcclusionForm::kPaper), random_(seed) {
  Check(options);
  for (const PartType& type : task.types) {
    if (type.mesh.triangles.empty()) throw std::invalid_argument("part type " + type.name + " has no mesh");
    shapes_.push_back({RenderMesh(type.mesh), CollisionShape(type.mesh)});
  }
  Reset();
}

void PaperFilter::Reset() {
  const size_t parts = task_.parts.size();
  random_ = Random(seed_);
  known_.assign(parts, false);
  base_.assign(parts, Pose::Identity());
  rate_.assign(parts, Vector6::Zero());
  Particle particle;
  particle.parts.resize(parts);
  particle.tiles.resize(parts);
  particles_.assign(static_cast<size_t>(options_.particles), particle);
  resampled_ = particles_;
  log_weights_.assign(particles_.size(), 0.0);
  weights_.assign(particles_.size(), 1.0 / static_cast<double>(particles_.size()));
  evidence_ = {};
  X_TC_.reset();
  suggested_.clear();
  last_search_.reset();
  started_ = false;
}

void PaperFilter::Suggest(const std::vector<Pose>& X_CP) { suggested_ = X_CP; }

const PartPoses& PaperFilter::Step(const FilterInput& input) {
  const double dt = started_ ? static_cast<double>(input.utime - last_utime_) * 1e-6 : 1 / kStepsPerSecond;
  last_utime_ = input.utime;
  started_ = true;
  if (input.camera.Problem().empty()) {
    TakeImage(input);
    AssociateAndSteer(input);
    FindAbsentParts(input);
    const OcclusionStep occlusion = PredictOcclusion(options_.occlusion, std::max(0.0, dt));
    for (Particle& particle : particles_) {
      for (float& o : particle.occlusion) o = occlusion(o);
      particle.log_likelihood = 0;
    }
    ChooseLinks();
    for (size_t part = 0; part < task_.parts.size(); ++part) {
      if (known_[part]) MovePart(part, dt);
    }
    Finish();
  }
  output_ = Output(input);
  return output_;
}

void PaperFilter::TakeImage(const FilterInput& input) {
  const bool changed = !(camera_ == input.camera) || evidence_.z.empty();
  camera_ = input.camera;
  const PixelGrid grid = SampledGrid(camera_, options_.step);
  model_.Prepare(UsableDepth(input), input.metres_per_unit, grid, evidence_);
  if (!changed) return;
  for (Particle& particle : particles_) {
    particle.occlusion.assign(evidence_.z.size(), static_cast<float>(options_.occlusion.initial));
    for (size_t part = 0; part < task_.parts.size(); ++part) {
      if (known_[part]) RenderDepth(ShapeOf(part).mesh, grid, PoseOf(particle, part), particle.tiles[part]);
    }
  }
}

void PaperFilter::AssociateAndSteer(const FilterInput& input) {
  const size_t parts = task_.parts.size();
  regions_.assign(parts, {});
  seen_.assign(parts, std::nullopt);
  class_map_.clear();
  if (input.detections == nullptr) return;
  if (options_.colour == ColourUse::kObservation && input.detections->width == camera_.width &&
      input.detections->height == camera_.height) {
    class_map_ = input.detections->class_map;
  }
  std::vector<std::optional<Eigen::Vector2d>> expected(parts);
  for (size_t part = 0; part < parts; ++part) {
    if (known_[part] && base_[part].translation().z() > kNearPlane) {
      expected[part] = camera_.Project(base_[part].translation());
    }
  }
  regions_ = AssignRegions(task_, *input.detections, expected);
  for (size_t part = 0; part < parts; ++part) {
    if (!known_[part] || regions_[part].region < 0) continue;
    const Region& region = input.detections->regions[static_cast<size_t>(regions_[part].region)];
    if (!(region.median_depth > kNearPlane)) continue;
    const Vector3 seen = camera_.BackProject(region.centroid.cast<double>(), region.median_depth);
    seen_[part] = seen + SurfaceToOrigin(part);
  }
}

/// From the middle of the part's visible surface to its origin, at the last estimate.
Vector3 PaperFilter::SurfaceToOrigin(size_t part) {
  const PixelGrid& grid = evidence_.grid;
  RenderDepth(ShapeOf(part).mesh, grid, base_[part], tile_);
  Vector3 sum = Vector3::Zero();
  int points = 0;
  for (int j = 0; j < tile_.area.height; ++j) {
    for (int i = 0; i < tile_.area.width; ++i) {
      const double z = tile_.row(j)[i];
      if (z >= RenderedDepth::kEmpty) continue;
      sum += z * Vector3((tile_.area.x + i - grid.cx) / grid.fx, (tile_.area.y + j - grid.cy) / grid.fy, 1);
      ++points;
    }
  }
  return points == 0 ? Vector3(Vector3::Zero()) : Vector3(base_[part].translation() - sum / points);
}

void PaperFilter::FindAbsentParts(const FilterInput& input) {
  const bool search =
      std::find(known_.begin(), known_.end(), false) != known_.end() &&
      (!last_search_ || input.utime - *last_search_ >= static_cast<int64_t>(options_.start_interval * 1e6));
  const cv::Mat depth = UsableDepth(input);
  if (depth.empty()) return;
  for (size_t part = 0; part < std::min(suggested_.size(), known_.size()); ++part) {
    const Pose& X_CP = suggested_[part];
    if (known_[part] || !X_CP.matrix().allFinite()) continue;
    RenderDepth(ShapeOf(part).mesh, evidence_.grid, X_CP, tile_);
    if (model_.LogLikelihood(evidence_, tile_, static_cast<float>(options_.occlusion.initial)) > 0) Place(part, X_CP);
  }
  suggested_.clear();
  if (!search) return;
  last_search_ = input.utime;
  const SceneClusters clusters =
      FindClusters(depth, input.metres_per_unit, camera_, random_.Bits(), options_.initialisation);
  if (!X_TC_ && clusters.table) X_TC_ = TableFrame(*clusters.table);
  for (size_t part = 0; part < known_.size(); ++part) {
    if (known_[part] || regions_[part].region < 0) continue;
    const Region& region = input.detections->regions[static_cast<size_t>(regions_[part].region)];
    const auto points = PointsOfRegion(clusters, *input.detections, region, options_.initialisation);
    const auto fit = FitPose(task_.TypeOf(static_cast<int>(part)).mesh, ShapeOf(part).mesh, points, model_, evidence_,
                             random_, options_.initialisation);
    if (fit) Place(part, fit->X_CP);
  }
}

void PaperFilter::Place(size_t part, const Pose& X_CP) {
  known_[part] = true;
  base_[part] = X_CP;
  for (Particle& particle : particles_) {
    particle.parts[part] = {};
    RenderDepth(ShapeOf(part).mesh, evidence_.grid, X_CP, particle.tiles[part]);
  }
}

void PaperFilter::ChooseLinks() {
  links_ = FindLinks(task_, base_, known_);
  bodies_.clear();
  for (size_t n = 0; n <= links_.size(); ++n) bodies_.emplace_back(static_cast<int>(task_.parts.size()), links_, n);
  // Levels spread evenly, in random order: neighbours may be copies of one particle.
  std::vector<size_t> order(particles_.size());
  std::iota(order.begin(), order.end(), size_t{0});
  for (size_t i = order.size(); i > 1; --i) {
    std::swap(order[i - 1], order[static_cast<size_t>(random_.Below(static_cast<int>(i)))]);
  }
  for (size_t i = 0; i < particles_.size(); ++i) {
    const double level = (static_cast<double>(order[i]) + 0.5) / static_cast<double>(particles_.size());
    particles_[i].links = NumEnforced(links_, level, options_.constraint_cap);
  }
}

void PaperFilter::MovePart(size_t part, double dt) {
  const auto render = [this](Particle& particle, size_t moved) {
    RenderDepth(ShapeOf(moved).mesh, evidence_.grid, PoseOf(particle, moved), particle.tiles[moved]);
  };
  // [6]
  Vector3 u = Vector3::Zero();
  if (options_.colour == ColourUse::kInput && seen_[part])
    u = (*seen_[part] - base_[part].translation()) * regions_[part].confidence;
  for (size_t i = 0; i < particles_.size(); ++i) {
    Particle& particle = particles_[i];
    const RigidBodies& bodies = bodies_[particle.links];
    if (!bodies.Leads(static_cast<int>(part))) continue;
    Propagate(options_.process, dt, random_, particle.parts[part]);
    particle.parts[part].q.head<3>() += u;
    render(particle, part);
    for (const auto& follower : bodies.FollowersOf(static_cast<int>(part))) {
      const auto f = static_cast<size_t>(follower.part), l = static_cast<size_t>(follower.leader);
      const Pose X_CL = PoseOf(particle, l), X_CF = X_CL * follower.X_LF;
      particle.parts[f].q = Difference(base_[f], X_CF);
      // One body: the same turning, and the velocity of the follower's origin.
      const Vector6& v = particle.parts[l].v;
      const Vector3 turning = v.tail<3>(), arm = X_CF.translation() - X_CL.translation();
      particle.parts[f].v << v.head<3>() + turning.cross(arm), turning;
      render(particle, f);
    }
    const double log_likelihood = LogLikelihood(particle);
    log_weights_[i] += log_likelihood - particle.log_likelihood;
    particle.log_likelihood = log_likelihood;
  }
  NormaliseWeights(log_weights_, weights_);
  for (size_t i = 0; i < weights_.size(); ++i) log_weights_[i] = std::log(std::max(weights_[i], 1e-300));
  if (DivergenceFromUniform(weights_) > options_.resample_divergence) Resample();
}

/// The nearest surface of all parts.
const RenderedDepth& PaperFilter::Merge(const Particle& particle) {
  int left = evidence_.grid.width, top = evidence_.grid.height, right = 0, bottom = 0;
  for (size_t part = 0; part < known_.size(); ++part) {
    const GridRectangle& area = particle.tiles[part].area;
    if (!known_[part] || area.empty()) continue;
    left = std::min(left, area.x);
    top = std::min(top, area.y);
    right = std::max(right, area.x + area.width);
    bottom = std::max(bottom, area.y + area.height);
  }
  merged_.Reset(left < right ? GridRectangle{left, top, right - left, bottom - top} : GridRectangle{});
  for (size_t part = 0; part < known_.size(); ++part) {
    if (known_[part]) MergeNearer(particle.tiles[part], merged_);
  }
  return merged_;
}

double PaperFilter::LogLikelihood(const Particle& particle) {
  const double image =
      model_.LogLikelihood(evidence_, Merge(particle), particle.occlusion.data()) + ColourLogLikelihood(particle);
  return AnyOverlap(particle) ? image + std::log(options_.collision.factor) : image;
}

double PaperFilter::ColourLogLikelihood(const Particle& particle) const {
  if (class_map_.empty()) return 0;
  double sum = 0;
  for (size_t part = 0; part < known_.size(); ++part) {
    if (!known_[part]) continue;
    const RenderedDepth& tile = particle.tiles[part];
    const int bit = 1 << task_.ColourClass(task_.parts[part].type);
    for (int j = 0; j < tile.area.height; ++j) {
      const int row = tile.area.y + j;
      const float* nearest = merged_.row(row - merged_.area.y) + (tile.area.x - merged_.area.x);
      for (int i = 0; i < tile.area.width; ++i) {
        if (tile.row(j)[i] >= RenderedDepth::kEmpty || tile.row(j)[i] > nearest[i]) continue;
        const int column = tile.area.x + i;
        const bool own = class_map_[static_cast<size_t>(evidence_.grid.ImageY(row)) * camera_.width +
                                    static_cast<size_t>(evidence_.grid.ImageX(column))] &
                         bit;
        const double o = particle.occlusion[static_cast<size_t>(row * evidence_.stride + column)];
        const double visible = own ? options_.own_colour : 1 - options_.own_colour;
        const double other = own ? options_.foreign_colour : 1 - options_.foreign_colour;
        sum += std::log((1 - o) * visible / other + o);
      }
    }
  }
  return sum;
}

bool PaperFilter::AnyOverlap(const Particle& particle) const {
  if (options_.collision.factor == 1) return false;
  for (size_t a = 0; a < known_.size(); ++a) {
    if (!known_[a]) continue;
    const Pose X_CA = PoseOf(particle, a);
    for (size_t b = a + 1; b < known_.size(); ++b) {
      if (!known_[b]) continue;
      const bool linked = std::any_of(links_.begin(), links_.end(), [&](const RigidLink& link) {
        return link.part_a == static_cast<int>(a) && link.part_b == static_cast<int>(b);
      });
      const double allowed = linked ? options_.collision.allowed_connected : options_.collision.allowed;
      if (Overlap(ShapeOf(a).solid, X_CA, ShapeOf(b).solid, PoseOf(particle, b), allowed)) return true;
    }
  }
  return false;
}

void PaperFilter::Resample() {
  SystematicResample(weights_, random_, parents_);
  // The first copy of a particle takes its memory, the others copy it.
  first_copy_.assign(particles_.size(), -1);
  for (size_t i = 0; i < parents_.size(); ++i) {
    int& first = first_copy_[static_cast<size_t>(parents_[i])];
    if (first < 0) {
      first = static_cast<int>(i);
      std::swap(resampled_[i], particles_[static_cast<size_t>(parents_[i])]);
    } else {
      resampled_[i] = resampled_[static_cast<size_t>(first)];
    }
  }
  std::swap(particles_, resampled_);
  weights_.assign(weights_.size(), 1.0 / static_cast<double>(weights_.size()));
  log_weights_.assign(log_weights_.size(), -std::log(static_cast<double>(weights_.size())));
}

void PaperFilter::Finish() {
  for (Particle& particle : particles_) {
    model_.UpdateOcclusion(evidence_, Merge(particle), particle.occlusion.data());
  }
  // [3], and the particles about their mean.
  for (size_t part = 0; part < known_.size(); ++part) {
    if (!known_[part]) continue;
    Vector6 mean = Vector6::Zero();
    rate_[part].setZero();
    for (size_t i = 0; i < particles_.size(); ++i) {
      mean += weights_[i] * particles_[i].parts[part].q;
      rate_[part] += weights_[i] * particles_[i].parts[part].v;
    }
    const Pose estimate = Perturb(base_[part], mean);
    for (Particle& particle : particles_) particle.parts[part].q = Difference(estimate, PoseOf(particle, part));
    base_[part] = estimate;
  }
}

PartPoses PaperFilter::Output(const FilterInput& input) {
  PartPoses out;
  out.utime = input.utime;
  out.received_utime = input.received_utime;
  out.sequence = input.sequence;
  out.X_TC = X_TC_.value_or(Pose::Identity());
  out.table_found = X_TC_.has_value();
  for (size_t part = 0; part < known_.size(); ++part) {
    out.parts.push_back(known_[part] ? Describe(part, out.X_TC) : PartEstimate{});
  }
  return out;
}

PartEstimate PaperFilter::Describe(size_t part, const Pose& X_TC) {
  PartEstimate estimate;
  const Matrix3& R_TC = X_TC.linear();
  estimate.X_TP = X_TC * base_[part];
  estimate.velocity << R_TC * rate_[part].head<3>(), R_TC * rate_[part].tail<3>();
  estimate.velocity *= kStepsPerSecond;
  Matrix6 covariance = Matrix6::Zero();
  for (size_t i = 0; i < particles_.size(); ++i) {
    const Vector6& q = particles_[i].parts[part].q;
    covariance += weights_[i] * q * q.transpose();
  }
  estimate.covariance = RotateCovariance(R_TC, covariance);
  if (options_.colour == ColourUse::kFusedPoses) FuseColour(part, X_TC, estimate);

  RenderDepth(ShapeOf(part).mesh, evidence_.grid, base_[part], tile_);
  const PointCounts points = CountPoints(evidence_, tile_);
  if (points.predicted == 0) {
    estimate.status = PartStatus::kOutOfView;
    return estimate;
  }
  constexpr double kSeen = 0.15;
  estimate.visible_fraction = static_cast<double>(points.agreeing) / points.predicted;
  const int judged = points.agreeing + points.beyond;
  estimate.confidence = judged == 0 ? 0 : regions_[part].confidence * points.agreeing / judged;
  const bool hidden = points.hidden + points.missing >= points.beyond;
  estimate.status = estimate.visible_fraction >= kSeen ? PartStatus::kTracked
                    : hidden                           ? PartStatus::kOccluded
                                                       : PartStatus::kLost;
  return estimate;
}

void PaperFilter::FuseColour(size_t part, const Pose& X_TC, PartEstimate& estimate) const {
  if (!seen_[part] || regions_[part].confidence <= 0) return;
  // The variance of one particle's spread may be zero: no position is better than a tenth of a millimetre.
  const Matrix3 S_depth = estimate.covariance.topLeftCorner<3, 3>() + 1e-8 * Matrix3::Identity();
  const double sigma = options_.colour_position / regions_[part].confidence;
  const Matrix3 gain = S_depth * (S_depth + sigma * sigma * Matrix3::Identity()).inverse();
  estimate.X_TP.translation() += gain * (X_TC * *seen_[part] - estimate.X_TP.translation());
  const Matrix3 left = Matrix3::Identity() - gain;
  estimate.covariance.topLeftCorner<3, 3>() = left * S_depth;
  estimate.covariance.topRightCorner<3, 3>() = (left * estimate.covariance.topRightCorner<3, 3>()).eval();
  estimate.covariance.bottomLeftCorner<3, 3>() = estimate.covariance.topRightCorner<3, 3>().transpose();
}

}  // namespace coach
