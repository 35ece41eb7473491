#include "common/assembly/robot_act.h"

namespace coach {

const char* ToString(ActState state) {
  switch (state) {
    case ActState::kNone:
      return "none";
    case ActState::kQueued:
      return "queued";
    case ActState::kStarted:
      return "started";
    case ActState::kDone:
      return "done";
    case ActState::kInterrupted:
      return "interrupted";
    case ActState::kExpired:
      return "expired";
    case ActState::kFailed:
      return "failed";
  }
  return "unknown";
}

}  // namespace coach
