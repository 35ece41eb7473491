// Plays the guidance's side of the robot bus: sends acts, each repeated five times a second until it is answered or out
// of date, and prints what became of each: one line "ID STATE" at the end.
//
// usage: robot_link_sender URL STATION COUNT KEY_FILE
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "common/bus/bus.h"
#include "common/bus/command_signature.h"
#include "common/bus/messages.h"

namespace {

using namespace coach;

constexpr int64_t kSecond = 1000000;
constexpr int64_t kValidity = 4 * kSecond, kRepeat = kSecond / 5, kPause = 7 * kSecond / 10;
constexpr int64_t kClockOffset = 60 * kSecond;  // the two hosts' clocks are a minute apart

int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

struct Sent {
  RobotCommand command;
  int64_t begun = 0, next = 0;
  ActState state = ActState::kNone;
};

/// The same command under other numbers: unsigned, signed by another's key, and with the signature of the true one.
void Forge(Bus& bus, robot_command_t message, const std::string& key) {
  message.id += 1000;
  bus.Publish(message);
  std::fill(std::begin(message.hmac), std::end(message.hmac), uint8_t{0});
  message.id += 1000;
  bus.Publish(message);
  message.id += 1000;
  Sign(message, key + "x");
  bus.Publish(message);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  Bus bus(argv[1], argv[2]);
  const int count = std::atoi(argv[3]);
  const std::string key = ReadKey(argv[4]);
  std::map<int64_t, Sent> acts;
  bus.Subscribe<robot_status_t>([&](const robot_status_t& message) {
    const RobotStatus status = FromMessage(message);
    const auto act = acts.find(status.command_id);
    // Statuses overtake each other on no network, but repeats of older ones may come late.
    if (act != acts.end() && status.state > act->second.state) act->second.state = status.state;
  });
  const int64_t begun = Now();
  const int64_t end = begun + count * kPause + 12 * kSecond;
  for (int64_t now = begun; now < end; now = Now()) {
    const auto id = static_cast<int64_t>(acts.size()) + 1;
    if (id <= count && now >= begun + (id - 1) * kPause) {
      Sent sent;
      sent.command.id = id;
      sent.command.station = argv[2];
      sent.command.session = 1;
      sent.command.text = "x";
      sent.begun = sent.next = now;
      acts[id] = sent;
    }
    for (auto& [number, sent] : acts) {
      const int64_t left = sent.begun + kValidity - now;
      if (sent.state != ActState::kNone || now < sent.next || left <= 0) continue;
      sent.next = now + kRepeat;
      sent.command.sent_utime = now + kClockOffset;
      sent.command.valid_for_us = left;
      robot_command_t message = ToMessage(sent.command);
      if (!key.empty()) Sign(message, key);
      bus.Publish(message);
      if (!key.empty()) Forge(bus, message, key);
    }
    bus.Handle(20);
  }
  for (const auto& [id, sent] : acts) std::printf("%lld %s\n", static_cast<long long>(id), ToString(sent.state));
  return 0;
}
