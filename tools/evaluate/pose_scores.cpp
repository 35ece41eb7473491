#include "tools/evaluate/pose_scores.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace coach {
namespace {

constexpr double kSeen = 0.1, kOn = 0.3, kClear = 0.5, kHidden = 0.05;  // visible fractions
constexpr double kGoodMm = 20, kGoodDeg = 10, kLostMm = 50, kBackMm = 10;
constexpr double kSwapMargin = 40;  // mm: two parts, 20 each
constexpr double kChi2_95 = 7.815;  // three degrees of freedom

using Assignment = std::vector<int>;  // by part: slot

double PositionError(const SceneTruth& truth, const Estimates& e, int frame, int part, int slot) {
  const auto& X = e.X_CP[static_cast<size_t>(frame)][static_cast<size_t>(slot)];
  if (!X) return kNoEstimate;
  return 1000 *
         (X->translation() - truth.X_CP[static_cast<size_t>(frame)][static_cast<size_t>(part)].translation()).norm();
}

double Cost(const SceneTruth& truth, const Estimates& e, int frame, int part, int slot) {
  return std::min(200.0, PositionError(truth, e, frame, part, slot));
}

/// The assignment of a kind's members to its slots with the least total cost over the frames; ties: the first.
std::vector<int> BestPermutation(const SceneTruth& truth, const Estimates& e, const std::vector<int>& kind,
                                 const std::vector<int>& frames) {
  std::vector<int> permutation = kind, best = kind;
  double least = std::numeric_limits<double>::infinity();
  do {
    double sum = 0;
    for (const int f : frames) {
      for (size_t i = 0; i < kind.size(); ++i) sum += Cost(truth, e, f, kind[i], permutation[i]);
    }
    if (sum < least) least = sum, best = permutation;
  } while (std::next_permutation(permutation.begin(), permutation.end()));
  return best;
}

Assignment FixedAssignment(const SceneTruth& truth, const Estimates& e) {
  Assignment slots(static_cast<size_t>(truth.parts()));
  std::iota(slots.begin(), slots.end(), 0);
  for (const auto& kind : truth.Kinds()) {
    if (kind.size() < 2) continue;
    std::vector<int> frames;
    for (int f = 0; f < truth.frames() && static_cast<int>(frames.size()) < static_cast<int>(truth.fps); ++f) {
      const size_t i = static_cast<size_t>(f);
      const bool seen = std::all_of(kind.begin(), kind.end(),
                                    [&](int k) { return truth.visible[i][static_cast<size_t>(k)] >= kSeen; });
      const bool any =
          std::any_of(kind.begin(), kind.end(), [&](int k) { return e.X_CP[i][static_cast<size_t>(k)].has_value(); });
      if (seen && any) frames.push_back(f);
    }
    const auto best = BestPermutation(truth, e, kind, frames);
    for (size_t i = 0; i < kind.size(); ++i) slots[static_cast<size_t>(kind[i])] = best[i];
  }
  return slots;
}

int CountSwitches(const SceneTruth& truth, const Estimates& e, Assignment slots) {
  int switches = 0;
  for (int f = 0; f < truth.frames(); ++f) {
    for (const auto& kind : truth.Kinds()) {
      if (kind.size() < 2) continue;
      const auto best = BestPermutation(truth, e, kind, {f});
      double current = 0, least = 0;
      for (size_t i = 0; i < kind.size(); ++i) {
        current += Cost(truth, e, f, kind[i], slots[static_cast<size_t>(kind[i])]);
        least += Cost(truth, e, f, kind[i], best[i]);
      }
      if (least >= current - (f > 0 ? kSwapMargin : 0)) continue;
      switches += f > 0;
      for (size_t i = 0; i < kind.size(); ++i) slots[static_cast<size_t>(kind[i])] = best[i];
    }
  }
  return switches;
}

double AddS(const TrueObject& object, const Pose& X, const Pose& Y) {
  double sum = 0;
  // Of the poses that look the same the nearest, so that the finite number of points makes no difference.
  const Pose X_YX = Y.inverse() * NearestEquivalent(object.symmetries, X, Y);
  for (const Vector3& q : object.surface) {
    double nearest = 1e9;
    for (const Vector3& p : object.surface) nearest = std::min(nearest, (X_YX * p - q).squaredNorm());
    sum += std::sqrt(nearest);
  }
  return 1000 * sum / static_cast<double>(object.surface.size());
}

bool Good(const PoseErrors& errors, size_t part, size_t frame) {
  return errors.position_mm[part][frame] < kGoodMm && errors.rotation_deg[part][frame] < kGoodDeg;
}

void FindLosses(const SceneTruth& truth, const PoseErrors& errors, PoseScores* scores) {
  for (int k = 0; k < truth.parts(); ++k) {
    std::vector<int> run;  // frames without sight neither start nor end a loss
    const auto end = [&] {
      if (run.size() >= 3) {
        scores->losses.push_back({k, run.front() / truth.fps, run.back() / truth.fps});
        scores->lost_seconds += static_cast<double>(run.size()) / truth.fps;
      }
      run.clear();
    };
    for (int f = 0; f < truth.frames(); ++f) {
      if (truth.visible[static_cast<size_t>(f)][static_cast<size_t>(k)] < kSeen) continue;
      if (errors.position_mm[static_cast<size_t>(k)][static_cast<size_t>(f)] > kLostMm) {
        run.push_back(f);
      } else {
        end();
      }
    }
    end();
  }
}

void FindRecoveries(const SceneTruth& truth, const PoseErrors& errors, PoseScores* scores) {
  const int n = truth.frames();
  for (int k = 0; k < truth.parts(); ++k) {
    const auto visible = [&](int f) { return truth.visible[static_cast<size_t>(f)][static_cast<size_t>(k)]; };
    const auto back = [&](int f) {
      return errors.position_mm[static_cast<size_t>(k)][static_cast<size_t>(f)] < kBackMm;
    };
    int hidden = 0;
    for (int f = 0; f < n - 3; ++f) {
      if (visible(f) < kHidden) {
        ++hidden;
      } else if (hidden >= 0.3 * truth.fps && visible(f) >= kOn && visible(f + 1) >= kOn && visible(f + 2) >= kOn) {
        Recovery r{k, (f + 2) / truth.fps, std::nullopt};
        for (int g = f + 2; g < n - 3 && !r.after; ++g) {
          if (back(g) && back(g + 1) && back(g + 2)) r.after = (g - f - 2) / truth.fps;
        }
        scores->recoveries.push_back(r);
        hidden = 0;
      } else if (visible(f) >= kOn) {
        hidden = 0;
      }
    }
  }
}

/// The naming of equal parts that is best over the whole scene.
Assignment WholeSceneAssignment(const SceneTruth& truth, const Estimates& e) {
  Assignment slots(static_cast<size_t>(truth.parts()));
  for (const auto& kind : truth.Kinds()) {
    std::vector<int> permutation = kind, best = kind;
    double least = std::numeric_limits<double>::infinity();
    do {
      double sum = 0;
      for (int f = 0; f < truth.frames(); ++f) {
        for (size_t i = 0; i < kind.size(); ++i) {
          const double error = PositionError(truth, e, f, kind[i], permutation[i]);
          if (std::isfinite(error)) sum += std::min(100.0, error);
        }
      }
      if (sum < least) least = sum, best = permutation;
    } while (std::next_permutation(permutation.begin(), permutation.end()));
    for (size_t i = 0; i < kind.size(); ++i) slots[static_cast<size_t>(kind[i])] = best[i];
  }
  return slots;
}

double LongestSwap(const SceneTruth& truth, const Estimates& e, const Assignment& slots) {
  const auto error = [&](int f, int part, int other) {
    return PositionError(truth, e, f, part, slots[static_cast<size_t>(other)]);
  };
  int longest = 0;
  for (const auto& kind : truth.Kinds()) {
    for (size_t i = 0; i < kind.size(); ++i) {
      for (size_t j = i + 1; j < kind.size(); ++j) {
        int run = 0;
        for (int f = 0; f < truth.frames(); ++f) {
          const double own = error(f, kind[i], kind[i]) + error(f, kind[j], kind[j]);
          const double cross = error(f, kind[j], kind[i]) + error(f, kind[i], kind[j]);
          run = cross + kSwapMargin < own ? run + 1 : 0;
          longest = std::max(longest, run);
        }
      }
    }
  }
  return longest / truth.fps;
}

void ScoreHonesty(const SceneTruth& truth, const Estimates& e, PoseScores* scores) {
  if (e.states.empty()) return;
  const Assignment slots = WholeSceneAssignment(truth, e);
  int wrong = 0;
  std::array<int, 2> inside{}, all{};  // hidden, visible
  for (int f = 0; f < truth.frames(); ++f) {
    for (int k = 0; k < truth.parts(); ++k) {
      const size_t i = static_cast<size_t>(f), slot = static_cast<size_t>(slots[static_cast<size_t>(k)]);
      const auto& state = e.states[i][slot];
      if (!state) continue;
      if (state->status == "tracked") {
        ++scores->tracked_frames;
        wrong += PositionError(truth, e, f, k, static_cast<int>(slot)) > kGoodMm;
      }
      const Matrix3 S = state->covariance.topLeftCorner<3, 3>();
      if (!S.allFinite() || !(S.determinant() * 1e18 > 0) || !e.X_CP[i][slot]) continue;
      const Vector3 d = e.X_CP[i][slot]->translation() - truth.X_CP[i][static_cast<size_t>(k)].translation();
      const size_t seen = truth.visible[i][static_cast<size_t>(k)] >= kOn ? 1 : 0;
      inside[seen] += d.dot(S.partialPivLu().solve(d)) <= kChi2_95;
      ++all[seen];
    }
  }
  if (scores->tracked_frames > 0) scores->wrong_while_tracked = 100.0 * wrong / scores->tracked_frames;
  if (all[1] > 0) scores->coverage_visible = 100.0 * inside[1] / all[1];
  if (all[0] > 0) scores->coverage_hidden = 100.0 * inside[0] / all[0];
}

double Percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0; }

}  // namespace

