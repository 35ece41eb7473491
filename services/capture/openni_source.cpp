#include "services/capture/openni_source.h"

#include <OpenNI.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace coach {
namespace {

constexpr int kEndOfFile_ms = 1000;  // a recording that gives nothing this long is over

int64_t WallMicroseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// OpenNI for as long as somebody needs it.
class OpenNiLibrary {
 public:
  OpenNiLibrary() {
    if (openni::OpenNI::initialize() != openni::STATUS_OK) throw SourceLost(Error("OpenNI2 can't start"));
  }
  ~OpenNiLibrary() { openni::OpenNI::shutdown(); }
  OpenNiLibrary(const OpenNiLibrary&) = delete;
  OpenNiLibrary& operator=(const OpenNiLibrary&) = delete;

  static std::string Error(const std::string& what) {
    std::string why;
    for (const char* c = openni::OpenNI::getExtendedError(); *c; ++c) {
      if (*c != '\n' && *c != '\t') why += *c;
    }
    return why.empty() ? what : what + ": " + why;
  }
};

/// Maps a device's clock to the wall clock: the smallest delay seen is taken for none, and may grow by 20 us a second
/// (drift).
class ClockMap {
 public:
  int64_t ToWall(int64_t device, int64_t wall) {
    const auto delay = static_cast<double>(wall - device);
    if (last_) offset_ += 20e-6 * static_cast<double>(device - *last_);
    if (!last_ || delay < offset_ || std::abs(delay - offset_) > 1e6) offset_ = delay;
    last_ = device;
    return device + std::llround(offset_);
  }

 private:
  std::optional<int64_t> last_;
  double offset_ = 0;
};

/// Hears when a device is unplugged.
class UnpluggedListener final : public openni::OpenNI::DeviceDisconnectedListener {
 public:
  UnpluggedListener() { openni::OpenNI::addDeviceDisconnectedListener(this); }
  ~UnpluggedListener() { openni::OpenNI::removeDeviceDisconnectedListener(this); }
  UnpluggedListener(const UnpluggedListener&) = delete;
  UnpluggedListener& operator=(const UnpluggedListener&) = delete;

  void Watch(const openni::Device& device) {
    const std::lock_guard lock(mutex_);
    uri_ = device.getDeviceInfo().getUri();
  }
  bool unplugged() const { return unplugged_; }

 private:
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    const std::lock_guard lock(mutex_);
    if (uri_ == info->getUri()) unplugged_ = true;
  }
  std::mutex mutex_;
  std::string uri_;
  std::atomic<bool> unplugged_{false};
};

class OpenNiSource final : public FrameSource {
 public:
  OpenNiSource(const std::string& uri, bool recording, const CaptureOptions& options)
      : recording_(recording), options_(options) {
    if (device_.open(uri.empty() ? openni::ANY_DEVICE : uri.c_str()) != openni::STATUS_OK)
      throw SourceLost(OpenNiLibrary::Error(uri.empty() ? "no camera" : "no camera " + uri));
    listener_.Watch(device_);
    if (recording_)
      OpenRecording();
    else
      SetUpDevice();
    Start(depth_, openni::SENSOR_DEPTH);
    Start(colour_, openni::SENSOR_COLOR);
    if (!depth_.isValid()) throw SourceLost("the camera has no depth");
    metres_per_unit_ = depth_.getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM ? 1e-4 : 1e-3;
    camera_ = Camera();
  }

  ~OpenNiSource() override {
    depth_.stop();
    colour_.stop();
    depth_.destroy();
    colour_.destroy();
    device_.close();
  }

  Outcome Next(Frame& frame, int timeout_ms) override {
    for (int waited = 0;;) {
      openni::VideoStream* streams[] = {&depth_, &colour_};
      int ready = -1;
      if (listener_.unplugged()) throw SourceLost("the camera is gone");
      const int wait = recording_ ? kEndOfFile_ms : timeout_ms;
      const openni::Status status = openni::OpenNI::waitForAnyStream(streams, colour_.isValid() ? 2 : 1, &ready, wait);
      if (status == openni::STATUS_TIME_OUT) return recording_ ? Outcome::kEnd : Outcome::kNothing;
      if (status != openni::STATUS_OK) throw SourceLost(OpenNiLibrary::Error("the camera is gone"));
      openni::VideoFrameRef& slot = ready == 0 ? depth_frame_ : colour_frame_;
      if (streams[ready]->readFrame(&slot) != openni::STATUS_OK)
        throw SourceLost(OpenNiLibrary::Error("the camera is gone"));
      if (Pair(frame)) return Outcome::kFrame;
      if (recording_ && AtEnd()) return Outcome::kEnd;
      if (++waited > 1000) return Outcome::kNothing;
    }
  }

  bool is_recording() const override { return recording_; }
  double period_us() const override { return 1e6 / std::max(1, depth_.getVideoMode().getFps()); }
  std::string complaint() const override { return complaint_; }

 private:
  void OpenRecording() {
    openni::PlaybackControl* playback = device_.getPlaybackControl();
    if (!playback) throw std::runtime_error("this OpenNI2 device is no recording");
    playback->setSpeed(-1);
    playback->setRepeatEnabled(false);
  }

