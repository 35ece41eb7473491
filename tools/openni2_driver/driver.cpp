// An OpenNI2 driver: a scene folder, or a simulated child at a table, is a camera.
//
// A scene folder is announced if $COACH_OPENNI2_SCENE names it, and opened on demand for the address
// coach-scene:FOLDER. It begins again when it is over; time stamps grow. A child is announced if $COACH_OPENNI2_STATION
// names a station file, whose task the child builds and on whose network it hears the robot ($COACH_OPENNI2_CHILD:
// listens, errs or never-listens; $COACH_OPENNI2_SEED: of room and child; $COACH_OPENNI2_TRUTH: folder for events.json,
// what really happened), and opened on demand for coach-child:STATION.yaml. $COACH_OPENNI2_FPS is the rate of either
// (30 Hz, child 15 Hz). After $COACH_OPENNI2_UNPLUG frames (default: never) the camera is unplugged, and plugged in
// again 0.5 s later.
//
// With $COACH_OPENNI2_BEGIN (s of the monotonic clock) a scene goes on whether or not anybody looks: its first frame
// stands still until then, its last one after the end. With $COACH_OPENNI2_PLUG the camera is gone once there is no
// file of that name, and found by whoever starts OpenNI2 when there is one.
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
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <thread>

#include "tools/openni2_driver/picture_source.h"

namespace coach {
namespace {

constexpr char kScene[] = "coach-scene:", kChild[] = "coach-child:";

std::string Setting(const char* name, const std::string& otherwise = "") {
  const char* text = std::getenv(name);
  return text ? text : otherwise;
}

/// What follows `scheme` in the address; empty if it does not begin with it.
std::string After(const std::string& uri, const std::string& scheme) {
  return uri.rfind(scheme, 0) == 0 ? uri.substr(scheme.size()) : "";
}

bool IsOurs(const std::string& uri) { return !After(uri, kScene).empty() || !After(uri, kChild).empty(); }

std::unique_ptr<PictureSource> OpenPictures(const std::string& uri) {
  const double fps = std::atof(Setting("COACH_OPENNI2_FPS").c_str());
  if (const std::string folder = After(uri, kScene); !folder.empty()) {
    const std::string begin = Setting("COACH_OPENNI2_BEGIN");
    return OpenScenePictures(folder, fps > 0 ? fps : 30,
                             begin.empty() ? std::nullopt : std::optional(std::atof(begin.c_str())));
  }
  ChildOptions child;
  child.station = After(uri, kChild);
  child.temper = Setting("COACH_OPENNI2_CHILD", "listens");
  child.seed = std::strtoull(Setting("COACH_OPENNI2_SEED", "1").c_str(), nullptr, 10);
  if (fps > 0) child.fps = fps;
  child.truth = Setting("COACH_OPENNI2_TRUTH");
  return OpenChildPictures(child);
}

bool Unplugged() {
  const std::string plug = Setting("COACH_OPENNI2_PLUG");
  return !plug.empty() && !std::filesystem::exists(plug);
}

template <class T>
OniStatus Give(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  *size = sizeof(T);
  return ONI_STATUS_OK;
}

/// One of the camera's two streams.
class PictureStream final : public oni::driver::StreamBase {
 public:
  PictureStream(OniSensorType sensor, const CameraModel& camera, double fps, std::function<void(PictureStream*)> forget)
      : forget_(std::move(forget)), sensor_(sensor), camera_(camera) {
    mode_.pixelFormat = sensor == ONI_SENSOR_DEPTH ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888;
    mode_.resolutionX = camera.width;
    mode_.resolutionY = camera.height;
    mode_.fps = static_cast<int>(std::lround(fps));
  }
  ~PictureStream() override { forget_(this); }

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

