#include "services/assembly_reasoner/relative_pose_window.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace coach {
namespace {

constexpr double kMicro = 1e-6;
constexpr int64_t kMotionTime = 500000;     // us, over which PairEvidence::motion is measured
constexpr double kMedianVariance = 1.57;    // pi / 2: variance of a median over that of a mean, normal errors
constexpr double kTrim = 2.5;               // robust deviations from the median beyond which a sample does not count
constexpr double kGrowth = 1.2;             // of the windows that are tried
constexpr double kMadToDeviation = 1.4826;  // of normal errors
constexpr double kLongestStep = 0.1;        // s, a longer gap between samples covers no more time than this

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Variance of the mean over `spans` correlation times of an Ornstein-Uhlenbeck process of variance 1.
double VarianceOfMean(double spans) {
  if (spans < 1e-3) return 1;
  return 2 / spans * (1 - (1 - std::exp(-spans)) / spans);
}

struct Summary {
  Vector6 median = Vector6::Zero();
  Vector6 trimmed_mean = Vector6::Zero();
  Vector6 deviation = Vector6::Zero();  ///< robust
};

Summary Summarise(const std::vector<Vector6>& x, size_t begin, size_t end) {
  Summary s;
  std::vector<double> values(end - begin);
  for (int axis = 0; axis < 6; ++axis) {
    for (size_t i = begin; i < end; ++i) values[i - begin] = x[i][axis];
    s.median[axis] = Median(values);
    for (size_t i = begin; i < end; ++i) values[i - begin] = std::abs(x[i][axis] - s.median[axis]);
    s.deviation[axis] = kMadToDeviation * Median(values);
    double sum = 0;
    int n = 0;
    for (size_t i = begin; i < end; ++i) {
      if (std::abs(x[i][axis] - s.median[axis]) > kTrim * s.deviation[axis] + 1e-9) continue;
      sum += x[i][axis];
      ++n;
    }
    s.trimmed_mean[axis] = sum / n;
  }
  return s;
}

/// The mean reported covariance, widened axis by axis to the spread that was seen.
Matrix6 Widened(const Matrix6& reported, const Vector6& deviation) {
  Vector6 factor;
  for (int i = 0; i < 6; ++i) factor[i] = std::max(1.0, deviation[i] / std::sqrt(reported(i, i)));
  return factor.asDiagonal() * reported * factor.asDiagonal();
}

}  // namespace

void RelativePoseWindow::Add(const RelativePoseSample& sample) {
  if (!sample.covariance.allFinite() || !sample.X_AB.matrix().allFinite()) return;
  if (!(sample.covariance.diagonal().minCoeff() > 0)) return;
  if (!samples_.empty()) {
    if (sample.utime <= samples_.back().utime) return;
    if ((sample.X_AB.matrix() - samples_.back().X_AB.matrix()).cwiseAbs().maxCoeff() < 1e-9) return;
  }
  samples_.push_back(sample);
  const int64_t oldest = sample.utime - static_cast<int64_t>(options_.history / kMicro);
  while (samples_.front().utime < oldest) samples_.pop_front();
}

bool RelativePoseWindow::Changed(const std::vector<Vector6>& x, size_t split, const Matrix6& covariance,
                                 double spans) const {
  const double share = static_cast<double>(split) / static_cast<double>(x.size());
  const double variance = kMedianVariance * (VarianceOfMean(spans * share) + VarianceOfMean(spans * (1 - share)));
  const Vector6 change = Summarise(x, 0, split).median - Summarise(x, split, x.size()).median;
  for (int i = 0; i < 6; ++i) {
    const double floor = i < 3 ? options_.change_position : options_.change_angle;
    if (std::abs(change[i]) > floor + options_.change_sigmas * std::sqrt(variance * covariance(i, i))) return true;
  }
  return false;
}

std::optional<RelativePoseEstimate> RelativePoseWindow::Estimate(int64_t now) const {
  std::optional<RelativePoseEstimate> best;
  if (samples_.empty()) return best;
  const Pose& reference = samples_.back().X_AB;
  std::vector<Vector6> x;  // newest first, grows with the window
  Matrix6 sum = Matrix6::Zero();
  size_t next = samples_.size();
  for (double window = options_.shortest; window <= options_.longest * 1.001; window *= kGrowth) {
    const int64_t begin = now - static_cast<int64_t>(window / kMicro);
    for (; next > 0 && samples_[next - 1].utime > begin; --next) {
      const RelativePoseSample& s = samples_[next - 1];
      x.push_back(Difference(reference, s.X_AB));
      sum += s.covariance;
    }
    if (x.empty()) return best;
    const Matrix6 mean_covariance = sum / static_cast<double>(x.size());
    const Summary all = Summarise(x, 0, x.size());
    const Matrix6 wide = Widened(mean_covariance, all.deviation);
    double covered = 0;
    for (size_t i = next; i + 1 < samples_.size(); ++i)
      covered += std::min(kLongestStep, static_cast<double>(samples_[i + 1].utime - samples_[i].utime) * kMicro);
    const double spans = covered / options_.correlation_time;
    if (best && x.size() >= 4 && Changed(x, x.size() / 2, mean_covariance, spans)) return best;
    // A change near either end moves no median of a half.
    const size_t quarter = x.size() / 4;
    if (best && quarter >= 3 && Changed(x, quarter, mean_covariance, spans)) return best;
    if (best && quarter >= 3 && Changed(x, x.size() - quarter, mean_covariance, spans)) return best;
    RelativePoseEstimate estimate;
    estimate.X_AB = Perturb(reference, all.trimmed_mean);
    estimate.covariance = wide * VarianceOfMean(spans);
    estimate.constant_for = covered;
    // A sample's motion is that of the half second before it, which has to lie in the window.
    for (size_t i = next; i < samples_.size(); ++i) {
      if (samples_[i].utime < samples_[next].utime + kMotionTime) continue;
      estimate.travel = std::max(estimate.travel, samples_[i].travel);
      estimate.turn = std::max(estimate.turn, samples_[i].turn);
    }
    best = estimate;
  }
  return best;
}

void RelativePoseWindow::Reverse() {
  for (RelativePoseSample& s : samples_) {
    const Pose X_BA = s.X_AB.inverse();
    // d(X_BA): rotation -R^T w, position -R^T (dp - w x p) of the perturbation (dp, w) of X_AB.
    const Vector3 p = s.X_AB.translation();
    Matrix3 P;
    P << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = -X_BA.linear();
    J.topRightCorner<3, 3>() = -X_BA.linear() * P;
    J.bottomRightCorner<3, 3>() = -X_BA.linear();
    s.covariance = J * s.covariance * J.transpose();
    s.X_AB = X_BA;
  }
}

}  // namespace coach
