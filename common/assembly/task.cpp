#include "common/assembly/task.h"

#include <algorithm>

#include "common/assembly/part_poses.h"

namespace coach {

int Task::ColourClass(int type) const {
  int next = 0;
  for (int t = 0; t < type; ++t) {
    const bool first =
        std::none_of(types.begin(), types.begin() + t, [&](const PartType& p) { return p.hsv == types[t].hsv; });
    if (types[t].hsv == types[type].hsv) return ColourClass(t);
    next += first;
  }
  return next;
}

int Task::NumColourClasses() const {
  int n = 0;
  for (size_t t = 0; t < types.size(); ++t) n = std::max(n, ColourClass(static_cast<int>(t)) + 1);
  return n;
}

const char* ToString(PartStatus status) {
  switch (status) {
    case PartStatus::kTracked:
      return "tracked";
    case PartStatus::kOccluded:
      return "occluded";
    case PartStatus::kOutOfView:
      return "out_of_view";
    case PartStatus::kLost:
      return "lost";
    case PartStatus::kAbsent:
      return "absent";
  }
  return "unknown";
}

}  // namespace coach
