#include "services/pose_filter/rigid_body.h"

#include <algorithm>
#include <cmath>

#include "services/pose_filter/score.h"

namespace coach {
namespace {

/// A point of the body's visible surface.
struct ColourPoint {
  Vector3 p_C;
  uint8_t class_bit;
};

/// Visible points of the body at a pose, evenly over its members.
std::vector<ColourPoint> VisibleColour(const RigidBody& body, const Pose& X_CG, int most) {
  std::vector<ColourPoint> facing;
  for (const RigidMember& m : body) {
    const Pose X_CP = X_CG * m.X_GP;
    for (size_t i = 0; i < m.points->size(); ++i) {
      const Vector3 p = X_CP * Vector3(m.points->x[i], m.points->y[i], m.points->z[i]);
      const Vector3 n = X_CP.linear() * Vector3(m.points->nx[i], m.points->ny[i], m.points->nz[i]);
      if (-n.dot(p) > 0.2 * p.norm()) facing.push_back({p, m.class_bit});
    }
  }
  std::vector<ColourPoint> out;
  const size_t stride = std::max<size_t>(1, facing.size() / static_cast<size_t>(most));
  for (size_t i = 0; i < facing.size(); i += stride) out.push_back(facing[i]);
  return out;
}

/// A turn about the body's middle and a shift in the image.
struct Proposal {
  double matched = 0;
  Matrix3 turn = Matrix3::Identity();
  double du = 0, dv = 0;
};

/// What the image around a body says of its colours, looked up many times: for each cell of a window and each class
/// bit of the body 1 (the class), 0 (something in front, or another part) or a penalty.
class ColourMap {
 public:
  static constexpr int kStep = 4;  // px

  ColourMap(const Observation& o, const OwnerMap& owners, const cv::Rect& window, double depth,
            const std::vector<uint8_t>& bits)
      : x0_(window.x), y0_(window.y), width_(window.width / kStep + 1), height_(window.height / kStep + 1) {
    cells_.assign(bits.size() * static_cast<size_t>(width_) * static_cast<size_t>(height_), 0);
    for (size_t b = 0; b < bits.size(); ++b) {
      float* cell = &cells_[b * static_cast<size_t>(width_) * static_cast<size_t>(height_)];
      for (int j = 0; j < height_; ++j) {
        for (int i = 0; i < width_; ++i) *cell++ = Value(o, owners, x0_ + i * kStep, y0_ + j * kStep, depth, bits[b]);
      }
    }
  }
  float At(size_t bit, double u, double v) const {
    const int i = static_cast<int>(u - x0_) / kStep, j = static_cast<int>(v - y0_) / kStep;
    if (u < x0_ || v < y0_ || i >= width_ || j >= height_) return 0;
    return cells_[(bit * static_cast<size_t>(height_) + static_cast<size_t>(j)) * static_cast<size_t>(width_) +
                  static_cast<size_t>(i)];
  }

