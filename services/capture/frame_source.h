// Where frames come from.
#pragma once

#include <stdexcept>
#include <string>

#include "common/imaging/frame.h"

namespace coach {

/// The source can't be used now, but may come back (a camera that is unplugged).
class SourceLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A camera or a recording. Used by one thread.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  enum class Outcome {
    kFrame,    ///< `frame` is the next one
    kNothing,  ///< none came within the time-out
    kEnd,      ///< the recording is over
  };
  /// Waits up to timeout_ms. Fills every field but received_utime. utime: of a recording, time since its first frame;
  /// of a camera, time of exposure in us since 1970. A frame may lack one image.
  /// @throws SourceLost if it must be opened anew, std::runtime_error if the recording is broken here (the next call
  /// goes on behind it).
  virtual Outcome Next(Frame& frame, int timeout_ms) = 0;

  /// A recording must be paced and may be looped; a camera paces itself and never ends.
  virtual bool is_recording() const = 0;
  /// Us from the last frame of a recording to the first of its next loop.
  virtual double period_us() const { return 1e6 / 30; }
  /// What is not as it should be though frames come, e.g. depth that is not registered; empty if nothing.
  virtual std::string complaint() const { return ""; }
};

}  // namespace coach
