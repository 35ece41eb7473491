#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "services/assembly_reasoner/connection_model.h"
#include "services/assembly_reasoner/relative_pose_window.h"

namespace coach {
namespace {

/// 'Not connected' as a mixture of scales about the joint's pose: from just beside it (a near miss is aligned by table
/// and hand in all but one direction) to anywhere near. Position (m), angle (rad), weight.
struct Scale {
  double position, angle, weight;
};
constexpr std::array<Scale, 5> kOpenScales{
    {{0.006, 0.02, 0.25}, {0.015, 0.03, 0.2}, {0.006, 0.2, 0.2}, {0.02, 0.2, 0.2}, {0.06, 1.0, 0.15}}};
constexpr double kUsualRepeats = 0.4;      // share of repeated poses from which on they are normal
constexpr double kSeatedPosition = 0.004;  // m, a single measurement this near to a joint's pose agrees with it
constexpr double kSeatedAngle = 0.07;      // rad, the same

double LogNormal(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance) {
  const Eigen::LDLT<Eigen::MatrixXd> factor(covariance);
  const double log_determinant = factor.vectorD().array().max(1e-30).log().sum();
  return -0.5 * (x.dot(factor.solve(x)) + log_determinant);
}

Matrix6 Isotropic(double position, double angle) {
  Vector6 d;
  d << Vector3::Constant(position * position), Vector3::Constant(angle * angle);
  return d.asDiagonal();
}

class CoachConnectionModel : public ConnectionModel {
 public:
  CoachConnectionModel(const Task& task, const ContactTable& contacts, const CoachConnectionModelOptions& options)
      : task_(task), contacts_(contacts), options_(options) {}

  PairVerdict Judge(const PairView& view) override {
    const double visible = std::min(view.a->visible_fraction, view.b->visible_fraction);
    const bool placed = IsPlaced(*view.a) && IsPlaced(*view.b);
    if (!placed || visible < options_.smallest_visible) return {};
    if (view.evidence == nullptr) return JudgeApart(view, visible);
    if (Frozen(view.part_a, *view.a, view.utime) || Frozen(view.part_b, *view.b, view.utime)) return {};
    const PairEvidence& pair = *view.evidence;
    RelativePoseWindow& window = windows_[{view.part_a, view.part_b}];
    window.Add({view.utime, pair.X_AB, pair.covariance, pair.motion[0], pair.motion[1]});
    const auto estimate = window.Estimate(view.utime);
    if (!estimate) return {};
    PairVerdict verdict;
    verdict.has_evidence = true;
    const auto& classes = Classes(view.part_a, view.part_b);
    const double weight = std::clamp(visible / options_.full_visible, 0.3, 1.0);
    double best = -1e9;
    for (const ContactClass& contact : classes) {
      double odds = LogOdds(contact, *estimate);
      if (odds > -4) odds += MovedTogether(*estimate) + ImageEvidence(contact, pair);
      odds = std::clamp(weight * odds, -options_.largest_log_odds, options_.largest_log_odds);
      verdict.log_odds.push_back(odds);
      best = std::max(best, odds);
    }
    verdict.unknown = best < -4 ? UnknownContact(*estimate, pair) : -options_.largest_log_odds;
    return verdict;
  }

  int64_t ChangeTime(int part_a, int part_b, int label, int former, int64_t now) const override {
    const auto found = windows_.find({part_a, part_b});
    const int contact = label >= 0 ? label : former;
    const auto& classes = Classes(part_a, part_b);
    if (found == windows_.end() || contact < 0 || contact >= static_cast<int>(classes.size())) return now;
    return label >= 0 ? Arrival(found->second, classes[contact], now) : Departure(found->second, classes[contact], now);
  }

  void Exchange(int i, int j) override {
    std::map<std::pair<int, int>, RelativePoseWindow> exchanged;
    const auto other = [&](int k) { return k == i ? j : k == j ? i : k; };
    for (auto& [pair, window] : windows_) {
      std::pair<int, int> key{other(pair.first), other(pair.second)};
      if (key.first > key.second) {
        std::swap(key.first, key.second);
        window.Reverse();
      }
      exchanged.emplace(key, std::move(window));
    }
    windows_ = std::move(exchanged);
  }

 private:
  /// A pose that repeats to the last bit though it hardly ever does is a tracker that hangs, not a measurement.
  struct Repeats {
    int64_t utime = 0;
    Pose X_TP = Pose::Identity();
    double share = 0;  ///< of recent frames that repeated
    bool now = false;
  };
  bool Frozen(int part, const PartEstimate& estimate, int64_t utime) {
    Repeats& r = repeats_[part];
    if (r.utime != utime) {
      r.now = r.utime != 0 && (r.X_TP.matrix() - estimate.X_TP.matrix()).cwiseAbs().maxCoeff() < 1e-12;
      r.share += 0.03 * ((r.now ? 1 : 0) - r.share);
      r.X_TP = estimate.X_TP;
      r.utime = utime;
    }
    return r.now && r.share < kUsualRepeats;
  }
  static bool IsPlaced(const PartEstimate& part) {
    return part.status == PartStatus::kTracked || part.status == PartStatus::kOccluded;
  }
  const std::vector<ContactClass>& Classes(int part_a, int part_b) const {
    return contacts_.Classes(task_.parts[part_a].type, task_.parts[part_b].type);
  }

