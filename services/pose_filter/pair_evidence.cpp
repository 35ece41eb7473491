#include "services/pose_filter/pair_evidence.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coach {

PairFinder::PairFinder(const Task& task, const PairOptions& options) : task_(task), options_(options) {
  const size_t types = task_.types.size();
  candidates_.resize(types * types);
  for (const PartType& type : task_.types) {
    fields_.emplace_back(type.mesh, DistanceFieldOptions{.voxel = 0.003, .margin = 0.03, .max_samples = 100000});
    surface_.push_back(SampleSurface(type.mesh, 160));
    extents_.push_back(Extent(type.mesh));
  }
  const auto add = [&](int type_a, int type_b, const Pose& X_AB, CandidateKind kind, int index) {
    for (const Matrix3& Sa : SampledElements(task_.types[type_a].symmetries, 0.2)) {
      for (const Matrix3& Sb : SampledElements(task_.types[type_b].symmetries, 0.2)) {
        Pose X = X_AB;
        X.linear() = Sa.transpose() * X_AB.linear() * Sb;
        X.translation() = Sa.transpose() * X_AB.translation();
        candidates_[type_a * types + type_b].push_back({X, kind, index});
        candidates_[type_b * types + type_a].push_back({X.inverse(), kind, index});
      }
    }
  };
  for (size_t i = 0; i < task_.connections.size(); ++i) {
    const Connection& c = task_.connections[i];
    add(task_.slots[c.slot_a].type, task_.slots[c.slot_b].type, c.X_AB, CandidateKind::kConnection,
        static_cast<int>(i));
  }
  for (size_t i = 0; i < task_.mistakes.size(); ++i) {
    const Mistake& m = task_.mistakes[i];
    add(m.type_a, m.type_b, m.X_AB, CandidateKind::kMistake, static_cast<int>(i));
  }
}

void PairFinder::Motion(PairEvidence& pair, const Moment& now) const {
  const size_t a = static_cast<size_t>(pair.part_a), b = static_cast<size_t>(pair.part_b);
  const auto then = std::find_if(history_.begin(), history_.end(), [&](const Moment& m) {
    return m.seen[a] && m.seen[b] && static_cast<double>(now.utime - m.utime) * 1e-6 <= options_.window;
  });
  if (then == history_.end()) return;
  const Vector6 moved = Difference(then->X_TP[a], now.X_TP[a]);
  const Vector6 relative = Difference(then->X_TP[a].inverse() * then->X_TP[b], pair.X_AB);
  pair.motion = {moved.head<3>().norm(), moved.tail<3>().norm()};
  pair.relative_motion = {relative.head<3>().norm(), relative.tail<3>().norm()};
}

void PairFinder::TestCandidates(PairEvidence& pair) const {
  const Eigen::LDLT<Matrix6> solver(pair.covariance);
  // Gaussian around the joint against two free bodies spread evenly over the poses in contact: the one-body hypothesis
  // saves six parameters, which the ratio of the two densities pays for.
  const double log_normal = -3 * std::log(2 * std::numbers::pi) - 0.5 * solver.vectorD().array().max(1e-20).log().sum();
  double best = -1e300;
  for (const Candidate& c : CandidatesOf(pair.part_a, pair.part_b)) {
    const Vector6 e = Difference(c.X_AB, pair.X_AB);
    const double log_evidence = log_normal - 0.5 * e.dot(solver.solve(e)) + std::log(options_.open_volume);
    if (log_evidence <= best) continue;
    best = log_evidence;
    pair.candidate_kind = c.kind;
    pair.candidate = c.index;
    pair.log_evidence = log_evidence;
  }
}

