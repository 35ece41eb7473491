// coach-record: keeps the lesson's messages on disk.
#include <lcm/lcm.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <mutex>
#include <thread>

#include "common/bus/process_facts.h"
#include "common/bus/received_bytes.h"
#include "common/bus/service_main.h"
#include "tools/log/recorder.h"

namespace coach {
namespace {

constexpr int64_t kSilence = 10'000'000;  // us without a message that are worth a warning
constexpr int kQueue = 5000;              // messages that may wait for the disk

/// Every message of the station, as bytes, in a thread of its own: the disk may be slow.
class Listener {
 public:
  Listener(const std::string& url, const std::string& station, Recorder& recorder)
      : recorder_(recorder), lcm_(lcm_create(url.c_str())) {
    if (!lcm_) throw BusError(url + ": the network can't be used");
    const std::string quoted = "\\Q" + station + "\\E/.*";
    lcm_subscription_t* subscription = lcm_subscribe(lcm_, quoted.c_str(), &Listener::OnMessage, this);
    lcm_subscription_set_queue_capacity(subscription, kQueue);
    thread_ = std::thread([this] {
      while (!stopping_) lcm_handle_timeout(lcm_, 100);
    });
  }
  ~Listener() {
    stopping_ = true;
    thread_.join();
    lcm_destroy(lcm_);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  struct Figures {
    int64_t events, refused, hostile;
    bool disk_refuses;
    std::string file;
  };
  Figures Flush() {
    const std::lock_guard lock(mutex_);
    recorder_.Flush();
    return {recorder_.events(), recorder_.refused(), hostile_, recorder_.disk_refuses(), recorder_.file().string()};
  }

 private:
  static void OnMessage(const lcm_recv_buf_t* message, const char* channel, void* self) {
    auto& listener = *static_cast<Listener*>(self);
    const std::lock_guard lock(listener.mutex_);
    try {
      listener.recorder_.Write(message->recv_utime, channel, ReceivedBytes(*message));
    } catch (const std::invalid_argument&) {
      ++listener.hostile_;
    }
  }

  Recorder& recorder_;
  int64_t hostile_ = 0;  ///< packets that are no messages
  std::mutex mutex_;
  lcm_t* lcm_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

void Run(const ServiceContext& context, const RecorderOptions& options) {
  Recorder recorder(options);
  NodeOptions node_options = context.node;
  node_options.period_ms = 1000;
  Node node(node_options);
  Listener listener(context.station.table_url, context.station.name, recorder);
  spdlog::info("recording to {}, {} pictures", options.folder.string(), options.images ? "with" : "without");
  int64_t events = 0, hostile = 0, last_event = SteadyTime();
  node.Run([&] {
    const auto figures = listener.Flush();
    node.Received(figures.events + figures.refused + figures.hostile - node.statistics().received);
    node.Dropped(figures.hostile - hostile);
    hostile = figures.hostile;
    if (figures.events > events) last_event = SteadyTime();
    events = figures.events;
    if (figures.disk_refuses) {
      node.SetState(service_health_t::DEGRADED,
                    "the disk refuses: " + std::to_string(figures.refused) + " messages lost");
    } else if (SteadyTime() - last_event > kSilence) {
      node.SetState(service_health_t::DEGRADED, "nothing to record for 10 s");
    } else {
      node.SetState(service_health_t::OK, figures.file);
    }
  });
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  using namespace coach;
  std::string folder;
  return ServiceMain(
      argc, argv, "record", "Keeps the lesson's messages on disk; no pictures unless the station file says so",
      [&](CLI::App& app) { app.add_option("--folder", folder, "for the recordings, instead of the station file's"); },
      [&](ServiceContext& context) {
        RecorderOptions options = ReadRecorderOptions(context.station);
        if (!folder.empty()) options.folder = folder;
        Run(context, options);
      });
}
