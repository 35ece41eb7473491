#include "common/bus/bus.h"

#include <arpa/inet.h>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "common/bus/received_bytes.h"

namespace coach {
namespace {

constexpr int kQueueCapacity = 1000;  // messages a subscription; LCM's own 30 loses commands behind a second of work
constexpr int kImageQueueCapacity =
    30;  // of channels of which the newest counts: bounds what a reader that stalls holds
constexpr int kMaxMessagesAtOnce = 1000;      // a flooded bus must not keep the service from its work
constexpr int64_t kLogInterval = 10'000'000;  // us

int64_t SteadyMicroseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

bool StartsWith(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }

void CheckStation(const std::string& station) {
  const auto good = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
  };
  if (station.empty() || station.size() > 32 || !std::all_of(station.begin(), station.end(), good))
    throw BusError("station '" + station + "': 1 to 32 characters of A-Z a-z 0-9 _ - . expected");
}

/// Says what LCM itself doesn't: whether the kernel knows a way to the group, and how to give it one.
void CheckMulticastRoute(const std::string& url) {
  std::string group = "239.255.76.67";
  int port = 7667;
  const std::string address = url.substr(std::strlen("udpm://"), url.find('?') - std::strlen("udpm://"));
  if (!address.empty()) {
    const size_t colon = address.find(':');
    group = address.substr(0, colon);
    if (colon != std::string::npos) port = std::atoi(address.c_str() + colon + 1);
  }
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<uint16_t>(port));
  if (inet_pton(AF_INET, group.c_str(), &to.sin_addr) != 1 || !IN_MULTICAST(ntohl(to.sin_addr.s_addr)) || port < 1 ||
      port > 65535)
    throw BusError(url + ": udpm://GROUP:PORT with a multicast group (224.0.0.0 .. 239.255.255.255) expected");
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool reachable = probe >= 0 && connect(probe, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  if (probe >= 0) close(probe);
  if (!reachable)
    throw BusError("no multicast route to " + group +
                   "; add one with: sudo ip link set lo multicast on && sudo ip route add " + group + "/32 dev lo");
}

/// Channels are regular expressions to LCM.
std::string Literal(const std::string& channel) {
  std::string pattern;
  for (const char c : channel) {
    if (c == '.') pattern += '\\';
    pattern += c;
  }
  return pattern;
}

}  // namespace

struct Bus::Subscription {
  Bus* bus;
  std::string channel;
  bool newest;
  ByteHandler handler;
  std::vector<uint8_t> waiting;  ///< newest message that was not given to the handler yet
  int64_t num_waiting = 0;
};

Bus::Bus(const std::string& url, const std::string& station)
    : url_(url), station_(station), lockstep_(StartsWith(url, "file://") && url.find("mode=w") == std::string::npos) {
  CheckStation(station);
  if (StartsWith(url, "udpm://")) CheckMulticastRoute(url);
  lcm_ = lcm_create(url.c_str());
  if (!lcm_) throw BusError("cannot open the LCM network " + url + (lockstep_ ? " (is there such a recording?)" : ""));
  // The file descriptor is made, and the network tested, at the first call.
  if (!StartsWith(url, "file://") && lcm_get_fileno(lcm_) < 0) {
    lcm_destroy(lcm_);
    throw BusError("LCM's self-test failed on " + url + ": multicast does not come back to this machine");
  }
}

Bus::~Bus() { lcm_destroy(lcm_); }

int Bus::file_descriptor() const { return lcm_get_fileno(lcm_); }

void Bus::Add(const std::string& channel, bool newest_only, bool skip, ByteHandler handler) {
  const std::string full = station_ + "/" + channel;
  auto subscription =
      std::make_unique<Subscription>(Subscription{this, full, skip && !lockstep_, std::move(handler), {}, 0});
  const auto receive = [](const lcm_recv_buf_t* buffer, const char*, void* user) {
    auto& self = *static_cast<Subscription*>(user);
    self.bus->Receive(self, *buffer);
  };
  lcm_subscription_t* handle = lcm_subscribe(lcm_, Literal(full).c_str(), receive, subscription.get());
  if (!handle) throw BusError("cannot subscribe to " + full + " on " + url_);
  lcm_subscription_set_queue_capacity(handle, newest_only ? kImageQueueCapacity : kQueueCapacity);
  subscriptions_.push_back(std::move(subscription));
}

void Bus::Receive(Subscription& subscription, const lcm_recv_buf_t& message) {
  ++received_;
  std::span<const uint8_t> bytes;
  try {
    bytes = ReceivedBytes(message);
  } catch (const std::invalid_argument& e) {
    return CountError(subscription, 0, e.what());
  }
  if (!subscription.newest) return Dispatch(subscription, bytes);
  subscription.waiting.assign(bytes.begin(), bytes.end());
  ++subscription.num_waiting;
}

void Bus::Dispatch(Subscription& subscription, std::span<const uint8_t> bytes) {
  std::string why = "unknown exception";
  try {
    return subscription.handler(bytes);
  } catch (const std::exception& e) {
    why = e.what();
  } catch (...) {
  }
  CountError(subscription, bytes.size(), why);
}

void Bus::CountError(const Subscription& subscription, size_t size, const std::string& why) {
  ++errors_;
  const int64_t now = SteadyMicroseconds();
  if (last_log_us_ != 0 && now - last_log_us_ < kLogInterval) return;
  last_log_us_ = now;
  spdlog::warn("{}: message of {} bytes dropped: {} ({} so far)", subscription.channel, size, why, errors_);
}

void Bus::DispatchNewest() {
  for (const auto& subscription : subscriptions_) {
    if (subscription->num_waiting == 0) continue;
    skipped_ += subscription->num_waiting - 1;
    subscription->num_waiting = 0;
    Dispatch(*subscription, subscription->waiting);
  }
}

bool Bus::Refuse(const std::string& channel) {
  if (publish_errors_++ == 0)
    spdlog::error("{}/{}: message not sent: its counts do not agree with its arrays", station_, channel);
  return false;
}

bool Bus::PublishBytes(const std::string& channel, std::span<const uint8_t> bytes) {
  const std::string full = station_ + "/" + channel;
  if (lcm_publish(lcm_, full.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) == 0) return true;
  if (publish_errors_++ == 0)
    spdlog::error("{}: message of {} bytes not sent on {}: {}", full, bytes.size(), url_, std::strerror(errno));
  return false;
}

int Bus::Handle(int timeout_ms) {
  int handled = 0;
  while (handled < (lockstep_ ? 1 : kMaxMessagesAtOnce)) {
    errno = 0;
    const int result = lcm_handle_timeout(lcm_, handled == 0 ? timeout_ms : 0);
    if (result < 0 && errno != EINTR && lockstep_) return -1;
    if (result <= 0) break;
    ++handled;
  }
  DispatchNewest();
  return handled;
}

}  // namespace coach
