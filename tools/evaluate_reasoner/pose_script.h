// Scripted lessons without images: true motions of the parts, played through the errors of a tracker as PART_POSES.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"

namespace coach {

/// Errors of a tracker, a part. Angles follow lengths: 0.6 degrees a millimetre.
struct TrackerErrors {
  double position = 0.001;         ///< m, standard deviation an axis
  double correlation_time = 0.15;  ///< s, of these errors
  double bias = 0.001;             ///< m, constant offset of each part, at most; 0.6 degrees a mm likewise
  double freezes = 0.05;           ///< 1/s: the pose is repeated for 0.2 to 0.5 s
  double jumps = 0.05;             ///< 1/s: off by 15 to 40 mm for one to four frames
  double covariance_scale = 1.0;   ///< reported over true variance
};

struct ScriptAction {
  enum class Kind { kConnect, kMistake, kUndo, kNearMiss, kUnknown };
  Kind kind = Kind::kConnect;
  int index = 0;               ///< connection; mistake for kMistake; ignored for kUndo and kUnknown
  int part_a = 0, part_b = 0;  ///< in slot_a / of type_a, and the other
  double gap = 0;              ///< m, of a near miss
  bool hidden = false;         ///< both parts are covered from 0.6 s before the moment to 0.5 s after
  bool carried = false;        ///< afterwards the whole is carried 60 mm, 120 mm for kUnknown
  double pause = 0;            ///< s in which nothing happens, before it
};

struct TrueEvent {
  int64_t moment = 0;              ///< us
  int64_t due = 0;                 ///< us: moment, or when both parts are at least 0.3 visible again
  std::string type;                ///< connect, wrong, disconnect
  std::vector<std::string> names;  ///< any of these is right: equal relative poses can't be told apart
  int part_a = 0, part_b = 0;
};

struct ScriptedLesson {
  std::vector<PartPoses> frames;
  std::vector<TrueEvent> events;
  int near_misses = 0;
};

/// @param fps frames a second
ScriptedLesson PlayScript(const Task& task, const std::vector<ScriptAction>& actions, const TrackerErrors& errors,
                          double fps, uint64_t seed);

struct ScriptOptions {
  double mistakes = 0.3;     ///< probability of a mistake (made, kept 2 to 4 s, undone) before a step
  double near_misses = 0.3;  ///< probability of a near miss of 5 to 30 mm before a step
  double hidden = 0.2;       ///< probability that a step happens under the hands
  double unknown = 0.0;  ///< probability that two parts are joined as in no class, carried and undone, before a step
  double undone = 0.1;   ///< probability that a right connection is taken apart and made again
};

/// A whole lesson: the connections in any order, any equal parts in any slot.
std::vector<ScriptAction> RandomScript(const Task& task, const ScriptOptions& options, std::mt19937_64& random);

/// Connections in this order with these parts in the slots, nothing else.
std::vector<ScriptAction> PlainScript(const Task& task, const std::vector<int>& order,
                                      const std::vector<int>& part_in_slot);

/// How many plain scripts there are: orders of the first variant's connections times assignments of parts to slots.
int64_t CountPlainScripts(const Task& task);
/// The `index`-th of them.
std::vector<ScriptAction> PlainScriptAt(const Task& task, int64_t index);

/// Not also the beginning of a variant.
bool IsOnlyWrong(const Task& task, int mistake);

}  // namespace coach
