// What the tracker says of one frame. Plain data: the message part_poses_t without the bus.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/pose.h"

namespace coach {

enum class PartStatus {
  kTracked = 0,
  kOccluded = 1,   ///< hidden behind something
  kOutOfView = 2,  ///< outside the image
  kLost = 3,       ///< should be visible and is not found
  kAbsent = 4,     ///< never seen since the start
};
const char* ToString(PartStatus status);

struct PartEstimate {
  Pose X_TP = Pose::Identity();
  Vector6 velocity = Vector6::Zero();        ///< m/s, rad/s; table frame
  Matrix6 covariance = Matrix6::Identity();  ///< of Perturb(X_TP, .), table frame
  double visible_fraction = 0;               ///< 0..1
  PartStatus status = PartStatus::kAbsent;
  double confidence = 0;             ///< 0..1
  int ambiguous_with = -1;           ///< equal part it may have been taken for
  double ambiguous_probability = 0;  ///< 0..0.5
  int identity_exchange = -1;        ///< equal part it exchanged its identity with in this frame
};

/// Which one-body hypothesis was tested in pair evidence.
enum class CandidateKind { kNone = 0, kConnection = 1, kMistake = 2 };

/// What the images alone say about two near parts; no particle with an enforced connection takes part.
struct PairEvidence {
  int part_a = 0, part_b = 0;                ///< part_a < part_b
  Pose X_AB = Pose::Identity();              ///< fitted freely
  Matrix6 covariance = Matrix6::Identity();  ///< joint, of Perturb(X_AB, .), A's frame
  CandidateKind candidate_kind = CandidateKind::kNone;
  int candidate = -1;                        ///< index into Task::connections or Task::mistakes
  double log_evidence = 0;                   ///< nats: one body in the candidate pose against two free ones, penalised
  int pixels = 0;                            ///< px that took part
  double surface_distance = 0;               ///< m, negative: overlap
  std::array<double, 2> motion{};            ///< m, rad: of A in the table frame over the last 0.5 s
  std::array<double, 2> relative_motion{};   ///< m, rad: of X_AB over the same time
  std::array<double, 2> visible_fraction{};  ///< of A, of B
  bool constrained = false;                  ///< a connection between the two was enforced on some particles
};

/// Something above the table that is no part.
struct ForeignBlob {
  Vector3 centre = Vector3::Zero();    ///< m, table frame
  double radius = 0;                   ///< m
  Vector3 velocity = Vector3::Zero();  ///< m/s
};

struct PartPoses {
  int64_t utime = 0;           ///< us, of the frame
  int64_t received_utime = 0;  ///< us, wall clock at capture; 0 in lockstep
  int64_t sequence = 0;
  Pose X_TC = Pose::Identity();
  Matrix6 X_TC_covariance = Matrix6::Zero();  ///< of Perturb(X_TC, .), table frame
  bool table_found = false;
  double table_residual = 0;        ///< m, median distance of the table's pixels from the plane
  std::vector<PartEstimate> parts;  ///< index = index in Task::parts
  std::vector<PairEvidence> pairs;
  std::vector<ForeignBlob> foreign;  ///< at most 4, largest first
};

/// The reasoner's belief in one connection between two parts, fed back to the filter.
struct ConnectionProbability {
  int connection = 0;  ///< index into Task::connections; -1 - m for mistake m
  int part_a = 0, part_b = 0;
  double probability = 0;
};
struct ConnectionBelief {
  int64_t utime = 0;  ///< of the PartPoses it comes from
  std::vector<ConnectionProbability> connections;
};

}  // namespace coach
