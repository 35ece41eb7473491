// The finished structure as a flat picture: every slot's outline and where the connections are.
#pragma once

#include <vector>

#include "common/assembly/task.h"
#include "tools/operator/outline.h"

namespace coach {

/// Millimetres; x to the right, y down, the upper left corner of everything at (0, 0).
struct AssemblyPlan {
  struct SlotShape {
    std::vector<Polygon> outlines;
    Eigen::Vector2f label{0, 0};  ///< middle of the slot's part
    double height = 0;            ///< mm along the view; a higher slot is drawn later
  };
  struct Joint {
    int connection = 0;           ///< index into Task::connections
    Eigen::Vector2f place{0, 0};  ///< where the two parts touch
  };
  double width = 0, height = 0;  ///< mm
  std::vector<SlotShape> slots;  ///< index = index in Task::slots
  std::vector<Joint> joints;
};

/// Poses X_FS of every slot's part in a common frame F, as a set of connections (indices into Task::connections)
/// demands. Slots that no chain of connections joins stand side by side.
std::vector<Pose> SlotPoses(const Task& task, const std::vector<int>& connections);

/// One of Task::variants seen along the axis in which it is flattest, its longer side across. Empty for a task without
/// slots.
AssemblyPlan PlanOf(const Task& task, const std::vector<int>& connections);

}  // namespace coach
