#include "services/pose_filter/refinement.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace coach {
namespace {

/// Nearest integer; pixels are not far below zero.
int Nearest(double v) { return static_cast<int>(v + 4096.5) - 4096; }

using Row = Eigen::Matrix<double, 1, 6>;

/// Sums of the normal equations.
struct Normal {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  int used = 0;
  int judged = 0;
  double weight = 0;
  double chi2 = 0;
  Vector6 h_bias = Vector6::Zero();  // coupling with the outline's bias, where there is one
  double H_bias = 0, g_bias = 0;

  void AddOutline(const Row& J, double r, double information, double robust) {
    Add(J, r, information, robust);
    h_bias.noalias() += (information * robust) * J.transpose();
    H_bias += information * robust;
    g_bias += information * robust * r;
  }
  void Add(const Row& J, double r, double information, double robust) {
    H.noalias() += (information * robust) * J.transpose() * J;
    g.noalias() += (information * robust * r) * J.transpose();
    ++used;
    weight += robust;
    chi2 += robust * r * r * information;
  }
  /// Scales so that the observations count as at most `witnesses`.
  void Temper(double witnesses) {
    if (weight <= witnesses) return;
    const double scale = witnesses / weight;
    H *= scale;
    g *= scale;
    h_bias *= scale;
    H_bias *= scale;
    g_bias *= scale;
  }
  /// Takes the bias out of the equations (Schur complement), given its prior N(mean, 1 / information). @return its
  /// estimate at zero step.
  double MarginaliseBias(double mean, double information) {
    const double total = H_bias + information, b = (g_bias + information * mean) / total;
    H.noalias() -= h_bias * h_bias.transpose() / total;
    g.noalias() -= h_bias * b;
    return b;
  }
};

/// d(a . p_C) / d(perturbation) for a point of the part: the translation moves it, the rotation turns it about the
/// origin.
Row PointJacobian(const Vector3& a, const Vector3& arm) {
  Row J;
  J.head<3>() = a.transpose();
  J.tail<3>() = arm.cross(a).transpose();
  return J;
}

double Tukey(double r, double c) {
  const double t = r / c;
  if (std::abs(t) >= 1) return 0;
  const double u = 1 - t * t;
  return u * u;
}

bool CoveredAround(const DepthTile& tile, int x, int y, int radius) {
  return tile.AtPixel(x - radius, y) > 0 && tile.AtPixel(x + radius, y) > 0 && tile.AtPixel(x, y - radius) > 0 &&
         tile.AtPixel(x, y + radius) > 0;
}

/// Indices of surface samples that the camera sees at this pose, thinned to about `most`.
void FindVisible(const PartModel& model, const CameraModel& camera, const Pose& X_CP, const DepthTile& tile, int most,
                 std::vector<int>& visible) {
  visible.clear();
  const int n = static_cast<int>(model.surface.size());
  const int stride = std::max(1, n / (2 * most));  // about half of a closed surface faces the camera
  for (int i = 0; i < n; i += stride) {
    const Vector3 p = X_CP * model.surface[i].p;
    if (p.z() < 0.05 || (X_CP.linear() * model.surface[i].n).dot(p) > -0.12 * p.norm()) continue;
    const int x = Nearest(camera.fx * p.x() / p.z() + camera.cx);
    const int y = Nearest(camera.fy * p.y() / p.z() + camera.cy);
    const float d = tile.AtPixel(x, y);
    if (d == 0 || p.z() > d + 0.006 || !CoveredAround(tile, x, y, tile.step)) continue;
    visible.push_back(i);
  }
}

void AddDepth(const PartModel& model, const Observation& observation, const OwnerMap& owners, int part,
              uint8_t class_bit, const Pose& X_CP, const std::vector<int>& visible, double gate_first,
              double gate_sigmas, double blend, Normal& normal) {
  const CameraModel& camera = observation.camera;
  for (const int i : visible) {
    const Vector3 arm = X_CP.linear() * model.surface[i].p;
    const Vector3 p = arm + X_CP.translation();
    const int x = Nearest(camera.fx * p.x() / p.z() + camera.cx);
    const int y = Nearest(camera.fy * p.y() / p.z() + camera.cy);
    if (!observation.Inside(x, y)) continue;
    const double z = observation.Depth(x, y);
    if (z == 0) continue;
    const float other = owners.OtherDepth(x, y, part);
    if (other > 0 && other < p.z() - 0.003) continue;
    const double sigma = DepthSigma(z);
    const double gate = (1 - blend) * gate_first + blend * std::max(0.006, gate_sigmas * sigma);
    if (std::abs(z - p.z()) > gate + 0.004) continue;
    const Vector3 ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
    const Vector3 n = X_CP.linear() * model.surface[i].n;
    const double slant = -n.dot(ray);  // 1: seen straight on
    const double r = n.dot(z * ray - p);
    const double lateral = 0.4 * z / camera.fx;  // the reading belongs to the pixel's middle, not to p
    const double variance = sigma * sigma * slant * slant + lateral * lateral * std::max(0.0, 1 - slant * slant) + 1e-6;
    // A pixel of another colour may be a finger at the part's own depth.
    const double own = !observation.class_map || (observation.Classes(x, y) & class_bit) ? 1.0 : 0.1;
    const double robust = Tukey(r, gate) * std::min(1.0, slant) * own;
    if (robust > 0) normal.Add(PointJacobian(n, arm), r, 1 / variance, robust);
  }
}

/// What one sample along a search line says: +1 inside the part's class, -1 outside, 0 nothing.
int Inside(const Observation& observation, const OwnerMap& owners, int part, uint8_t class_bit, int x, int y,
           double depth) {
  if (!observation.Inside(x, y)) return 0;
  const float z = observation.Depth(x, y);
  const double gate = 0.010 + 3 * DepthSigma(depth);
  if (z > 0 && z < depth - gate) return 0;  // something in front
  const float other = owners.OtherDepth(x, y, part);
  const bool own_class = observation.Classes(x, y) & class_bit;
  if (!own_class && z == 0) {
    const float likely = observation.LikelyDepth(x, y);
    if (likely > 0 && likely < depth - gate) return 0;
  }
  if (own_class && other > 0) return 0;                // may be the other part's colour
  if (own_class && z > depth + 0.05 + gate) return 0;  // the same colour, far behind
  return own_class ? 1 : -1;
}

/// Place of the step along a search line from the colours themselves: mixed pixels at an edge are part inside, part
/// outside, and the area under that share is the edge's place, without the bias of a colour range. Empty where the two
/// sides differ too little or something is in front.
/// @param near sample at which the class map has the step. @param g what the samples -L..L say, indexed from the
/// middle.
std::optional<double> ColourEdge(const Observation& observation, double u, double v, const Eigen::Vector2d& normal,
                                 int near, const int* g, int L) {
  constexpr int kReach = 3, kSide = 2;  // samples looked at around the step, and beyond them for the two sides' colours
  if (!observation.bgr || near - kReach - kSide < -L || near + kReach + kSide > L) return std::nullopt;
  const auto colour = [&](int s) {
    const int x = Nearest(u + s * normal.x()), y = Nearest(v + s * normal.y());
    const uint8_t* p = observation.bgr + 3 * (static_cast<size_t>(y) * static_cast<size_t>(observation.camera.width) +
                                              static_cast<size_t>(x));
    return Eigen::Vector3f(p[0], p[1], p[2]);
  };
  Eigen::Vector3f in = Eigen::Vector3f::Zero(), out = in;
  for (int s = near - kReach - kSide; s <= near + kReach + kSide; ++s) {
    const int x = Nearest(u + s * normal.x()), y = Nearest(v + s * normal.y());
    if (g[s] == 0 || !observation.Inside(x, y)) return std::nullopt;
    if (s < near - kReach) in += colour(s) / kSide;
    if (s > near + kReach) out += colour(s) / kSide;
  }
  const Eigen::Vector3f axis = in - out;
  const float contrast = axis.squaredNorm();
  if (contrast < 40 * 40) return std::nullopt;
  double share = 0;
  for (int s = near - kReach; s <= near + kReach; ++s)
    share += std::clamp((colour(s) - out).dot(axis) / contrast, 0.0f, 1.0f);
  return near - kReach - 0.5 + share;
}

void AddContour(const Observation& observation, const OwnerMap& owners, int part, uint8_t class_bit, const Pose& X_CP,
                const std::vector<RefinementScratch::OutlinePoint>& outline, int half_length, double bias,
                Normal& normal) {
  constexpr int kLongest = 16;
  constexpr double kGain = 1.2;  // nats a sample: a class map is wrong for about one pixel in ten near an edge
  const int L = std::min(half_length, kLongest);
  const CameraModel& camera = observation.camera;
  int g[2 * kLongest + 1];
  for (const auto& o : outline) {
    const Vector3 arm = X_CP.linear() * o.p_P;
    const Vector3 p = arm + X_CP.translation();
    const double u = camera.fx * p.x() / p.z() + camera.cx, v = camera.fy * p.y() / p.z() + camera.cy;
    int unknown = 0;
    for (int s = -L; s <= L; ++s) {
      const int x = Nearest(u + s * o.normal.x()), y = Nearest(v + s * o.normal.y());
      g[s + L] = Inside(observation, owners, part, class_bit, x, y, p.z());
      unknown += g[s + L] == 0;
    }
    if (unknown > L / 2) continue;
    ++normal.judged;
    // S(c): the step lies between samples c - 1 and c. Start with everything outside.
    double S[2 * kLongest + 2], best = -1e9;
    S[0] = 0;
    for (int k = 0; k <= 2 * L; ++k) S[0] -= g[k];
    for (int c = 1; c <= 2 * L + 1; ++c) S[c] = S[c - 1] + 2 * g[c - 1];
    for (int c = 0; c <= 2 * L + 1; ++c) best = std::max(best, S[c]);
    if (best < 0.6 * (2 * L + 1 - unknown)) continue;  // no clear step: a look-alike, an edge inside
    double sum = 0, mean = 0, square = 0;
    for (int c = 0; c <= 2 * L + 1; ++c) {
      const double w = std::exp(kGain * (S[c] - best));
      const double d = c - 0.5 - L;
      sum += w;
      mean += w * d;
      square += w * d * d;
    }
    mean /= sum;
    const double variance = square / sum - mean * mean + 0.6;
    if (std::abs(mean) > L - 1) continue;  // the line is all inside or all outside
    const Vector3 a = (o.normal.x() * camera.fx * Vector3(1, 0, -p.x() / p.z()) +
                       o.normal.y() * camera.fy * Vector3(0, 1, -p.y() / p.z())) /
                      p.z();
    const double robust = Tukey(mean, L + 1.0);
    if (robust <= 0) continue;
    if (const auto edge = ColourEdge(observation, u, v, o.normal, Nearest(mean), g + L, L)) {
      normal.Add(PointJacobian(a, arm), 0.5 * (*edge + mean - bias), 1 / variance, robust);
    } else {
      normal.AddOutline(PointJacobian(a, arm), mean, 1 / variance, robust);
    }
  }
}

}  // namespace

