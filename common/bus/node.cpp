#include "common/bus/node.h"

#include <openssl/evp.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>

#include "common/bus/messages.h"
#include "common/bus/process_facts.h"
#include "common/bus/systemd_notify.h"

namespace coach {
namespace {

constexpr int64_t kSecond = 1'000'000;  // us

// Signal handlers reach nothing but these.
std::atomic<bool> stop_asked{false};
std::atomic<int> wake_fd{-1};

void WakeUp() {
  const uint64_t one = 1;
  if (const int fd = wake_fd; fd >= 0) [[maybe_unused]]
    const ssize_t written = write(fd, &one, sizeof one);
}

void HandleSignal(int) {
  stop_asked = true;
  WakeUp();
}

void SetSignals(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
}

std::string Sha256(const std::string& text) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned length = 0;
  EVP_Digest(text.data(), text.size(), digest, &length, EVP_sha256(), nullptr);
  std::string hex;
  for (unsigned i = 0; i < length; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

float Milliseconds(double us) { return static_cast<float>(us * 1e-3); }

}  // namespace

Node::Node(const NodeOptions& options) : options_(options), bus_(std::make_unique<Bus>(options.url, options.station)) {
  if (!options.output_url.empty()) output_ = std::make_unique<Bus>(options.output_url, options.station);
  bus_->Subscribe<operator_command_t>([this](const operator_command_t& m) { HandleOperatorCommand(m); });
  if (!bus_->lockstep()) bus_->Subscribe<service_health_t>([this](const service_health_t& m) { HandleHealth(m); });
  stop_asked = false;
  wake_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  SetSignals(HandleSignal);
}

Node::~Node() {
  SetSignals(SIG_DFL);
  close(wake_fd.exchange(-1));
}

Bus& Node::Join(const std::string& url) {
  joined_.push_back(std::make_unique<Bus>(url, options_.station));
  joined_.back()->Subscribe<operator_command_t>([this](const operator_command_t& m) { HandleOperatorCommand(m); });
  return *joined_.back();
}

void Node::HandleOperatorCommand(const operator_command_t& message) {
  const OperatorCommand command = FromMessage(message);
  if (command.station != options_.station)
    throw std::invalid_argument("operator command for station '" + command.station + "'");
  if (std::find(operator_ids_.begin(), operator_ids_.end(), command.id) != operator_ids_.end()) return;
  operator_ids_[num_operator_commands_++ % operator_ids_.size()] = command.id;
  if (operator_handler_) operator_handler_(command);
}

void Node::HandleHealth(const service_health_t& message) {
  if (message.service != options_.service || (message.pid == getpid() && message.host == HostName())) return;
  rival_ = message.host + " pid " + std::to_string(message.pid);
  const int64_t now = SteadyTime();
  if (rival_heard_ == 0 || now - rival_heard_ > 10 * kSecond)
    spdlog::error("another {} serves station {}: {}; stop one of the two", options_.service, options_.station, rival_);
  rival_heard_ = now;
}

void Node::Received(int64_t inputs) {
  statistics_.received += inputs;
  last_input_ = SteadyTime();
}

void Node::Answered(int64_t received_utime) {
  const int64_t now = SteadyTime();
  ++statistics_.answered;
  statistics_.work_us.Add(now, static_cast<double>(now - woke_up_));
  if (received_utime > 0) statistics_.latency_us.Add(now, static_cast<double>(WallTime() - received_utime));
  if (state_ == service_health_t::STARTING) state_ = service_health_t::OK;
}

void Node::SetState(int8_t state, const std::string& message) {
  if (state_ != state || message_ != message)
    spdlog::log(state >= service_health_t::DEGRADED ? spdlog::level::warn : spdlog::level::info, "{}",
                message.empty() ? "running" : message);
  state_ = state;
  message_ = message;
}

void Node::Stop() { HandleSignal(0); }
void Node::Wake() { WakeUp(); }
bool Node::stopping() const { return stop_asked; }

int64_t Node::Now() const { return lockstep() ? 0 : WallTime(); }

void Node::Run(const std::function<void()>& step) {
  NotifySystemd("READY=1");
  if (lockstep()) PublishConfiguration();
  while (!stop_asked) {
    Wait();
    woke_up_ = SteadyTime();
    const bool alive = HandleBuses();
    if (stop_asked) break;
    CallStep(step);
    if (!alive) break;
    if (!bus_->lockstep()) PublishByTheClock();
  }
  NotifySystemd("STOPPING=1");
}

void Node::Wait() {
  if (bus_->lockstep()) return;
  std::vector<pollfd> fds{{wake_fd, POLLIN, 0}, {bus_->file_descriptor(), POLLIN, 0}};
  for (const auto& bus : joined_) fds.push_back({bus->file_descriptor(), POLLIN, 0});
  poll(fds.data(), fds.size(), options_.period_ms);
  uint64_t count = 0;
  [[maybe_unused]] const ssize_t got = read(wake_fd, &count, sizeof count);
}

bool Node::HandleBuses() {
  if (bus_->Handle(0) < 0) return false;
  for (const auto& bus : joined_) bus->Handle(0);
  return true;
}

void Node::CallStep(const std::function<void()>& step) {
  std::string why = "unknown exception";
  try {
    return step();
  } catch (const std::exception& e) {
    why = e.what();
  } catch (...) {
  }
  ++step_errors_;
  const int64_t now = SteadyTime();
  if (last_error_log_ != 0 && now - last_error_log_ < 10 * kSecond) return;
  last_error_log_ = now;
  spdlog::error("step failed: {} ({} so far)", why, step_errors_);
}

void Node::PublishByTheClock() {
  const int64_t now = SteadyTime();
  if (const auto interval = WatchdogInterval(); interval && now - last_watchdog_ >= std::min(*interval / 3, kSecond)) {
    last_watchdog_ = now;
    NotifySystemd("WATCHDOG=1");
  }
  if (now - last_health_ >= kSecond) {
    last_health_ = now;
    Publish(Health());
  }
  if (!lockstep() && (now - last_config_ >= 10 * kSecond || last_config_ == 0)) {
    last_config_ = now;
    PublishConfiguration();
  }
}

void Node::PublishConfiguration() {
  config_t message;
  message.service = options_.service;
  message.version = COACH_VERSION;
  message.yaml = options_.configuration;
  message.sha256 = Sha256(options_.configuration);
  Publish(message);
}

service_health_t Node::Health() {
  const int64_t now = SteadyTime();
  service_health_t health;
  health.utime = WallTime();
  health.station = options_.station;
  health.service = options_.service;
  health.host = HostName();
  health.pid = getpid();
  health.state = state_;
  health.message = message_;
  health.rate = static_cast<float>(statistics_.work_us.Rate(now));
  health.latency_p50_ms = Milliseconds(statistics_.latency_us.Percentile(now, 50));
  health.latency_p99_ms = Milliseconds(statistics_.latency_us.Percentile(now, 99));
  health.work_p50_ms = Milliseconds(statistics_.work_us.Percentile(now, 50));
  health.work_p99_ms = Milliseconds(statistics_.work_us.Percentile(now, 99));
  health.received = statistics_.received;
  health.answered = statistics_.answered;
  health.dropped = statistics_.dropped;
  health.socket_drops = SocketDrops();
  health.decode_errors = step_errors_ + bus_->errors();
  for (const auto& bus : joined_) health.decode_errors += bus->errors();
  health.last_operator_command =
      num_operator_commands_ ? operator_ids_[(num_operator_commands_ - 1) % operator_ids_.size()] : 0;
  health.resident_bytes = ResidentBytes();

  const auto degrade = [&](const std::string& why) {
    health.state = std::max(health.state, service_health_t::DEGRADED);
    health.message += (health.message.empty() ? "" : "; ") + why;
  };
  if (options_.expects_frames && now - last_input_ > kSecond)
    degrade(last_input_ ? "no input for over 1 s" : "no input yet");
  recent_errors_.Add(now, static_cast<double>(health.decode_errors - errors_seen_));
  errors_seen_ = health.decode_errors;
  if (recent_errors_.Percentile(now, 100) > 0) degrade("bad messages or failed steps in the last 5 s");
  if (rival_heard_ != 0 && now - rival_heard_ < 3 * kSecond)
    degrade("another " + options_.service + " on this station: " + rival_);
  return health;
}

}  // namespace coach
