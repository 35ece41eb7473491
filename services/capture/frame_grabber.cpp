#include "services/capture/frame_grabber.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace coach {
namespace {

template <class Clock>
int64_t Microseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();
}

}  // namespace

FrameGrabber::FrameGrabber(OpenSource open, const GrabberOptions& options, std::function<void()> notify)
    : open_(std::move(open)), options_(options), notify_(std::move(notify)), loop_start_(options.utime_origin) {
  last_sign_ = Microseconds<std::chrono::steady_clock>();
  thread_ = std::thread([this] { Work(); });
}

FrameGrabber::~FrameGrabber() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::optional<Frame> FrameGrabber::Take() {
  const std::lock_guard lock(mutex_);
  std::optional<Frame> frame;
  frame.swap(frame_);
  if (frame) changed_.notify_all();
  ended_ = over_;
  return frame;
}

std::string FrameGrabber::complaint() const {
  const std::lock_guard lock(mutex_);
  return complaint_;
}

std::exception_ptr FrameGrabber::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void FrameGrabber::SetComplaint(const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    if (text == complaint_) return;
    complaint_ = text;
  }
  notify_();
}

/// Sleeps unless asked to stop. @returns false if asked to stop.
bool FrameGrabber::Pause(double seconds) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return stop_; });
}

void FrameGrabber::Work() {
  double retry = options_.retry_ms * 1e-3;
  while (true) {
    const int64_t before = grabbed_;
    try {
      if (!PlayOnce()) break;
    } catch (const SourceLost& e) {
      if (grabbed_ > before) retry = options_.retry_ms * 1e-3;
      last_sign_ = Microseconds<std::chrono::steady_clock>();
      SetComplaint(e.what());
      if (!Pause(retry)) return;
      retry = std::min(2 * retry, 1.0);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      break;
    }
  }
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  notify_();
}

/// Opens the source and works through it. @returns true to do it again (a loop).
bool FrameGrabber::PlayOnce() {
  const std::unique_ptr<FrameSource> source = open_();
  int64_t last_arrival = Microseconds<std::chrono::steady_clock>();
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (stop_) return false;
    }
    Frame frame;
    FrameSource::Outcome outcome = FrameSource::Outcome::kNothing;
    try {
      outcome = source->Next(frame, 100);
    } catch (const SourceLost&) {
      throw;
    } catch (const std::exception& e) {  // a broken frame of a recording: gone, but not the rest
      ++grabbed_;
      ++replaced_;
      SetComplaint(e.what());
      continue;
    }
    const int64_t now = last_sign_ = Microseconds<std::chrono::steady_clock>();
    if (outcome == FrameSource::Outcome::kEnd) {
      loop_start_ = last_utime_ + std::llround(source->period_us());
      return options_.loop;
    }
    if (outcome == FrameSource::Outcome::kNothing) {
      if (!source->is_recording() && now - last_arrival > options_.timeout_ms * 1000)
        throw SourceLost("the camera gives no frames; opening it again");
      continue;
    }
    last_arrival = now;
    SetComplaint(source->complaint());
    if (source->is_recording()) {
      frame.utime += loop_start_;
      Pace(frame);
    }
    Deliver(std::move(frame));
  }
}

/// Waits until a recorded frame is due.
void FrameGrabber::Pace(const Frame& frame) {
  last_utime_ = frame.utime;
  if (options_.every_frame) return;
  const int64_t now = Microseconds<std::chrono::steady_clock>();
  if (!play_start_) play_start_ = now;
  const double due =
      static_cast<double>(*play_start_) + static_cast<double>(frame.utime - options_.utime_origin) / options_.speed;
  const double wait = due - static_cast<double>(now);
  if (wait > 0) Pause(wait * 1e-6);
}

void FrameGrabber::Deliver(Frame frame) {
  frame.sequence = sequence_++;
  frame.received_utime = Microseconds<std::chrono::system_clock>();
  {
    std::unique_lock lock(mutex_);
    if (options_.every_frame) changed_.wait(lock, [this] { return !frame_ || stop_; });
    ++grabbed_;
    replaced_ += frame_.has_value();
    frame_ = std::move(frame);
  }
  notify_();
}

}  // namespace coach