double PairFinder::Overlap(int part_a, const Pose& X_TA, int part_b, const Pose& X_TB, double allowed) const {
  const size_t type_a = static_cast<size_t>(task_.parts[part_a].type),
               type_b = static_cast<size_t>(task_.parts[part_b].type);
  const double reach = (extents_[type_a].diameter + extents_[type_b].diameter) / 2;
  if ((X_TA * extents_[type_a].centre - X_TB * extents_[type_b].centre).norm() > reach) return 0;
  const Eigen::Isometry3f X_BA = (X_TB.inverse() * X_TA).cast<float>();
  int inside = 0;
  for (const SurfacePoint& s : surface_[type_a])
    inside += fields_[type_b].Distance(X_BA * s.p.cast<float>()) < -static_cast<float>(allowed);
  return static_cast<double>(inside) / static_cast<double>(surface_[type_a].size());
}

void PairFinder::Find(int64_t utime, const std::vector<Track>& tracks, std::vector<PairEvidence>& out) {
  out.clear();
  if (!history_.empty() && utime <= history_.back().utime) history_.clear();
  // The oldest moment that is not needed any more becomes this one.
  const auto old = [&](const Moment& m) { return static_cast<double>(utime - m.utime) * 1e-6 > options_.window; };
  const auto first = std::find_if_not(history_.begin(), history_.end(), old);
  Moment now;
  if (first != history_.begin()) now = std::move(history_.front());
  history_.erase(history_.begin(), first);
  now.utime = utime;
  now.X_TP.clear();
  now.seen.clear();
  for (const Track& t : tracks) {
    now.X_TP.push_back(t.X_TP_free);
    now.seen.push_back(!t.missing());
  }
  Matrix6 floor = Matrix6::Zero();
  floor.diagonal().head<3>().setConstant(options_.floor_position * options_.floor_position);
  floor.diagonal().tail<3>().setConstant(options_.floor_rotation * options_.floor_rotation);
  for (size_t a = 0; a < tracks.size(); ++a) {
    for (size_t b = a + 1; b < tracks.size(); ++b) {
      if (!now.seen[a] || !now.seen[b]) continue;
      const size_t type_a = static_cast<size_t>(task_.parts[a].type), type_b = static_cast<size_t>(task_.parts[b].type);
      const double apart = (now.X_TP[a] * extents_[type_a].centre - now.X_TP[b] * extents_[type_b].centre).norm();
      if (apart > (extents_[type_a].diameter + extents_[type_b].diameter) / 2 + options_.near) continue;
      PairEvidence pair;
      pair.part_a = static_cast<int>(a);
      pair.part_b = static_cast<int>(b);
      pair.X_AB = now.X_TP[a].inverse() * now.X_TP[b];
      pair.surface_distance = 1e9;
      const Eigen::Isometry3f X_BA = pair.X_AB.inverse().cast<float>(), X_AB = pair.X_AB.cast<float>();
      for (const SurfacePoint& s : surface_[type_a])
        pair.surface_distance =
            std::min(pair.surface_distance, double(fields_[type_b].Distance(X_BA * s.p.cast<float>())));
      for (const SurfacePoint& s : surface_[type_b])
        pair.surface_distance =
            std::min(pair.surface_distance, double(fields_[type_a].Distance(X_AB * s.p.cast<float>())));
      if (pair.surface_distance > options_.near) continue;
      // Errors of A move B's place in A's frame with the lever between them; errors of the table frame are shared and
      // cancel.
      const Pose X_AT = now.X_TP[a].inverse();
      Matrix6 lever = Matrix6::Identity();
      const Vector3 arm = X_AT.linear() * (now.X_TP[b].translation() - now.X_TP[a].translation());
      lever.topRightCorner<3, 3>() << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0;
      const Matrix6 cov_a = RotateCovariance(X_AT.linear(), tracks[a].covariance_free) + floor;
      const Matrix6 cov_b = RotateCovariance(X_AT.linear(), tracks[b].covariance_free) + floor;
      pair.covariance = lever * cov_a * lever.transpose() + cov_b;
      pair.pixels = tracks[a].pixels + tracks[b].pixels;
      pair.visible_fraction = {tracks[a].visible_fraction, tracks[b].visible_fraction};
      TestCandidates(pair);
      Motion(pair, now);
      out.push_back(pair);
    }
  }
  history_.push_back(std::move(now));
}

}  // namespace coach
