// Plays a lesson: the child builds the task's structure, with mistakes and interludes.
#pragma once

#include "tools/simulator/child.h"
#include "tools/simulator/room.h"
#include "tools/simulator/structure.h"

namespace coach {

struct LessonPlan {
  bool cover = true;        ///< lays a hand over a lying part
  bool out_of_view = true;  ///< lifts a part out of the picture and brings it back to another place
  bool near_miss = true;    ///< stops just before a joint
  bool turn = true;         ///< turns the unfinished structure
  double mistakes = 1;      ///< wrong connections, each undone
};

/// Where the finished structure will lie: pose of the first slot in the world.
Pose StructurePlace(const Task& task, const Structure& structure, const Solids& solids, Random& random);

/// Poses of all parts apart from each other on the table outside the structure's place and of the places to avoid.
/// `any_face`: chance that a part lies on another face than in the structure.
std::vector<Pose> ScatterParts(const Task& task, const Solids& solids, const Structure& structure,
                               const Pose& X_W_structure, const std::vector<Place>& avoid, double any_face,
                               Random& random);

/// Builds the structure from its first joint on.
void PlayLesson(const Task& task, const Structure& structure, const Solids& solids, const LessonPlan& plan,
                Child* child, Performance* performance, Random& random);

}  // namespace coach
