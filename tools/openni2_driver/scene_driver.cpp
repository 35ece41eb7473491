// An OpenNI2 driver: a scene folder is a camera.
//
// The camera is announced if $COACH_OPENNI2_SCENE names a folder (rate $COACH_OPENNI2_FPS, default 30 Hz), and opened
// on demand for the address coach-scene:FOLDER. The scene begins again when it is over; time stamps grow. After
// $COACH_OPENNI2_UNPLUG frames (default: never) the camera is unplugged, and plugged in again 0.5 s later.
#include <cmath>
#include <cstdlib>
#include <new>
// What OpenNI2's own base library, which is not packaged, calls new and delete.
#define XN_NEW(type, arg) new type(arg)
#define XN_DELETE(p) delete (p)
#include <Driver/OniDriverAPI.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "common/imaging/scene_folder.h"

namespace coach {
namespace {

constexpr char kScheme[] = "coach-scene:";

double FramesPerSecond() {
  const char* text = std::getenv("COACH_OPENNI2_FPS");
  const double fps = text ? std::atof(text) : 30;
  return fps > 0 ? fps : 30;
}

template <class T>
OniStatus Give(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  *size = sizeof(T);
  return ONI_STATUS_OK;
}

/// One of the camera's two streams.
class SceneStream final : public oni::driver::StreamBase {
 public:
  SceneStream(OniSensorType sensor, const CameraModel& camera, double fps, std::function<void(SceneStream*)> forget)
      : forget_(std::move(forget)), sensor_(sensor), camera_(camera) {
    mode_.pixelFormat = sensor == ONI_SENSOR_DEPTH ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888;
    mode_.resolutionX = camera.width;
    mode_.resolutionY = camera.height;
    mode_.fps = static_cast<int>(std::lround(fps));
  }
  ~SceneStream() override { forget_(this); }

  const OniVideoMode& mode() const { return mode_; }
  OniSensorType sensor() const { return sensor_; }

  OniStatus start() override {
    started_ = true;
    return ONI_STATUS_OK;
  }
  void stop() override {
    started_ = false;
  }  // must not wait for the frame thread: the caller holds a lock that a new frame needs

  /// Hands a frame over, if somebody listens. Called by the frame thread.
  void Raise(const Frame& frame, uint64_t time, int index) {
    if (!started_) return;
    OniFrame* out = getServices().acquireFrame();
    if (!out) return;
    const size_t row = RowBytes();
    cv::Mat image(mode_.resolutionY, mode_.resolutionX, sensor_ == ONI_SENSOR_DEPTH ? CV_16UC1 : CV_8UC3, out->data,
                  row);
    if (sensor_ == ONI_SENSOR_DEPTH)
      frame.depth.convertTo(image, CV_16UC1, frame.metres_per_unit * 1000);
    else
      cv::cvtColor(frame.colour, image, cv::COLOR_BGR2RGB);
    out->sensorType = sensor_;
    out->timestamp = time;
    out->frameIndex = index;
    out->width = mode_.resolutionX;
    out->height = mode_.resolutionY;
    out->videoMode = mode_;
    out->croppingEnabled = FALSE;
    out->cropOriginX = out->cropOriginY = 0;
    out->stride = static_cast<int>(row);
    out->dataSize = static_cast<int>(row) * mode_.resolutionY;
    raiseNewFrame(out);
    getServices().releaseFrame(out);
  }

