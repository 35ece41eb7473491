// From poses to connections: one Step a frame of PART_POSES. No clock, no files, no bus; deterministic.
//
//   AssemblyReasoner reasoner(LoadTask("task.yaml"), {});
//   for (const PartPoses& poses : stream) {
//     const ReasonerOutput out = reasoner.Step(poses);
//     ...out.events, out.state, out.belief
//   }
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/assembly/assembly_state.h"
#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"
#include "services/assembly_reasoner/assembly_belief.h"
#include "services/assembly_reasoner/connection_model.h"
#include "services/assembly_reasoner/hidden_parts.h"
#include "services/assembly_reasoner/task_progress.h"

namespace coach {

struct AssemblyReasonerOptions {
  bool paper = false;  ///< the paper's model [1]-[2] by itself: no memory, threshold one half, decided at once
  CoachConnectionModelOptions model;
  AssemblyBeliefOptions belief;
  HiddenPartOptions hidden;
  double deepest_overlap = 0.005;   ///< m that the measured surfaces of two parts may stand in each other
  double break_overlap = 0.0025;    ///< m, the same for a joint of one of them to be seen to come apart
  double decide_probability = 0.9;  ///< of a new label
  double decide_hold = 0.07;        ///< s it has to last
  double wrong_hold = 0.30;         ///< s, the same for a mistake
  double undo_hold = 0.22;          ///< s, the same for a connection coming apart
};

/// One line of the events csv of docs/formats.md.
struct ConnectionEvent {
  int64_t since = 0;    ///< us, estimated moment of the change
  int64_t decided = 0;  ///< us, when it was decided
  std::string type;     ///< connect, wrong, disconnect
  std::string name;     ///< of the connection or mistake; "unknown"
  int part_a = -1, part_b = -1;
  double probability = 0;
};

/// A joint that is believed.
struct BelievedJoint {
  int part_a = 0, part_b = 0;
  int label = kOpenLabel;          ///< contact class of the pair's types, or kUnknownLabel
  int connection = -1;             ///< index into Task::connections where it stands in the task; -1 it is a mistake
  int mistake = -1;                ///< index into Task::mistakes; -1 with connection -1: an unknown contact
  int64_t since = 0, decided = 0;  ///< us
  bool announced = false;          ///< its event was given out
};

struct ReasonerOutput {
  bool accepted = true;  ///< false: the poses were refused and nothing changed
  std::string refused;   ///< why
  std::vector<ConnectionEvent> events;
  AssemblyState state;  ///< utime, task, step, made, required, connections; the lesson's fields are left
  ConnectionBelief belief;
};

/// What has to survive a restart.
struct AssemblyMemory {
  std::vector<BelievedJoint> joints;
  std::map<PairKey, int> pinned;  ///< labels that the operator set and evidence has not confirmed yet
  int variant = 0;
};

class AssemblyReasoner {
 public:
  explicit AssemblyReasoner(Task task, const AssemblyReasonerOptions& options = {});
  ~AssemblyReasoner();
  AssemblyReasoner(const AssemblyReasoner&) = delete;
  AssemblyReasoner& operator=(const AssemblyReasoner&) = delete;

  /// Poses must come in the order of time; those that do not, that have another number of parts than the task or poses
  /// that are not finite are refused.
  ReasonerOutput Step(const PartPoses& poses);

  /// The operator knows better: the connection is made (between the parts the placement proposes) or open. Evidence to
  /// the contrary is ignored until the parts have been seen to agree. Returns the events of it.
  std::vector<ConnectionEvent> Override(int connection, bool made, int64_t utime);

  const Task& task() const;
  const std::vector<BelievedJoint>& joints() const;  ///< oldest first
  const Placement& placement() const;
  /// Probability that the two parts are joined as in this connection (both orders are tried).
  double Probability(int connection, int part_a, int part_b) const;

  /// Probability of a label of the pair.
  double ProbabilityOf(int part_a, int part_b, int label) const;
  /// Probability of the best connection of the task between the two parts other than `label`.
  double BestRight(int part_a, int part_b, int label) const;
  /// Whether both parts of the joint were seen in it; else it is known by what holds a hidden part (hidden_parts.h).
  bool IsSeen(const BelievedJoint& joint) const;
  /// Whether the wrong joint is between the right kinds of parts for a step, so that turning one over may mend it.
  bool IsTurned(const BelievedJoint& joint) const;

  AssemblyMemory Save() const;
  /// @throws std::invalid_argument if the memory does not fit the task.
  void Restore(const AssemblyMemory& memory);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coach