 private:
  static float Value(const Observation& o, const OwnerMap& owners, int x, int y, double depth, uint8_t bit) {
    if (!o.Inside(x, y)) return 0;
    const double z = o.Depth(x, y);
    if (o.Classes(x, y) & bit) {
      const double other = owners.NearestDepth(x, y);
      return other > 0 && (z == 0 || std::abs(z - other) < 0.02) ? 0.0f : 1.0f;
    }
    return z > 0 && z < depth - 0.05 ? 0.0f : -0.7f;
  }
  int x0_, y0_, width_, height_;
  std::vector<float> cells_;
};

std::vector<Matrix3> Turns(const Vector3& ray, const Vector3& normal, const BodySearchOptions& options) {
  std::vector<Matrix3> out{Matrix3::Identity()};
  for (int k = 1; k <= options.turns; ++k) {
    for (const double sign : {1.0, -1.0}) {
      out.push_back(ExpRotation(sign * k * options.turn * ray));
      out.push_back(ExpRotation(sign * k * options.turn * normal));
    }
  }
  return out;
}

/// The shift moved along its ray to where most of the matching readings are.
std::optional<Pose> AtMeasuredDepth(const Proposal& proposal, const std::vector<ColourPoint>& points,
                                    const Vector3& middle, const Pose& X_CG, const Observation& o,
                                    std::vector<double>& ratios) {
  ratios.clear();
  const CameraModel& camera = o.camera;
  for (const ColourPoint& point : points) {
    const Vector3 p = middle + proposal.turn * (point.p_C - middle);
    const int x = static_cast<int>(camera.fx * p.x() / p.z() + camera.cx + proposal.du);
    const int y = static_cast<int>(camera.fy * p.y() / p.z() + camera.cy + proposal.dv);
    if (!o.Inside(x, y) || !(o.Classes(x, y) & point.class_bit)) continue;
    const double z = o.Depth(x, y);
    if (z > 0) ratios.push_back(z - p.z());
  }
  const double z = middle.z();
  double dz = 0;
  if (ratios.size() >= 3) {
    std::nth_element(ratios.begin(), ratios.begin() + static_cast<long>(ratios.size() / 2), ratios.end());
    dz = ratios[ratios.size() / 2];
  }
  if (std::abs(dz) > 0.15) return std::nullopt;
  const double u = camera.fx * middle.x() / z + camera.cx + proposal.du,
               v = camera.fy * middle.y() / z + camera.cy + proposal.dv;
  const Vector3 target = camera.BackProject({u, v}, z + dz);
  Pose X;
  X.linear() = proposal.turn * X_CG.linear();
  X.translation() = target + proposal.turn * (X_CG.translation() - middle);
  return X;
}

float ScoreBodyPoints(const RigidBody& body, const Observation& o, const OwnerMap& owners, const Pose& X_CG) {
  float sum = 0;
  for (const RigidMember& m : body) sum += ScorePoints(*m.points, o, owners, m.part, m.class_bit, X_CG * m.X_GP);
  return sum;
}

/// Turns and shifts of the body under which its colours match the image, best first.
std::vector<Proposal> ProposeByColour(const RigidBody& body, const std::vector<ColourPoint>& points,
                                      const Vector3& middle, const Observation& o, const OwnerMap& owners,
                                      const Vector3& normal_C, double dt, const BodySearchOptions& options) {
  const double reach_px = (options.fastest * dt + options.slack) * o.camera.fx / middle.z();
  const int reach = static_cast<int>(reach_px / options.shift_step);
  std::vector<uint8_t> bits;
  for (const RigidMember& m : body) {
    if (std::find(bits.begin(), bits.end(), m.class_bit) == bits.end()) bits.push_back(m.class_bit);
  }
  // Every point under every turn, and the window that they can reach.
  const std::vector<Matrix3> turns = Turns(middle.normalized(), normal_C, options);
  struct Projected {
    double u, v;
    size_t bit;
  };
  std::vector<Projected> projected;
  double u0 = 1e9, v0 = 1e9, u1 = -1e9, v1 = -1e9;
  for (const Matrix3& turn : turns) {
    for (const ColourPoint& point : points) {
      const Vector3 p = middle + turn * (point.p_C - middle);
      const double u = o.camera.fx * p.x() / p.z() + o.camera.cx, v = o.camera.fy * p.y() / p.z() + o.camera.cy;
      projected.push_back(
          {u, v, static_cast<size_t>(std::find(bits.begin(), bits.end(), point.class_bit) - bits.begin())});
      u0 = std::min(u0, u);
      v0 = std::min(v0, v);
      u1 = std::max(u1, u);
      v1 = std::max(v1, v);
    }
  }
  const cv::Rect image(0, 0, o.camera.width, o.camera.height);
  const cv::Rect window =
      image &
      cv::Rect(
          cv::Point(static_cast<int>(std::max(-1e4, u0 - reach_px)), static_cast<int>(std::max(-1e4, v0 - reach_px))),
          cv::Point(static_cast<int>(std::min(1e4, u1 + reach_px)), static_cast<int>(std::min(1e4, v1 + reach_px))));
  if (window.empty()) return {};
  const ColourMap map(o, owners, window, middle.z(), bits);
  std::vector<Proposal> proposals;
  for (size_t t = 0; t < turns.size(); ++t) {
    const Projected* of_turn = &projected[t * points.size()];
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        if (i * i + j * j > reach * reach) continue;
        Proposal proposal{0, turns[t], i * options.shift_step, j * options.shift_step};
        for (size_t k = 0; k < points.size(); ++k)
          proposal.matched += map.At(of_turn[k].bit, of_turn[k].u + proposal.du, of_turn[k].v + proposal.dv);
        if (proposal.matched > 0.1 * static_cast<double>(points.size())) proposals.push_back(proposal);
      }
    }
  }
  const size_t kept = std::min<size_t>(proposals.size(), static_cast<size_t>(options.scored));
  std::partial_sort(proposals.begin(), proposals.begin() + static_cast<long>(kept), proposals.end(),
                    [](const Proposal& a, const Proposal& b) { return a.matched > b.matched; });
  proposals.resize(kept);
  return proposals;
}

}  // namespace

