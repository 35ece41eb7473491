// The finished structure of a task, and what its connections are equivalent to.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/task.h"

namespace coach {

/// The task's own connections (indices), without those that only its variants use.
std::vector<int> OwnConnections(const Task& task);

/// Poses of all slots in the frame of the first, along the own connections; slots that no connection reaches keep the
/// identity and are not `reached`.
struct Structure {
  std::vector<Pose> X_slot;
  std::vector<bool> reached;
  std::vector<int> part;  ///< by slot: the instance that goes there (first free of its type)
};
Structure FinishedStructure(const Task& task);

/// All relative poses of part b in a that look the same through the parts' symmetries, the given one first.
std::vector<Pose> Equivalents(const SymmetryGroup& a, const Pose& X_AB, const SymmetryGroup& b);

/// For every connection and then every mistake: a label shared by all that are physically the same joint between the
/// same types: "long-medium-0".
std::vector<std::string> JointClasses(const Task& task);

}  // namespace coach