void FindOutline(const PartModel& model, const CameraModel& camera, const Pose& X_CP, const DepthTile& tile, int points,
                 std::vector<RefinementScratch::OutlinePoint>& outline) {
  outline.clear();
  if (tile.covered == 0 || points <= 0) return;
  const auto facing = [&](int t) {
    return (X_CP.linear() * model.normals[t]).dot(X_CP * model.mesh.vertices[model.mesh.triangles[t][0]]) < 0;
  };
  const auto project = [&](const Vector3& p) {
    return Eigen::Vector2d(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
  };
  // Spacing from the silhouette's size: a square of the same area has a perimeter of 4 sqrt(area); elongated parts have
  // more.
  const double spacing = std::max(1.0, 6.0 * std::sqrt(static_cast<double>(tile.covered)) * tile.step / points);
  double carried = spacing / 2;
  for (const ModelEdge& e : model.edges) {
    const bool f1 = facing(e.face_1), f2 = facing(e.face_2);
    const bool boundary = e.face_1 == e.face_2;
    if (boundary ? !f1 : f1 == f2) continue;
    const Vector3 pa = X_CP * model.mesh.vertices[e.a], pb = X_CP * model.mesh.vertices[e.b];
    if (pa.z() < 0.05 || pb.z() < 0.05) continue;
    const Eigen::Vector2d a = project(pa), b = project(pb);
    const double length = (b - a).norm();
    if (length < 1e-6) continue;
    Eigen::Vector2d normal(b.y() - a.y(), a.x() - b.x());
    normal /= length;
    const int opposite = f1 ? e.opposite_1 : e.opposite_2;
    if (normal.dot(project(X_CP * model.mesh.vertices[opposite]) - a) > 0) normal = -normal;
    for (; carried < length; carried += spacing) {
      const double t = carried / length;
      const Eigen::Vector2d at = a + t * (b - a);
      const double reach = tile.step + 1.0;
      const Eigen::Vector2d in = at - reach * normal, out = at + reach * normal;
      // 1 / z is linear along the edge's image.
      const double w = (1 - t) / pa.z() + t / pb.z(), z = 1 / w;
      if (tile.AtPixel(Nearest(out.x()), Nearest(out.y())) > 0) continue;
      const float d = tile.AtPixel(Nearest(in.x()), Nearest(in.y()));
      if (d == 0 || z > d + 0.02) continue;
      const double s = t / pb.z() / w;
      outline.push_back({model.mesh.vertices[e.a] + s * (model.mesh.vertices[e.b] - model.mesh.vertices[e.a]), normal});
    }
    carried -= length;
  }
}

bool FindEvidence(const PartModel& model, const Observation& observation, const Pose& X_CP,
                  const RefinementOptions& options, RefinementScratch& scratch) {
  RenderTile(model, observation.camera, X_CP, SampleStep(model, observation.camera, X_CP, OwnerMap::kStep), 6,
             scratch.tile);
  if (scratch.tile.covered == 0) return false;
  if (observation.depth)
    FindVisible(model, observation.camera, X_CP, scratch.tile, options.depth_points, scratch.visible);
  if (observation.class_map)
    FindOutline(model, observation.camera, X_CP, scratch.tile, options.contour_points, scratch.outline);
  return true;
}

PoseEquations Linearise(const PartModel& model, const Observation& observation, const OwnerMap& owners, int part,
                        uint8_t class_bit, const Pose& X_CP, double blend, double outline_bias,
                        const RefinementOptions& options, const RefinementScratch& scratch) {
  Normal depth, contour;
  if (observation.depth)
    AddDepth(model, observation, owners, part, class_bit, X_CP, scratch.visible, options.first_gate,
             options.last_gate_sigmas, blend, depth);
  if (observation.class_map) {
    const int L = Nearest((1 - blend) * options.first_half_length + blend * options.last_half_length);
    AddContour(observation, owners, part, class_bit, X_CP, scratch.outline, L, outline_bias, contour);
  }
  PoseEquations out;
  out.depth_used = depth.used;
  out.contour_used = contour.used;
  out.contour_judged = contour.judged;
  out.depth_chi2 = depth.weight > 0 ? depth.chi2 / depth.weight : 0;
  depth.Temper(options.depth_witnesses);
  contour.Temper(options.contour_witnesses);
  out.outline_bias =
      contour.MarginaliseBias(options.outline_bias, 1 / (options.outline_bias_sigma * options.outline_bias_sigma));
  out.information = depth.H + contour.H;
  out.gradient = depth.g + contour.g;
  return out;
}

Vector6 RefinementStep(const PoseEquations& equations, const Vector6& to_start, double reach,
                       const RefinementOptions& options) {
  Vector6 prior;
  prior.head<3>().setConstant(1 / (options.prior_position * options.prior_position));
  prior.tail<3>().setConstant(1 / (options.prior_rotation * options.prior_rotation));
  Matrix6 H = equations.information;
  H.diagonal() += prior;
  const Vector6 step = H.ldlt().solve(equations.gradient + prior.cwiseProduct(to_start));
  if (!step.allFinite()) return Vector6::Zero();
  const double length = StepLength(step, reach);
  return length > options.longest_step ? Vector6(step * (options.longest_step / length)) : step;
}

RefinementResult Refine(const PartModel& model, const Observation& observation, const OwnerMap& owners, int part,
                        uint8_t class_bit, const Pose& start, const RefinementOptions& options,
                        RefinementScratch& scratch) {
  RefinementResult result;
  result.X_CP = start;
  result.last.outline_bias = options.outline_bias;
  Pose rendered_at = start;
  const double reach = model.extent.diameter / 2;
  for (int k = 0; k < options.iterations; ++k) {
    if (k == 0 || StepLength(Difference(rendered_at, result.X_CP), reach) > 0.004) {
      if (!FindEvidence(model, observation, result.X_CP, options, scratch)) break;
      rendered_at = result.X_CP;
    }
    const double blend = options.iterations > 1 ? static_cast<double>(k) / (options.iterations - 1) : 1;
    result.last = Linearise(model, observation, owners, part, class_bit, result.X_CP, blend, result.last.outline_bias,
                            options, scratch);
    const Vector6 step = RefinementStep(result.last, Difference(result.X_CP, start), reach, options);
    result.X_CP = Perturb(result.X_CP, step);
    if (StepLength(step, reach) < 2e-4 && k > 0) break;
  }
  return result;
}

}  // namespace coach