  OniBool isPropertySupported(int id) override { return id <= ONI_STREAM_PROPERTY_MIRRORING; }
  OniStatus getProperty(int id, void* data, int* size) override {
    const auto fov = [](int pixels, double focal) { return static_cast<float>(2 * std::atan(pixels / (2 * focal))); };
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return Give(mode_, data, size);
      case ONI_STREAM_PROPERTY_STRIDE:
        return Give(static_cast<int>(RowBytes()), data, size);
      case ONI_STREAM_PROPERTY_CROPPING:
        return Give(OniCropping{}, data, size);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return Give(fov(camera_.width, camera_.fx), data, size);
      case ONI_STREAM_PROPERTY_VERTICAL_FOV:
        return Give(fov(camera_.height, camera_.fy), data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return Give(sensor_ == ONI_SENSOR_DEPTH ? 10'000 : 255, data, size);
      case ONI_STREAM_PROPERTY_MIN_VALUE:
        return Give(0, data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return Give(OniBool{FALSE}, data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE && size == sizeof(OniVideoMode)) {
      const auto& wanted = *static_cast<const OniVideoMode*>(data);
      const bool same = wanted.resolutionX == mode_.resolutionX && wanted.resolutionY == mode_.resolutionY &&
                        wanted.pixelFormat == mode_.pixelFormat && wanted.fps == mode_.fps;
      return same ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED;
    }
    if (id == ONI_STREAM_PROPERTY_MIRRORING && size == sizeof(OniBool) && !*static_cast<const OniBool*>(data))
      return ONI_STATUS_OK;
    return ONI_STATUS_NOT_SUPPORTED;
  }
  /// A recording is played only if every property was announced.
  void notifyAllProperties() override {
    for (int id = 0; id <= ONI_STREAM_PROPERTY_MIRRORING; ++id) {
      char data[64];
      int size = sizeof data;
      if (getProperty(id, data, &size) == ONI_STATUS_OK) raisePropertyChanged(id, data, size);
    }
  }

 private:
  size_t RowBytes() const { return static_cast<size_t>(mode_.resolutionX) * (sensor_ == ONI_SENSOR_DEPTH ? 2U : 3U); }

  std::function<void(SceneStream*)> forget_;
  OniSensorType sensor_;
  CameraModel camera_;
  OniVideoMode mode_{};
  std::atomic<bool> started_{false};
};

class SceneDevice final : public oni::driver::DeviceBase {
 public:
  /// @param plugged asked after each frame, with the number of frames so far, whether the camera goes on
  SceneDevice(const std::string& folder, std::function<bool(int)> plugged)
      : scene_(folder, {.fps = FramesPerSecond(), .utime_origin = 0}), plugged_(std::move(plugged)) {
    const CameraModel& camera = scene_.camera(0);
    for (const OniSensorType sensor : {ONI_SENSOR_DEPTH, ONI_SENSOR_COLOR})
      modes_[sensor] = SceneStream(sensor, camera, FramesPerSecond(), [](SceneStream*) {}).mode();
    sensors_[0] = {ONI_SENSOR_DEPTH, 1, &modes_[ONI_SENSOR_DEPTH]};
    sensors_[1] = {ONI_SENSOR_COLOR, 1, &modes_[ONI_SENSOR_COLOR]};
    thread_ = std::thread([this] { Work(); });
  }
  ~SceneDevice() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = 2;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    if (!modes_.contains(sensor)) return nullptr;
    auto* stream = new SceneStream(sensor, scene_.camera(0), FramesPerSecond(), [this](SceneStream* s) { Forget(s); });
    const std::lock_guard lock(mutex_);
    streams_.push_back(stream);
    return stream;
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode) override { return TRUE; }
  OniBool isPropertySupported(int id) override { return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION; }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
    return Give(registration_, data, size);
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != sizeof registration_) return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&registration_, data, sizeof registration_);
    return ONI_STATUS_OK;
  }

 private:
  void Forget(SceneStream* stream) {
    const std::lock_guard lock(mutex_);
    std::erase(streams_, stream);
  }

  void Work() {
    const auto begin = std::chrono::steady_clock::now();
    for (int count = 0;; ++count) {
      const Frame frame = scene_.Read(count % scene_.size());
      const auto time = static_cast<uint64_t>(std::llround(count * scene_.period_us()));
      {
        std::unique_lock lock(mutex_);
        if (changed_.wait_until(lock, begin + std::chrono::microseconds(time), [this] { return stop_; })) return;
        for (SceneStream* stream : streams_) stream->Raise(frame, time, count);
      }
      if (!plugged_(count + 1)) return;
    }
  }

  SceneReader scene_;
  std::function<bool(int)> plugged_;
  std::map<OniSensorType, OniVideoMode> modes_;
  OniSensorInfo sensors_[2];
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  std::vector<SceneStream*> streams_;
  std::thread thread_;
};

class SceneDriver final : public oni::driver::DriverBase {
 public:
  explicit SceneDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, changed, cookie);
    if (const char* folder = std::getenv("COACH_OPENNI2_SCENE"); folder && status == ONI_STATUS_OK)
      Announce(kScheme + std::string(folder));
    return status;
  }
  OniStatus tryDevice(const char* uri) override {
    if (std::strncmp(uri, kScheme, std::strlen(kScheme)) != 0) return ONI_STATUS_ERROR;
    Announce(uri);
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    try {
      return new SceneDevice(uri + std::strlen(kScheme), [this](int frames) { return StaysPlugged(frames); });
    } catch (const std::exception& e) {
      getServices().errorLoggerAppend("%s", e.what());
      return nullptr;
    }
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }

  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    stopped_.notify_all();
    if (plug_.joinable()) plug_.join();
  }

 private:
  void Announce(const std::string& uri) {
    std::strncpy(info_.uri, uri.c_str(), sizeof info_.uri - 1);
    std::strncpy(info_.vendor, "Coach", sizeof info_.vendor - 1);
    std::strncpy(info_.name, "scene folder", sizeof info_.name - 1);
    deviceConnected(&info_);
  }

  bool StaysPlugged(int frames) {
    const char* text = std::getenv("COACH_OPENNI2_UNPLUG");
    if (!text || frames != std::atoi(text)) return true;
    if (plug_.joinable()) plug_.join();
    plug_ = std::thread([this] {
      deviceDisconnected(&info_);
      std::unique_lock lock(mutex_);
      // Not once the library shuts down: it would wait for this thread, and the call below for it.
      if (!stopped_.wait_for(lock, std::chrono::milliseconds(500), [this] { return stop_; })) deviceConnected(&info_);
    });
    return false;
  }

  OniDeviceInfo info_{};
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread plug_;
};

}  // namespace
}  // namespace coach

ONI_EXPORT_DRIVER(coach::SceneDriver)
