#include "services/pose_filter/pose_search.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

/// Mean of the surface points that face along -view, weighted by what the camera sees of them: part frame.
Vector3 VisibleCentre(const PartModel& model, const Matrix3& R_CP, const Vector3& view) {
  Vector3 sum = Vector3::Zero();
  double total = 0;
  for (size_t i = 0; i < model.surface.size(); i += 6) {
    const double facing = -(R_CP * model.surface[i].n).dot(view);
    if (facing <= 0) continue;
    sum += facing * model.surface[i].p;
    total += facing;
  }
  return total > 0 ? Vector3(sum / total) : Vector3(Vector3::Zero());
}

/// Points of the blob to try as the middle of what is seen: its centroid, and for a blob that may hold several parts or
/// a piece of one, points far apart from each other.
std::vector<Vector3> Anchors(const Blob& blob, const Observation& o, double expected_cells) {
  std::vector<Vector3> out{blob.p_C};
  if (blob.cells < 1.5 * expected_cells) return out;
  const int wanted = std::min(6, static_cast<int>(2 * blob.cells / expected_cells));
  std::vector<Vector3> points;
  for (const auto& p : blob.pixels) {
    const double z = o.Depth(p.x(), p.y());
    if (z > 0) points.push_back(o.camera.BackProject(p.cast<double>(), z));
  }
  for (int k = 0; k < wanted && !points.empty(); ++k) {
    double best = -1;
    size_t at = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      double nearest = 1e9;
      for (const Vector3& a : out) nearest = std::min(nearest, (a - points[i]).squaredNorm());
      if (nearest > best) {
        best = nearest;
        at = i;
      }
    }
    out.push_back(points[at]);
  }
  // The farthest points are tips; the middle between a tip and the centroid is a better middle of a part.
  for (size_t i = 1; i < out.size(); ++i) out[i] = 0.5 * (out[i] + blob.p_C);
  return out;
}

}  // namespace

bool Acceptable(const PoseCandidate& c, const PoseSearchOptions& options) {
  return c.score.agreement() >= options.least_agreement && c.score.open() >= options.least_visible * c.full_samples &&
         c.score.open() >= 12 && c.outline_support() >= options.least_outline &&
         c.evidence.depth_chi2 <= options.largest_chi2;
}

PoseCandidate Polish(const PartModel& model, const Observation& observation, const OwnerMap& owners, int part,
                     uint8_t class_bit, const Pose& X_CP, const RefinementOptions& options,
                     RefinementScratch& scratch) {
  PoseCandidate c;
  const RefinementResult refined = Refine(model, observation, owners, part, class_bit, X_CP, options, scratch);
  c.X_CP = refined.X_CP;
  c.evidence = refined.last;
  const int step = SampleStep(model, observation.camera, c.X_CP, OwnerMap::kStep);
  RenderTile(model, observation.camera, c.X_CP, step, 0, scratch.tile);
  c.score = ScoreTile(scratch.tile, observation, owners, part, class_bit);
  c.pixels = c.score.inlier * step * step;
  const double in_image = InImageFraction(model, observation.camera, c.X_CP);
  c.full_samples = in_image > 0.02 ? scratch.tile.covered / in_image : 0;
  return c;
}

