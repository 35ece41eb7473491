#include "services/assembly_reasoner/assembly_belief.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

constexpr double kNeverSeen = -6;     // nats: parts are apart until something says otherwise
constexpr double kTold = 3;           // nats, of what was decided without evidence
constexpr double kContrary = -4;      // nats, evidence below this speaks against an implied joint
constexpr double kLongestStep = 0.1;  // s, by which evidence of one frame can replace what was before

/// Position of a label in PairBelief::probability.
size_t Index(const PairBelief& belief, int label) {
  const size_t classes = belief.is_connection.size();
  return label >= 0 ? static_cast<size_t>(label) : label == kUnknownLabel ? classes : classes + 1;
}

int LabelAt(const PairBelief& belief, size_t index) {
  const size_t classes = belief.is_connection.size();
  return index < classes ? static_cast<int>(index) : index == classes ? kUnknownLabel : kOpenLabel;
}

}  // namespace

void AssemblyBelief::Observe(const PairKey& pair, const PairVerdict& verdict, const std::vector<bool>& is_connection,
                             int64_t utime) {
  PairBelief& belief = pairs_[pair];
  if (belief.log_odds.empty()) {
    belief.is_connection = is_connection;
    belief.log_odds.assign(is_connection.size() + 1, kNeverSeen);
  }
  if (!verdict.has_evidence) return;
  double share = 1;
  if (options_.forgetting_time > 0) {
    const double passed =
        belief.last_evidence == 0 ? 1.0 / 30 : static_cast<double>(utime - belief.last_evidence) * 1e-6;
    share = 1 - std::exp(-std::min(passed, kLongestStep) / options_.forgetting_time);
  }
  belief.last_evidence = utime;
  for (size_t i = 0; i < belief.log_odds.size(); ++i) {
    const double now = i < verdict.log_odds.size() ? verdict.log_odds[i] : std::max(verdict.unknown, -12.0);
    belief.log_odds[i] += share * (now - belief.log_odds[i]);
  }
}

double AssemblyBelief::Price(const PairBelief& belief, size_t label) const {
  if (Index(belief, belief.decided) == label) return -options_.stickiness;
  if (label == belief.is_connection.size()) return options_.price_unknown;
  return belief.is_connection[label] ? options_.price_connection : options_.price_mistake;
}

void AssemblyBelief::Infer(const std::map<PairKey, int>& implied) {
  for (auto& [pair, belief] : pairs_) {
    std::vector<double> score;
    for (size_t i = 0; i < belief.log_odds.size(); ++i) score.push_back(belief.log_odds[i] - Price(belief, i));
    score.push_back(0);  // open
    const auto follows = implied.find(pair);
    if (follows != implied.end()) {
      const size_t i = Index(belief, follows->second);
      const bool unseen = belief.last_evidence == 0;
      if (unseen || belief.log_odds[i] > kContrary) score[i] = std::max(score[i], 0.0) + options_.implied_odds;
    }
    const double largest = *std::max_element(score.begin(), score.end());
    double sum = 0;
    for (double& s : score) sum += s = std::exp(s - largest);
    for (double& s : score) s /= sum;
    belief.probability = std::move(score);
  }
}

double AssemblyBelief::Probability(const PairKey& pair, int label) const {
  const auto found = pairs_.find(pair);
  if (found == pairs_.end() || found->second.probability.empty()) return label == kOpenLabel ? 1 : 0;
  return found->second.probability[Index(found->second, label)];
}

int AssemblyBelief::Best(const PairKey& pair) const {
  const auto found = pairs_.find(pair);
  if (found == pairs_.end() || found->second.probability.empty()) return kOpenLabel;
  const auto& p = found->second.probability;
  return LabelAt(found->second, static_cast<size_t>(std::max_element(p.begin(), p.end()) - p.begin()));
}

void AssemblyBelief::Decide(const PairKey& pair, int label) {
  PairBelief& belief = pairs_.at(pair);
  belief.decided = label;
  if (label == kOpenLabel) return;
  // Decided by another source than the images (operator, stored state): believed until they say otherwise.
  double& odds = belief.log_odds[Index(belief, label)];
  odds = std::max(odds, kTold);
}

void AssemblyBelief::Exchange(int i, int j) {
  const auto other = [&](int k) { return k == i ? j : k == j ? i : k; };
  std::map<PairKey, PairBelief> exchanged;
  for (auto& [pair, belief] : pairs_) {
    const PairKey key = std::minmax(other(pair.first), other(pair.second));
    exchanged.emplace(key, std::move(belief));
  }
  pairs_ = std::move(exchanged);
}

}  // namespace coach
