// A service's place on the bus: its loop, its health, its end.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/assembly/robot_act.h"
#include "common/bus/bus.h"
#include "common/bus/service_statistics.h"

namespace coach {

struct NodeOptions {
  std::string service;          ///< name in SERVICE_HEALTH: capture, detector, ...
  std::string station;          ///< prefix of every channel
  std::string url;              ///< network; see Bus
  std::string output_url;       ///< where messages go instead, e.g. file:///out.lcm?mode=w; empty: to `url`
  std::string configuration;    ///< text of the station file, for CONFIG
  bool lockstep = false;        ///< keep wall time out of the output, as a recording as `url` does
  bool expects_frames = false;  ///< DEGRADED when no input came for 1 s
  int period_ms = 100;          ///< longest time between two calls of the step function
};

/// Everything a service's main() needs of the bus. One thread; only Wake() and Stop() may be called from others (Stop()
/// from signal handlers too).
///
/// Lockstep: a recording as `url` is worked through message by message, each followed by one call of the step function.
/// Then, or if NodeOptions::lockstep says so, wall time is 0, every received_utime that is published is 0, and CONFIG
/// is published once, so that the same input gives the same output. (SERVICE_HEALTH is no part of that promise.)
class Node {
 public:
  /// Opens the networks and starts listening for SIGTERM and SIGINT. At most one Node a process may run at a time.
  /// @throws BusError
  explicit Node(const NodeOptions& options);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  template <Message M>
  void Subscribe(std::function<void(const M&)> handler) {
    bus_->Subscribe<M>(std::move(handler));
  }
  template <NewestOnly M>
  void SubscribeNewest(std::function<void(const M&)> handler) {
    bus_->SubscribeNewest<M>(std::move(handler));
  }
  /// Sends to the output; a failure is counted.
  template <Message M>
  bool Publish(M message) {
    if constexpr (requires { message.received_utime; }) {
      if (lockstep()) message.received_utime = 0;
    }
    return output().Publish(message);
  }

  /// Another network that the same loop serves (the robot bus). Never null; lives as long as the node.
  Bus& Join(const std::string& url);

  /// Called once for every new operator command of this station; its id is echoed in SERVICE_HEALTH whether or not
  /// there is a handler.
  void OnOperatorCommand(std::function<void(const OperatorCommand&)> handler) {
    operator_handler_ = std::move(handler);
  }

  /// Counts. An input is received when it comes in (Received also says it is alive), and later answered or dropped.
  void Received(int64_t inputs = 1);
  void Dropped(int64_t inputs = 1) { statistics_.dropped += inputs; }
  /// To be called after publishing what one input led to. The step's time is counted from the moment the loop woke up.
  /// @param received_utime of the frame it descends from, us; 0 unknown.
  void Answered(int64_t received_utime);

  /// The service's own view of itself; the node adds what it sees (no input, malformed messages, a second service of
  /// the same name).
  void SetState(int8_t state, const std::string& message);

  /// Handles messages and calls `step` after each batch of them, after each Wake(), and at least every period_ms, until
  /// asked to stop or, in lockstep, until the recording ends. Exceptions from `step` are counted and logged like those
  /// of handlers. Says READY and WATCHDOG to systemd from this loop only: a step that hangs is a service that hangs.
  void Run(const std::function<void()>& step);
  void Stop();  ///< Run() returns within one step
  void Wake();  ///< another thread has work for `step`
  bool stopping() const;

  bool lockstep() const { return options_.lockstep || bus_->lockstep(); }
  int64_t Now() const;  ///< us since 1970; 0 in lockstep
  const std::string& station() const { return options_.station; }
  const std::string& service() const { return options_.service; }
  const ServiceStatistics& statistics() const { return statistics_; }

  /// What SERVICE_HEALTH says at this moment.
  service_health_t Health();

 private:
  Bus& output() { return output_ ? *output_ : *bus_; }
  void HandleOperatorCommand(const operator_command_t& message);
  void HandleHealth(const service_health_t& message);
  void Wait();
  bool HandleBuses();
  void CallStep(const std::function<void()>& step);
  void PublishByTheClock();
  void PublishConfiguration();

  NodeOptions options_;
  std::unique_ptr<Bus> bus_, output_;
  std::vector<std::unique_ptr<Bus>> joined_;
  std::function<void(const OperatorCommand&)> operator_handler_;
  std::array<int64_t, 16> operator_ids_{};  ///< the last ones, so that repeats are known
  size_t num_operator_commands_ = 0;
  ServiceStatistics statistics_;
  int8_t state_ = service_health_t::STARTING;
  std::string message_;
  int64_t woke_up_ = 0, last_input_ = 0, last_health_ = 0, last_config_ = 0,
          last_watchdog_ = 0;  ///< us, steady clock; 0 never
  int64_t step_errors_ = 0, last_error_log_ = 0;
  RollingWindow recent_errors_;
  int64_t errors_seen_ = 0;
  std::string rival_;        ///< host and pid of another service of this name
  int64_t rival_heard_ = 0;  ///< us, steady clock
};

}  // namespace coach