  std::function<void(PictureStream*)> forget_;
  OniSensorType sensor_;
  CameraModel camera_;
  OniVideoMode mode_{};
  std::atomic<bool> started_{false};
};

class PictureDevice final : public oni::driver::DeviceBase {
 public:
  /// @param plugged asked after each frame, with the number of frames so far, whether the camera goes on
  PictureDevice(std::unique_ptr<PictureSource> pictures, std::function<bool(int)> plugged)
      : pictures_(std::move(pictures)), plugged_(std::move(plugged)) {
    for (const OniSensorType sensor : {ONI_SENSOR_DEPTH, ONI_SENSOR_COLOR})
      modes_[sensor] = PictureStream(sensor, pictures_->camera(), pictures_->fps(), [](PictureStream*) {}).mode();
    sensors_[0] = {ONI_SENSOR_DEPTH, 1, &modes_[ONI_SENSOR_DEPTH]};
    sensors_[1] = {ONI_SENSOR_COLOR, 1, &modes_[ONI_SENSOR_COLOR]};
    thread_ = std::thread([this] { Work(); });
  }
  ~PictureDevice() override {
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
    auto* stream =
        new PictureStream(sensor, pictures_->camera(), pictures_->fps(), [this](PictureStream* s) { Forget(s); });
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
  void Forget(PictureStream* stream) {
    const std::lock_guard lock(mutex_);
    std::erase(streams_, stream);
  }

  void Work() {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    int count = 0;
    for (int frames = 1;; ++frames) {
      const Frame frame = pictures_->At(count);
      const auto time = static_cast<uint64_t>(std::llround(1e6 * count / pictures_->fps()));
      {
        std::unique_lock lock(mutex_);
        if (changed_.wait_until(lock, begin + std::chrono::microseconds(time), [this] { return stop_; })) return;
        for (PictureStream* stream : streams_) stream->Raise(frame, time, count);
      }
      if (!plugged_(frames)) return;
      // A picture that takes longer than a period makes the camera leave some out, not run late.
      const double now = std::chrono::duration<double>(Clock::now() - begin).count();
      count = std::max(count + 1, static_cast<int>(now * pictures_->fps()));
    }
  }

  std::unique_ptr<PictureSource> pictures_;
  std::function<bool(int)> plugged_;
  std::map<OniSensorType, OniVideoMode> modes_;
  OniSensorInfo sensors_[2];
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  std::vector<PictureStream*> streams_;
  std::thread thread_;
};

class PictureDriver final : public oni::driver::DriverBase {
 public:
  explicit PictureDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, changed, cookie);
    if (status != ONI_STATUS_OK || Unplugged()) return status;
    const std::string folder = Setting("COACH_OPENNI2_SCENE"), station = Setting("COACH_OPENNI2_STATION");
    if (!folder.empty()) Announce(kScene + folder);
    if (folder.empty() && !station.empty()) Announce(kChild + station);
    return status;
  }
  OniStatus tryDevice(const char* uri) override {
    if (!IsOurs(uri)) return ONI_STATUS_ERROR;
    Announce(uri);
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    try {
      return new PictureDevice(OpenPictures(uri), [this](int frames) { return StaysPlugged(frames); });
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
    std::strncpy(info_.name, After(uri, kScene).empty() ? "simulated child" : "scene folder", sizeof info_.name - 1);
    deviceConnected(&info_);
  }

  bool StaysPlugged(int frames) {
    const char* text = std::getenv("COACH_OPENNI2_UNPLUG");
    if ((!text || frames != std::atoi(text)) && !Unplugged()) return true;
    if (plug_.joinable()) plug_.join();
    plug_ = std::thread([this] {
      deviceDisconnected(&info_);
      std::unique_lock lock(mutex_);
      // Not once the library shuts down: it would wait for this thread, and the call below for it.
      if (!stopped_.wait_for(lock, std::chrono::milliseconds(500), [this] { return stop_; }) && !Unplugged())
        deviceConnected(&info_);
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

ONI_EXPORT_DRIVER(coach::PictureDriver)