double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const size_t below = static_cast<size_t>(at), above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

Statistics Summarise(std::vector<double> values) {
  Statistics s;
  s.n = static_cast<int>(values.size());
  if (values.empty()) return s;
  s.median = Quantile(values, 0.5);
  s.p95 = Quantile(values, 0.95);
  s.mean = std::accumulate(values.begin(), values.end(), 0.0) / s.n;
  s.max = *std::max_element(values.begin(), values.end());
  return s;
}

PoseErrors ComputeErrors(const SceneTruth& truth, const Estimates& e) {
  PoseErrors errors;
  errors.slot = FixedAssignment(truth, e);
  for (int k = 0; k < truth.parts(); ++k) {
    auto& position = errors.position_mm.emplace_back();
    auto& rotation = errors.rotation_deg.emplace_back();
    for (int f = 0; f < truth.frames(); ++f) {
      const int slot = errors.slot[static_cast<size_t>(k)];
      const auto& X = e.X_CP[static_cast<size_t>(f)][static_cast<size_t>(slot)];
      position.push_back(PositionError(truth, e, f, k, slot));
      rotation.push_back(X ? RotationError(truth.objects[static_cast<size_t>(k)].symmetries, X->linear(),
                                           truth.X_CP[static_cast<size_t>(f)][static_cast<size_t>(k)].linear()) *
                                 180 / M_PI
                           : kNoEstimate);
    }
  }
  return errors;
}