  /// No pair from the tracker: the surfaces are over 30 mm apart, or it could not say. Only poses far from every joint
  /// are proof, as poses may stem from an enforced connection.
  PairVerdict JudgeApart(const PairView& view, double visible) const {
    PairVerdict verdict;
    if (visible < options_.apart_visible) return verdict;
    const Pose X_AB = view.a->X_TP.inverse() * view.b->X_TP;
    for (const ContactClass& contact : Classes(view.part_a, view.part_b)) {
      const bool far = NearestContact(contact, X_AB).xi.head<3>().norm() > options_.far_distance;
      if (!far) return {};
      verdict.log_odds.push_back(-options_.largest_log_odds);
    }
    verdict.has_evidence = true;
    verdict.unknown = -options_.largest_log_odds;
    return verdict;
  }

  double LogOdds(const ContactClass& contact, const RelativePoseEstimate& estimate) const {
    const ContactError error = NearestContact(contact, estimate.X_AB);
    const Matrix6 made = estimate.covariance + Isotropic(options_.slack_position, options_.slack_angle);
    // Only in the directions in which the joint holds.
    const auto& N = error.constrained;
    const auto log_normal = [&](const Matrix6& C) -> double {
      return LogNormal(N.transpose() * error.xi, N.transpose() * C * N);
    };
    const double log_made = log_normal(made);
    double open = 0, largest = -1e300;
    std::array<double, kOpenScales.size()> logs{};
    for (size_t i = 0; i < kOpenScales.size(); ++i) {
      const Scale& s = kOpenScales[i];
      logs[i] = std::log(s.weight) + log_normal(made + Isotropic(s.position, s.angle));
      largest = std::max(largest, logs[i]);
    }
    for (const double l : logs) open += std::exp(l - largest);
    return log_made - (largest + std::log(open));
  }

  double MovedTogether(const RelativePoseEstimate& estimate) const {
    const bool moved = estimate.travel > options_.together_travel || estimate.turn > options_.together_turn;
    return moved && estimate.constant_for >= options_.together_time ? options_.together_bonus : 0;
  }

  double ImageEvidence(const ContactClass& contact, const PairEvidence& pair) const {
    const auto& list = pair.candidate_kind == CandidateKind::kConnection ? contact.connections : contact.mistakes;
    if (pair.candidate_kind == CandidateKind::kNone) return 0;
    if (std::find(list.begin(), list.end(), pair.candidate) == list.end() || !std::isfinite(pair.log_evidence))
      return 0;
    return std::clamp(options_.image_weight * pair.log_evidence, -options_.image_limit, options_.image_limit);
  }

  double UnknownContact(const RelativePoseEstimate& estimate, const PairEvidence& pair) const {
    const bool moved = estimate.travel > options_.unknown_travel && estimate.constant_for >= options_.unknown_time;
    const bool touching = std::abs(pair.surface_distance) < options_.unknown_gap;
    return moved && touching ? options_.largest_log_odds : -2;
  }

  /// Whether a single measurement agrees with the joint.
  bool Agrees(const ContactClass& contact, const RelativePoseSample& s) const {
    const ContactError error = NearestContact(contact, s.X_AB);
    const Matrix6 spread = s.covariance + Isotropic(options_.slack_position, options_.slack_angle);
    const double position = std::sqrt(spread.topLeftCorner<3, 3>().trace() / 3);
    const double angle = std::sqrt(spread.bottomRightCorner<3, 3>().trace() / 3);
    return error.xi.head<3>().norm() < std::max(kSeatedPosition, 3 * position) &&
           error.xi.tail<3>().norm() < std::max(kSeatedAngle, 3 * angle);
  }

  /// Walks back from now while measurements agree; two in three may be glitches for a quarter of a second.
  static constexpr int64_t kGlitch = 250000;
  int64_t Arrival(const RelativePoseWindow& window, const ContactClass& contact, int64_t now) const {
    int64_t first = now, last_against = -1;
    const auto& samples = window.samples();
    for (auto s = samples.rbegin(); s != samples.rend(); ++s) {
      if (Agrees(contact, *s)) {
        first = s->utime;
        last_against = -1;
      } else {
        if (last_against < 0) last_against = s->utime;
        if (first - s->utime > kGlitch) break;
      }
    }
    // Nothing was seen between the last measurement against and the first for: the middle is the least wrong.
    return last_against >= 0 ? (first + last_against) / 2 : first;
  }
  int64_t Departure(const RelativePoseWindow& window, const ContactClass& contact, int64_t now) const {
    int64_t first_against = now;
    const auto& samples = window.samples();
    for (auto s = samples.rbegin(); s != samples.rend(); ++s) {
      if (!Agrees(contact, *s)) {
        first_against = s->utime;
      } else if (first_against - s->utime > 0) {
        return (first_against + s->utime) / 2;
      }
    }
    return first_against;
  }

  const Task& task_;
  const ContactTable& contacts_;
  CoachConnectionModelOptions options_;
  std::map<std::pair<int, int>, RelativePoseWindow> windows_;
  std::map<int, Repeats> repeats_;
};

}  // namespace

std::unique_ptr<ConnectionModel> MakeCoachConnectionModel(const Task& task, const ContactTable& contacts,
                                                          const CoachConnectionModelOptions& options) {
  return std::make_unique<CoachConnectionModel>(task, contacts, options);
}

}  // namespace coach
