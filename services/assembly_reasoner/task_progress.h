// Where the joints that are made stand in the task: which part fills which slot, what follows, what is next.
#pragma once

#include <vector>

#include "common/assembly/task.h"

namespace coach {

/// Two joined parts and the connections (indices into Task::connections) that their relative pose may be.
struct MadeJoint {
  int part_a = 0, part_b = 0;
  std::vector<int> connections;
};

struct Placement {
  int variant = 0;                 ///< index into Task::variants
  std::vector<int> part_in_slot;   ///< one a slot; -1 free
  std::vector<int> connection_of;  ///< one a joint: index into Task::connections; -1 it has no place in the variant
};

/// The placement with most joints in place; of equal ones that which changes least against `previous` (joint by joint:
/// pass the connection each had, -1 none), then the task's own set. Joints that come first have the right of way.
Placement Place(const Task& task, const std::vector<MadeJoint>& joints, const std::vector<int>& previous,
                int previous_variant);

/// Connections of the variant that are not made but follow: both slots are filled and joined through rigid made ones.
std::vector<int> ImpliedConnections(const Task& task, const Placement& placement);

/// The connection to ask for: the first step that is not made and grows the largest sub-assembly; else the first that
/// is not made; -1 if all are. What closes by itself is asked for only when nothing else is left.
int NextConnection(const Task& task, const Placement& placement, const std::vector<int>& skipped);

/// Parts for the two slots of a connection: those that fill them, else free ones of the type (lowest index not in
/// `unavailable` first, then any); -1 if there is none.
std::pair<int, int> PartsFor(const Task& task, const Placement& placement, int connection,
                             const std::vector<bool>& unavailable);

}  // namespace coach