int Recovered(const PoseScores& s) {
  return static_cast<int>(std::count_if(s.recoveries.begin(), s.recoveries.end(),
                                        [](const Recovery& r) { return r.after && *r.after <= 0.2 + 1e-9; }));
}

std::vector<double> DistanceErrors(const SceneTruth& truth, const Estimates& e, const PoseErrors& errors) {
  std::vector<double> distances;
  if (truth.parts() < 2) return distances;
  for (size_t f = 0; f < truth.X_CP.size(); ++f) {
    const auto &a = e.X_CP[f][static_cast<size_t>(errors.slot[0])], &b = e.X_CP[f][static_cast<size_t>(errors.slot[1])];
    const double known = (truth.X_CP[f][0].translation() - truth.X_CP[f][1].translation()).norm();
    distances.push_back(a && b ? 1000 * std::abs((a->translation() - b->translation()).norm() - known) : kNoEstimate);
  }
  return distances;
}

PoseScores ScorePoses(const SceneTruth& truth, const Estimates& e, const PoseErrors& errors) {
  PoseScores s;
  std::vector<double> position, rotation, add_s, clear_position, clear_rotation;
  int seen = 0, on = 0, estimated = 0, good_seen = 0, good_on = 0;
  for (size_t k = 0; k < truth.objects.size(); ++k) {
    for (size_t f = 0; f < truth.X_CP.size(); ++f) {
      const double visible = truth.visible[f][k];
      if (visible < kSeen) continue;
      ++seen;
      on += visible >= kOn;
      if (!std::isfinite(errors.position_mm[k][f])) continue;
      ++estimated;
      good_seen += Good(errors, k, f);
      good_on += visible >= kOn && Good(errors, k, f);
      position.push_back(errors.position_mm[k][f]);
      rotation.push_back(errors.rotation_deg[k][f]);
      add_s.push_back(AddS(truth.objects[k], *e.X_CP[f][static_cast<size_t>(errors.slot[k])], truth.X_CP[f][k]));
      if (visible < kClear) continue;
      clear_position.push_back(errors.position_mm[k][f]);
      clear_rotation.push_back(errors.rotation_deg[k][f]);
    }
  }
  s.position_mm = Summarise(position), s.rotation_deg = Summarise(rotation), s.add_s_mm = Summarise(add_s);
  s.clear_position_mm = Summarise(clear_position), s.clear_rotation_deg = Summarise(clear_rotation);
  s.success_10 = Percent(good_seen, seen), s.success_30 = Percent(good_on, on), s.estimated = Percent(estimated, seen);
  FindLosses(truth, errors, &s);
  FindRecoveries(truth, errors, &s);
  s.identity_switches = CountSwitches(truth, e, errors.slot);
  s.longest_swap = LongestSwap(truth, e, WholeSceneAssignment(truth, e));
  for (size_t f = 0; f < truth.X_CP.size() && !s.start_seconds; ++f) {
    bool all = true;
    for (size_t k = 0; k < truth.objects.size(); ++k) all = all && (truth.visible[f][k] < kClear || Good(errors, k, f));
    if (all) s.start_seconds = (truth.image_ids[f] - truth.image_ids[0]) / truth.fps;
  }
  std::vector<double> distances, clear_distances;
  const auto all_distances = DistanceErrors(truth, e, errors);
  for (size_t f = 0; f < all_distances.size(); ++f) {
    if (!std::isfinite(all_distances[f])) continue;
    distances.push_back(all_distances[f]);
    if (truth.visible[f][0] >= kClear && truth.visible[f][1] >= kClear) clear_distances.push_back(all_distances[f]);
  }
  s.distance_all_mm = Summarise(distances), s.distance_mm = Summarise(clear_distances);
  ScoreHonesty(truth, e, &s);
  return s;
}

}  // namespace coach
