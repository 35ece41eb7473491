// What a robot must be able to do for Coach. Three kinds exist: a NAO, the virtual robot in a browser, and a log.
//
// Nothing here blocks: orders are accepted at once and their outcome comes back as events from Poll(). Times are of one
// monotonic clock (us), handed in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/robot_act.h"
#include "services/robot_bridge/eye_colour.h"
#include "services/robot_bridge/joints.h"

namespace coach {

struct SpeechOrder {
  int64_t id = 0;            ///< given back in the events
  std::string text;          ///< UTF-8, clean (see CleanText), never empty
  std::string language;      ///< en, el, ...
  std::string phrase_key{};  ///< which phrase it is; empty: none
  int wording = 0;           ///< which of its wordings, from 0
};

struct BackEndEvent {
  enum class Kind { kSpeechDone, kSpeechFailed, kHelpTouched };
  Kind kind = Kind::kSpeechDone;
  int64_t id = 0;      ///< of the speech
  std::string reason;  ///< of a failure
};

struct BackEndState {
  bool connected = false;  ///< the robot answers and is ready for acts
  std::string detail;      ///< why it is not; empty if it is
  double battery = -1;     ///< 0..1; -1 unknown
};

class BackEnd {
 public:
  virtual ~BackEnd() = default;

  virtual std::string name() const = 0;
  /// A moving body: it must not move its arms without knowing where hands are.
  virtual bool physical() const = 0;

  /// Does what can be done without waiting, and returns what has happened since the last call.
  virtual std::vector<BackEndEvent> Poll(int64_t now) = 0;
  virtual BackEndState State() const = 0;
  /// Angles as the robot measures them, if it does.
  virtual std::optional<JointAngles> MeasuredAngles() const { return std::nullopt; }

  virtual void Say(const SpeechOrder& speech) = 0;
  /// Silence within 100 ms. The speech that is cut gives no event.
  virtual void Silence() = 0;
  /// Follows a path, from now; joints that it does not concern go on with theirs.
  virtual void Move(const JointPath& path) = 0;
  /// All joints stay where they are, within 100 ms, and hold their weight.
  virtual void Freeze() = 0;
  virtual void SetEyes(const EyeColour& colour) = 0;
  /// Motors off where that is safe (seated). Wake() undoes it.
  virtual void Rest() = 0;
  virtual void Wake() = 0;
  /// @param volume 0..1; the back end caps it.
  virtual void SetVolume(double volume) = 0;

  /// What can be shown, for back ends that have a screen.
  virtual void ShowScene(const TableScene&) {}
  virtual void ShowTarget(const std::optional<Vector3>&) {}  ///< m, table frame; nothing: no target
};

}  // namespace coach
