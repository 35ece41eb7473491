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
constexpr double kUsualRepeats = 0.4;  // share of repeated poses from which on they are normal

constexpr int64_t kLongestFrame = 150000;  // us between two measurements that follow each other
constexpr int64_t kGlitch = 250000;        // us
constexpr double kJitter = 0.010;          // m between two measurements of one place
constexpr double kTwistJitter = 0.1;       // rad, the same
constexpr double kOtherwise = 4;           // nats by which earlier measurements show that it was otherwise before
constexpr double kClear = 0.3;             // Clarity of a measurement that dates a change
constexpr double kSlowing = 1.3;           // hands slow down before parts meet
constexpr double kTouch = 0.001;           // m that surfaces which touch are measured in each other
constexpr double kArm = 0.06;              // m over which a misplaced part is turned by what it is off

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
    const bool placed = IsPlaced(*view.a) && IsPlaced(*view.b);
    const double visible = view.inferred ? Smaller(view.evidence->visible_fraction)
                                         : std::min(view.a->visible_fraction, view.b->visible_fraction);
    if (!placed || visible < options_.smallest_visible) return {};
    WatchForJumps(view);
    if (view.evidence == nullptr) return JudgeApart(view, visible);
    const bool frozen = Frozen(view.part_a, *view.a, view.utime) || Frozen(view.part_b, *view.b, view.utime);
    if (frozen && !view.inferred) return {};
    const PairEvidence& pair = *view.evidence;
    RelativePoseWindow& window = windows_[{view.part_a, view.part_b}];
    const double overlap = std::max(0.0, -pair.surface_distance - kTouch);
    const Matrix6 misplaced = Isotropic(overlap, overlap / kArm);
    window.Add({view.utime, pair.X_AB, pair.covariance + Blur(view, visible) + misplaced, pair.motion[0],
                pair.motion[1], visible});
    const auto estimate = window.Estimate(view.utime);
    if (!estimate) return {};
    const Matrix6 covariance = estimate->covariance + misplaced;
    PairVerdict verdict;
    verdict.has_evidence = true;
    const auto& classes = Classes(view.part_a, view.part_b);
    const double weight = std::clamp(visible / options_.full_visible, 0.3, 1.0);
    double best = -1e9;
    for (const ContactClass& contact : classes) {
      double odds = LogOdds(contact, estimate->X_AB, covariance);
      if (odds > -4) odds += MovedTogether(*estimate) + ImageEvidence(contact, pair) + Pressed(pair, overlap);
      if (view.inferred) odds -= options_.inferred_price;
      odds = std::clamp(weight * odds, -options_.largest_log_odds, options_.largest_log_odds);
      verdict.log_odds.push_back(odds);
      best = std::max(best, odds);
    }
    verdict.unknown = best < -4 && !view.misfit ? UnknownContact(*estimate, pair) : -options_.largest_log_odds;
    return Credible(view, visible, verdict) ? verdict : PairVerdict{};
  }

  int64_t ChangeTime(int part_a, int part_b, int label, int former, int64_t now) const override {
    const auto found = windows_.find({part_a, part_b});
    const int contact = label >= 0 ? label : former;
    const auto& classes = Classes(part_a, part_b);
    if (found == windows_.end() || contact < 0 || contact >= static_cast<int>(classes.size())) return now;
    return ChangePoint(found->second, classes[contact], label >= 0, now);
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
    courses_.clear();
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
    if (view.decided >= 0 && (view.misfit || JumpedLately(view))) return verdict;
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

  double LogOdds(const ContactClass& contact, const Pose& X_AB, const Matrix6& covariance) const {
    const ContactError error = NearestContact(contact, X_AB);
    const Matrix6 made = covariance + Isotropic(options_.slack_position, options_.slack_angle);
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

  /// Parts can't stand in each other: measured like that they touch, as a joint's do, or are further off still, as
  /// those of a near miss would be. Half the poses around a joint are ones that can be.
  double Pressed(const PairEvidence& pair, double overlap) const {
    const double variance =
        pair.covariance.diagonal().head<3>().mean() + options_.slack_position * options_.slack_position;
    const double apart = std::erfc(overlap / std::sqrt(2 * variance));
    return std::min(options_.pressed_limit, -std::log(std::max(apart, 1e-12)));
  }

  double UnknownContact(const RelativePoseEstimate& estimate, const PairEvidence& pair) const {
    const bool moved = estimate.travel > options_.unknown_travel && estimate.constant_for >= options_.unknown_time;
    const bool touching = std::abs(pair.surface_distance) < options_.unknown_gap;
    const bool together =
        pair.relative_motion[0] < options_.unknown_slip && pair.relative_motion[1] < options_.unknown_twist;
    return moved && touching && together ? options_.largest_log_odds : -2;
  }

  static double Smaller(const std::array<double, 2>& x) { return std::min(x[0], x[1]); }
  static double Speed(const PairView& view) {
    return std::max(view.a->velocity.head<3>().norm(), view.b->velocity.head<3>().norm());
  }

  /// What a fast or hardly visible part is worse measured than its covariance says.
  Matrix6 Blur(const PairView& view, double visible) const {
    const double speed = Speed(view), hidden = options_.hidden_blur * std::clamp(1 - visible, 0.0, 1.0);
    return Isotropic(std::hypot(options_.blur_time * speed, hidden), options_.blur_turn * speed);
  }

  /// A part that leaves its joint, or turns over in it, from one frame to the next is one that the tracker lost.
  void WatchForJumps(const PairView& view) {
    Course& course = courses_[{view.part_a, view.part_b}];
    const Pose X_AB = view.evidence ? view.evidence->X_AB : view.a->X_TP.inverse() * view.b->X_TP;
    if (view.decided >= 0 && view.inferred == course.inferred && view.utime - course.utime <= kLongestFrame) {
      const ContactClass& contact = Classes(view.part_a, view.part_b)[view.decided];
      const ContactError now = NearestContact(contact, X_AB), then = NearestContact(contact, course.X_AB);
      const double passed = static_cast<double>(view.utime - course.utime) * 1e-6;
      const auto too_fast = [&](const Vector6& from, const Vector6& to) -> bool {
        const Matrix3 turn = ExpRotation(from.tail<3>()).transpose() * ExpRotation(to.tail<3>());
        return (to - from).head<3>().norm() > kJitter + options_.fastest_pull * passed ||
               RotationAngle(turn) > kTwistJitter + options_.fastest_twist * passed;
      };
      // Of two poses that look alike either may have been measured, either may be the nearest.
      const bool jumped = too_fast(then.xi, now.xi) && too_fast(then.xi, Difference(then.X_nominal, X_AB));
      if (jumped) {
        course.jumped = view.utime;
        course.astray = true;
      }
    }
    course.inferred = view.inferred;
    course.utime = view.utime;
    course.X_AB = X_AB;
  }
  /// Seen to leave its joint like that, and not seen in it since.
  bool IsAstray(const PairView& view) const { return courses_.at({view.part_a, view.part_b}).astray; }
  bool JumpedLately(const PairView& view) const {
    const Course& course = courses_.at({view.part_a, view.part_b});
    return static_cast<double>(view.utime - course.jumped) * 1e-6 < options_.jump_time;
  }

  /// Whether this one measurement is what the decided joint may look like. A lasting error on its surface turns a
  /// smaller part further.
  bool SeenClosed(const PairView& view, double visible) const {
    const ContactClass& contact = Classes(view.part_a, view.part_b)[view.decided];
    const bool small = contact.arm > 0 && contact.arm < kArm;
    const double twist = small ? options_.slack_angle * kArm / contact.arm : 0;
    const Matrix6 single = view.evidence->covariance + Blur(view, visible) + Isotropic(0, twist);
    return LogOdds(contact, view.evidence->X_AB, single) > 0;
  }

  /// Tracking errors last, so no number of frames that show a made joint open proves it open: the measurement itself
  /// has to be one that a tracker which still has both parts can give.
  bool Credible(const PairView& view, double visible, const PairVerdict& verdict) {
    const double best =
        verdict.log_odds.empty() ? 0 : *std::max_element(verdict.log_odds.begin(), verdict.log_odds.end());
    if (view.decided < 0) return !view.misfit || best > 0;
    const bool closed = SeenClosed(view, visible);
    if (closed) courses_.at({view.part_a, view.part_b}).astray = false;
    if (verdict.log_odds[view.decided] > 0) return true;
    if (closed) return false;  // the window may still be full of what a part looked like while it was covered
    if (view.misfit || visible < options_.break_visible) return false;
    if (JumpedLately(view)) return false;
    if (view.evidence->surface_distance > options_.clear_gap) return true;
    return !IsAstray(view) && !view.pressed && Speed(view) < options_.calm_speed;
  }

  /// Maximum likelihood of the moment from which on the pair was (or was no longer) in the class: the start of the
  /// stretch up to now over which the log odds of the single measurements sum up to most. What is hardly visible counts
  /// little.
  int64_t ChangePoint(const RelativePoseWindow& window, const ContactClass& contact, bool arrives, int64_t now) const {
    const auto& samples = window.samples();
    double sum = 0, largest = 0;
    size_t first = samples.size();  // of the stretch
    int64_t later = now;
    for (size_t i = samples.size(); i-- > 0;) {
      const double odds = LogOdds(contact, samples[i].X_AB, samples[i].covariance);
      const double share =
          std::min(1.0, static_cast<double>(later - samples[i].utime) * 1e-6 / options_.correlation_time);
      sum += Clarity(samples[i]) * share *
             std::clamp(arrives ? odds : -odds, -options_.dating_limit, options_.dating_limit);
      later = samples[i].utime;
      if (sum < largest - kOtherwise) break;
      if (sum < largest) continue;
      largest = sum;
      first = i;
    }
    if (first == samples.size()) return now;
    size_t before = first;  // the last measurement in front of it that says something
    while (before > 0 && Clarity(samples[--before]) < kClear) {
    }
    while (first + 1 < samples.size() && Clarity(samples[first]) < kClear) ++first;
    if (before >= first) return samples[first].utime;
    return arrives ? Meeting(samples, before, samples[first].utime, contact)
                   : (samples[before].utime + samples[first].utime) / 2;
  }

  /// 0..1, how much a measurement is worth by what was visible.
  double Clarity(const RelativePoseSample& s) const {
    return std::clamp((s.visible - options_.smallest_visible) / (options_.dating_visible - options_.smallest_visible),
                      0.0, 1.0);
  }

  /// When two parts met that were last seen apart and coming together, before they were seen joined at `seen`: at the
  /// pace they had. With no such pace the middle of the time between is the least wrong.
  int64_t Meeting(const std::deque<RelativePoseSample>& samples, size_t last, int64_t seen,
                  const ContactClass& contact) const {
    const int64_t from = samples[last].utime;
    const auto distance = [&](size_t i) -> double {
      return NearestContact(contact, samples[i].X_AB).xi.head<3>().norm();
    };
    const double left = distance(last);
    double pace = 0;
    for (size_t i = last; i-- > 0 && from - samples[i].utime <= kGlitch;) {
      const double passed = static_cast<double>(from - samples[i].utime) * 1e-6;
      if (Clarity(samples[i]) >= kClear) pace = std::max(pace, (distance(i) - left) / passed);
    }
    if (pace < options_.least_approach) return (from + seen) / 2;
    return std::min(seen, from + static_cast<int64_t>(kSlowing * left / pace * 1e6));
  }

  /// The last relative pose, whatever it was worth.
  struct Course {
    int64_t utime = INT64_MIN / 2;
    Pose X_AB = Pose::Identity();
    bool inferred = false;
    int64_t jumped = INT64_MIN / 2;  ///< us, when a believed joint last opened as no hand can open it
    bool astray = false;             ///< and the pair was not seen in the joint since
  };

  const Task& task_;
  const ContactTable& contacts_;
  CoachConnectionModelOptions options_;
  std::map<std::pair<int, int>, RelativePoseWindow> windows_;
  std::map<int, Repeats> repeats_;
  std::map<std::pair<int, int>, Course> courses_;
};

}  // namespace

std::unique_ptr<ConnectionModel> MakeCoachConnectionModel(const Task& task, const ContactTable& contacts,
                                                          const CoachConnectionModelOptions& options) {
  return std::make_unique<CoachConnectionModel>(task, contacts, options);
}

}  // namespace coach
