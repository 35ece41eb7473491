// Scripts of one situation each: what a table of connection models has to show for every task.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/task.h"
#include "tools/evaluate_reasoner/pose_script.h"

namespace coach {

struct Situation {
  std::string name;
  std::vector<std::vector<ScriptAction>> scripts;
};

/// Orders and assignments, the same with every joint made under the hands, every listed mistake with its undoing, every
/// connection undone and made again, near misses of 5 to 30 mm at every connection.
/// @param orders plain scripts at most, spread evenly over all there are
std::vector<Situation> Situations(const Task& task, int orders);

}  // namespace coach