std::optional<PoseCandidate> SearchPose(const PartModel& model, const PointSet& points, const Observation& observation,
                                        const OwnerMap& owners, int part, uint8_t class_bit, const Blob& blob,
                                        const Pose& X_TC, const PoseSearchOptions& options, const Pose* former_X_CP,
                                        RefinementScratch& scratch) {
  if (blob.readings < 3) return std::nullopt;
  struct Ranked {
    float score;
    Pose X_CP;
  };
  std::vector<Ranked> ranked;
  const Vector3 view = blob.p_C.normalized();
  const CameraModel& camera = observation.camera;
  const double pixels_per_metre = camera.fx / blob.p_C.z() / Blob::kStep;
  const double expected = 4 * model.principal_half.x() * model.principal_half.y() * pixels_per_metre * pixels_per_metre;
  const std::vector<Vector3> anchors = Anchors(blob, observation, expected);
  const Matrix3 R_CT = X_TC.linear().transpose();
  const auto consider = [&](const Matrix3& R_CP) {
    const Vector3 centre = VisibleCentre(model, R_CP, view);
    const Vector3 along = R_CP * model.principal_axes.col(0);
    for (const Vector3& anchor : anchors) {
      const double slack = blob.cells < 0.7 * expected ? 0.5 * model.principal_half.x() : 0.0;
      for (const double shift : {0.0, slack, -slack}) {
        Pose X;
        X.linear() = R_CP;
        X.translation() = anchor - R_CP * centre + shift * along;
        if (X.translation().z() < 0.1) continue;
        ranked.push_back({ScorePoints(points, observation, owners, part, class_bit, X), X});
        if (slack == 0) break;
      }
    }
  };
  for (const Matrix3& R : model.orientations) consider(R);
  for (const Matrix3& R : model.resting) consider(R_CT * R);
  const auto better = [](const Ranked& a, const Ranked& b) { return a.score > b.score; };
  const size_t kept = std::min<size_t>(ranked.size(), static_cast<size_t>(options.refined) * 4);
  std::partial_sort(ranked.begin(), ranked.begin() + kept, ranked.end(), better);
  ranked.resize(kept);

  std::vector<PoseCandidate> found;
  const double reach = model.extent.diameter / 2;
  const auto near = [&](const Pose& a, const Pose& b, double distance) {
    return (a.translation() - b.translation()).norm() +
               reach * RotationError(model.symmetries, a.linear(), b.linear()) <
           distance;
  };
  RefinementOptions quick;
  quick.iterations = 5;
  quick.depth_points = 130;
  quick.contour_points = options.contour ? 60 : 0;
  std::vector<Pose> tried;
  for (const Ranked& r : ranked) {
    if (static_cast<int>(tried.size()) >= options.refined) break;
    if (std::any_of(tried.begin(), tried.end(), [&](const Pose& t) { return near(t, r.X_CP, 0.015); })) continue;
    tried.push_back(r.X_CP);
    found.push_back(Polish(model, observation, owners, part, class_bit, r.X_CP, quick, scratch));
  }
  const auto likelier = [](const PoseCandidate& a, const PoseCandidate& b) {
    return a.score.log_likelihood > b.score.log_likelihood;
  };
  std::sort(found.begin(), found.end(), likelier);
  if (found.size() > static_cast<size_t>(options.polished)) found.resize(static_cast<size_t>(options.polished));
  if (found.empty()) return std::nullopt;
  RefinementOptions full;
  if (!options.contour) full.contour_points = 0;
  const size_t bases = found.size();
  for (size_t i = 0; i < bases; ++i)
    found.push_back(Polish(model, observation, owners, part, class_bit, found[i].X_CP, full, scratch));
  const Pose best_pose = std::min_element(found.begin(), found.end(), likelier)->X_CP;
  for (const Pose& S : model.near_symmetries)
    found.push_back(Polish(model, observation, owners, part, class_bit, best_pose * S, full, scratch));
  PoseCandidate best = *std::min_element(found.begin(), found.end(), likelier);
  if (former_X_CP) {
    const auto turned = [&](const PoseCandidate& c) {
      return RotationError(model.symmetries, former_X_CP->linear(), c.X_CP.linear());
    };
    const double enough = options.almost_as_likely * best.score.log_likelihood;
    for (const PoseCandidate& c : found) {
      if (c.score.log_likelihood > enough && turned(c) < turned(best)) best = c;
    }
  }
  // Without an outline a sleeve of the part's colour at the image's border is as good as the part.
  if (observation.class_map && best.evidence.contour_judged < options.least_judged) return std::nullopt;
  if (!Acceptable(best, options)) return std::nullopt;
  return best;
}

}  // namespace coach