Pose RefineBody(const RigidBody& body, const Observation& observation, const OwnerMap& owners, const Pose& start,
                const RefinementOptions& options, RefinementScratch& scratch) {
  Pose X_CG = start;
  double reach = 0;
  for (const RigidMember& m : body) reach = std::max(reach, m.X_GP.translation().norm() + m.model->extent.diameter / 2);
  for (int k = 0; k < options.iterations; ++k) {
    const double blend = options.iterations > 1 ? static_cast<double>(k) / (options.iterations - 1) : 1;
    PoseEquations sum;
    for (const RigidMember& m : body) {
      const Pose X_CP = X_CG * m.X_GP;
      if (!FindEvidence(*m.model, observation, X_CP, options, scratch)) continue;
      const PoseEquations e = Linearise(*m.model, observation, owners, m.part, m.class_bit, X_CP, blend,
                                        options.outline_bias, options, scratch);
      // Turning the body by w about its origin also shifts the member by w x arm.
      const Vector3 arm = X_CG.linear() * m.X_GP.translation();
      Matrix6 A = Matrix6::Identity();
      A.topRightCorner<3, 3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
      sum.information.noalias() += A.transpose() * e.information * A;
      sum.gradient.noalias() += A.transpose() * e.gradient;
    }
    const Vector6 step = RefinementStep(sum, Difference(X_CG, start), reach, options);
    X_CG = Perturb(X_CG, step);
    if (StepLength(step, reach) < 5e-4 && k > 0) break;
  }
  return X_CG;
}

Score ScoreBody(const RigidBody& body, const Observation& observation, const OwnerMap& owners, const Pose& X_CG,
                RefinementScratch& scratch) {
  Score sum;
  for (const RigidMember& m : body) {
    const Pose X_CP = X_CG * m.X_GP;
    RenderTile(*m.model, observation.camera, X_CP, SampleStep(*m.model, observation.camera, X_CP, OwnerMap::kStep), 0,
               scratch.tile);
    sum += ScoreTile(scratch.tile, observation, owners, m.part, m.class_bit);
  }
  return sum;
}

std::optional<Pose> SearchBody(const RigidBody& body, const Observation& o, const OwnerMap& owners, const Pose& X_CG,
                               const Vector3& normal_C, double dt, const BodySearchOptions& options,
                               RefinementScratch& scratch) {
  struct Ranked {
    float score;
    Pose X_CG;
  };
  std::vector<Ranked> ranked{{ScoreBodyPoints(body, o, owners, X_CG), X_CG}};
  const std::vector<ColourPoint> points = VisibleColour(body, X_CG, options.points);
  if (o.class_map && !points.empty()) {
    Vector3 middle = Vector3::Zero();
    for (const ColourPoint& p : points) middle += p.p_C / static_cast<double>(points.size());
    std::vector<double> offsets;
    for (const Proposal& proposal : ProposeByColour(body, points, middle, o, owners, normal_C, dt, options)) {
      if (const auto X = AtMeasuredDepth(proposal, points, middle, X_CG, o, offsets))
        ranked.push_back({ScoreBodyPoints(body, o, owners, *X), *X});
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.score > b.score; });
  std::vector<Pose> tried;
  std::optional<Pose> best;
  double best_likelihood = 0;
  for (const Ranked& start : ranked) {
    if (static_cast<int>(tried.size()) >= options.refined) break;
    const auto near = [&](const Pose& X) { return StepLength(Difference(X, start.X_CG), 0.05) < 0.015; };
    if (std::any_of(tried.begin(), tried.end(), near)) continue;
    tried.push_back(start.X_CG);
    const Pose X = RefineBody(body, o, owners, start.X_CG, options.refinement, scratch);
    const Score score = ScoreBody(body, o, owners, X, scratch);
    if (score.agreement() < options.least_agreement || score.log_likelihood <= best_likelihood) continue;
    const bool far = (X.translation() - X_CG.translation()).norm() > options.far;
    if (far && score.log_likelihood <= options.far_likelihood) continue;
    best_likelihood = score.log_likelihood;
    best = X;
    if (score.agreement() > options.sure_agreement) break;
  }
  return best;
}

}  // namespace coach
