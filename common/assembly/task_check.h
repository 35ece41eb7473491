// Geometric consistency of a task.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/task.h"

namespace coach {

/// Where the relative poses round a ring of `connections` (indices into Task::connections) do not compose to the
/// identity, modulo the symmetries of the two parts at which the ring is cut; empty if every ring closes. Rings through
/// a joint with freedom are not judged: the joint gives way.
std::string RingProblem(const Task& task, const std::vector<int>& connections, double position_tolerance,
                        double angle_tolerance);

}  // namespace coach