  void SetUpDevice() {
    if (device_.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR))
      device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
    if (device_.getImageRegistrationMode() != openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR)
      complaint_ = "the camera does not register depth to colour";
    device_.setDepthColorSyncEnabled(true);
  }

  void Start(openni::VideoStream& stream, openni::SensorType sensor) {
    if (!device_.getSensorInfo(sensor)) return;
    const std::string name = sensor == openni::SENSOR_DEPTH ? "depth" : "colour";
    if (stream.create(device_, sensor) != openni::STATUS_OK)
      throw SourceLost(OpenNiLibrary::Error("no " + name + " stream"));
    if (!recording_) {
      openni::VideoMode mode;
      mode.setResolution(options_.width, options_.height);
      mode.setFps(static_cast<int>(std::lround(options_.fps)));
      mode.setPixelFormat(sensor == openni::SENSOR_DEPTH ? openni::PIXEL_FORMAT_DEPTH_1_MM
                                                         : openni::PIXEL_FORMAT_RGB888);
      if (stream.setVideoMode(mode) != openni::STATUS_OK)
        throw SourceLost(OpenNiLibrary::Error("the camera has no " + name + " of " + std::to_string(options_.width) +
                                              " x " + std::to_string(options_.height) + " px at " +
                                              std::to_string(mode.getFps()) + " Hz"));
      stream.setMirroringEnabled(false);
    }
    if (stream.start() != openni::STATUS_OK) throw SourceLost(OpenNiLibrary::Error(name + " does not start"));
  }

  /// Both images have the intrinsics of the colour camera, since depth is registered to it.
  CameraModel Camera() const {
    const openni::VideoStream& stream = colour_.isValid() ? colour_ : depth_;
    const openni::VideoMode mode = stream.getVideoMode();
    CameraModel camera;
    camera.width = mode.getResolutionX();
    camera.height = mode.getResolutionY();
    if (options_.intrinsics && options_.intrinsics->width == camera.width &&
        options_.intrinsics->height == camera.height)
      return *options_.intrinsics;
    camera.fx = camera.width / (2 * std::tan(static_cast<double>(stream.getHorizontalFieldOfView()) / 2));
    camera.fy = camera.height / (2 * std::tan(static_cast<double>(stream.getVerticalFieldOfView()) / 2));
    camera.cx = (camera.width - 1) / 2.0;
    camera.cy = (camera.height - 1) / 2.0;
    if (!camera.Problem().empty())
      throw std::runtime_error("the device's field of view makes no camera (" + camera.Problem() +
                               "); give camera.intrinsics in the station file");
    return camera;
  }

  /// Frames of both streams whose time stamps are within half a period become one frame; a frame that is too old for
  /// its partner is given up. Without colour, every depth frame.
  bool Pair(Frame& frame) {
    if (!depth_frame_.isValid()) return false;
    if (colour_.isValid()) {
      if (!colour_frame_.isValid()) return false;
      const auto skew =
          static_cast<int64_t>(colour_frame_.getTimestamp()) - static_cast<int64_t>(depth_frame_.getTimestamp());
      if (static_cast<double>(std::abs(skew)) > period_us() / 2) {
        (skew > 0 ? depth_frame_ : colour_frame_).release();
        return false;
      }
      frame.exposure_skew_us = static_cast<int>(skew);
    }
    const auto time = static_cast<int64_t>(depth_frame_.getTimestamp());
    if (!first_time_) first_time_ = time;
    frame.utime = recording_ ? time - *first_time_ : clock_.ToWall(time, WallMicroseconds());
    frame.camera = camera_;
    frame.metres_per_unit = metres_per_unit_;
    frame.depth = Image(depth_frame_, CV_16UC1);
    if (colour_.isValid()) cv::cvtColor(Image(colour_frame_, CV_8UC3), frame.colour, cv::COLOR_RGB2BGR);
    ++paired_;
    depth_frame_.release();
    colour_frame_.release();
    return true;
  }

  static cv::Mat Image(const openni::VideoFrameRef& frame, int type) {
    const size_t row = static_cast<size_t>(frame.getWidth()) * CV_ELEM_SIZE(type);
    const auto stride = static_cast<size_t>(frame.getStrideInBytes());
    if (stride < row ||
        static_cast<size_t>(frame.getDataSize()) < stride * static_cast<size_t>(frame.getHeight() - 1) + row)
      throw std::runtime_error("the camera gave a frame whose size is not that of its video mode");
    cv::Mat image(frame.getHeight(), frame.getWidth(), type);
    for (int y = 0; y < image.rows; ++y)
      std::memcpy(image.ptr(y), static_cast<const uint8_t*>(frame.getData()) + stride * static_cast<size_t>(y), row);
    return image;
  }

  bool AtEnd() const {
    openni::PlaybackControl* playback = const_cast<openni::Device&>(device_).getPlaybackControl();
    return playback && paired_ >= playback->getNumberOfFrames(depth_);
  }

  OpenNiLibrary library_;
  UnpluggedListener listener_;
  bool recording_;
  CaptureOptions options_;
  openni::Device device_;
  openni::VideoStream depth_, colour_;
  openni::VideoFrameRef depth_frame_, colour_frame_;
  CameraModel camera_;
  double metres_per_unit_ = 1e-3;
  ClockMap clock_;
  std::optional<int64_t> first_time_;
  int64_t paired_ = 0;
  std::string complaint_;
};

}  // namespace

std::unique_ptr<FrameSource> OpenOpenNiDevice(const std::string& uri, const CaptureOptions& options) {
  return std::make_unique<OpenNiSource>(uri, false, options);
}

std::unique_ptr<FrameSource> OpenOniFile(const std::string& file, const CaptureOptions& options) {
  try {
    return std::make_unique<OpenNiSource>(file, true, options);
  } catch (const SourceLost& e) {
    throw std::runtime_error(file + ": no OpenNI2 recording that can be played: " + e.what());
  }
}

}  // namespace coach
