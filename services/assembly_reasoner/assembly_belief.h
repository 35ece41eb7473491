// Belief over the reachable states of the assembly: which pairs of parts are joined, and how.
//
// A hidden Markov model with exponential forgetting. A state gives every pair of parts a label: open, one of its
// contact classes, or an unknown contact. The model's log odds are the evidence of a label over the last moment, so
// they replace older evidence at a rate instead of adding up (successive frames are not independent); a decided label
// is sticky, a new one has a price. The posterior is kept as a product over pairs, coupled where geometry couples them:
// the last joint of a ring follows from the others, unless the two parts are seen not to stand at the joint's pose.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "services/assembly_reasoner/connection_model.h"

namespace coach {

constexpr int kOpenLabel = -1;
constexpr int kUnknownLabel = -2;  ///< a rigid contact in no class

struct AssemblyBeliefOptions {
  double forgetting_time = 0.04;  ///< s, in which new evidence replaces old; 0: at once
  double price_connection = 0.7;  ///< nats against a connection of the task that is not yet decided
  double price_mistake = 0.5;     ///< nats, the same for a mistake
  double price_unknown = 4.0;     ///< nats, the same for an unknown contact
  double stickiness = 2.0;        ///< nats for a label that is decided
  double implied_odds = 6.0;      ///< nats of a joint that the rest of its ring makes
};

/// Two parts, first < second.
using PairKey = std::pair<int, int>;

struct PairBelief {
  std::vector<double> log_odds;     ///< smoothed; classes of the pair, then unknown
  std::vector<bool> is_connection;  ///< of the classes: a connection of the task, else a mistake
  std::vector<double> probability;  ///< the same labels, then open
  int decided = kOpenLabel;
  int64_t last_evidence = 0;  ///< us; 0 never
};

class AssemblyBelief {
 public:
  explicit AssemblyBelief(const AssemblyBeliefOptions& options = {}) : options_(options) {}

  /// @param is_connection for each class of the pair: is it a connection of the task (else a mistake)
  void Observe(const PairKey& pair, const PairVerdict& verdict, const std::vector<bool>& is_connection, int64_t utime);
  /// Works out the probabilities after all pairs of a frame were observed.
  /// @param implied pairs with the class that follows from the joints decided so far
  void Infer(const std::map<PairKey, int>& implied);

  /// Probability of a label (class index, kOpenLabel or kUnknownLabel).
  double Probability(const PairKey& pair, int label) const;
  /// The most probable label.
  int Best(const PairKey& pair) const;
  void Decide(const PairKey& pair, int label);
  void Exchange(int i, int j);

  const std::map<PairKey, PairBelief>& pairs() const { return pairs_; }

 private:
  double Price(const PairBelief& belief, size_t label) const;

  AssemblyBeliefOptions options_;
  std::map<PairKey, PairBelief> pairs_;
};

}  // namespace coach
