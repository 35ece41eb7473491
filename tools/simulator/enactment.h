// Plays a lesson: the child builds the task's structure, with mistakes and interludes.
#pragma once

#include <memory>

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
                               const Pose& X_W_structure, const std::vector<Spot>& avoid, double any_face,
                               Random& random);

/// A lesson that is planned act by act, at the child's now().
class Enactment {
 public:
  /// All must outlive it. The part of the first slot lies at its place.
  Enactment(const Task& task, const Structure& structure, const Solids& solids, Child* child, Performance* performance,
            Random* random);
  ~Enactment();

  /// Builds everything, with interludes.
  void Play(const LessonPlan& plan);
  /// Makes a connection (index into Task::connections), or the next one in the task's order if it can't be made now.
  /// Nothing if the structure is complete or a mistake is in the way.
  void Build(int connection, bool near_miss = false);
  /// Makes a wrong connection and leaves it. False if there is none to make.
  bool Err();
  void Undo();  ///< takes the mistake apart again
  bool mistaken() const;
  bool complete() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coach
