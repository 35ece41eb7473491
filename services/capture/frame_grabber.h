// Fetches frames in a thread of its own, so that neither a slow disk nor a camera that hangs keeps the service from the
// bus.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "services/capture/frame_source.h"

namespace coach {

struct GrabberOptions {
  double speed = 1;          ///< of a recording, times real time
  bool every_frame = false;  ///< of a recording: wait for Take() instead of pacing and dropping
  bool loop = false;         ///< of a recording
  int64_t utime_origin = 0;  ///< us; utime of a recording's first frame
  int retry_ms = 250;        ///< first pause before a lost source is opened again; doubles up to 1 s
  int timeout_ms = 2000;     ///< a camera that gives nothing this long is opened again
};

/// Holds the newest frame; one that is not taken in time is replaced and counted. Paces recordings, loops them (time
/// and sequence go on growing), and opens a lost camera again for ever.
class FrameGrabber {
 public:
  using OpenSource = std::function<std::unique_ptr<FrameSource>()>;

  /// @param open called in the grabber's thread, again after each loss; throws SourceLost (try again later) or anything
  /// else (give up)
  /// @param notify called in the grabber's thread when there is something to see: a frame, the end, another state
  FrameGrabber(OpenSource open, const GrabberOptions& options, std::function<void()> notify);
  ~FrameGrabber();  ///< stops within the source's time-out

  /// The newest frame, if there is one that was not taken yet. received_utime is the wall clock's time of its arrival.
  std::optional<Frame> Take();

  bool ended() const { return ended_; }           ///< the recording is over and its last frame was taken
  int64_t grabbed() const { return grabbed_; }    ///< frames that came
  int64_t replaced() const { return replaced_; }  ///< of them, never taken
  /// When its thread last came back from the source, us of the steady clock: a camera's driver may hang for ever.
  int64_t last_sign() const { return last_sign_; }
  std::string complaint() const;  ///< what is wrong at the moment; empty if all is well
  /// Why the grabber gave up for good; null if it didn't.
  std::exception_ptr failure() const;

 private:
  void Work();
  bool PlayOnce();
  void Deliver(Frame frame);
  void Pace(const Frame& frame);
  bool Pause(double seconds);
  void SetComplaint(const std::string& text);

  OpenSource open_;
  GrabberOptions options_;
  std::function<void()> notify_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Frame> frame_;
  std::string complaint_;
  std::exception_ptr failure_;
  bool stop_ = false, over_ = false;
  std::atomic<bool> ended_{false};
  std::atomic<int64_t> grabbed_{0}, replaced_{0}, last_sign_{0};
  int64_t sequence_ = 0;
  int64_t loop_start_ = 0, last_utime_ = 0;  ///< us, utime
  std::optional<int64_t> play_start_;        ///< us, steady clock at utime_origin
  std::thread thread_;
};

}  // namespace coach
