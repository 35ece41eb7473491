// What the reasoner says: which connections are made, what the lesson is at, and every decision with its reason. Plain
// data: the messages assembly_state_t and guidance_event_t without the bus.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace coach {

/// `connection` of a rigid contact that is on no list.
constexpr int kUnknownContact = -1000;

struct ConnectionState {
  enum class State { kOpen = 0, kMade = 1, kUncertain = 2 };
  int connection = 0;  ///< index into Task::connections; -1 - m for mistake m; kUnknownContact
  int part_a = -1, part_b = -1;
  double probability = 0;
  State state = State::kOpen;
  int64_t since = 0;    ///< us, estimated moment of the last change; 0 never
  int64_t decided = 0;  ///< us, when it was decided; 0 never
};

struct GuidanceEvent {
  int64_t id = 0;     ///< grows by one an event over the session
  int64_t utime = 0;  ///< us, when it was decided
  int64_t since = 0;  ///< us, when it happened, as estimated
  std::string kind;   ///< connect, wrong, disconnect, phase, say, act, operator, repair, session
  std::string subject;
  int part_a = -1, part_b = -1;
  double probability = 0;
  std::string reason;
};

enum class Phase {
  kIntroduction = 0,
  kAnnounce = 1,
  kWait = 2,
  kCorrect = 3,
  kWrong = 4,
  kIdle = 5,
  kAway = 6,
  kTrackingLost = 7,
  kPaused = 8,
  kComplete = 9,
};

struct AssemblyState {
  int64_t utime = 0;    ///< us, of the poses it comes from
  int64_t session = 0;  ///< identifies the lesson; survives a restart
  std::string task;
  Phase phase = Phase::kIntroduction;
  int idle_level = 0;  ///< 0 none .. 4
  int step = -1;       ///< index into Task::connections that is asked for
  int made = 0, required = 0;
  std::vector<ConnectionState> connections;  ///< every required connection, then every mistake that is present
  std::vector<GuidanceEvent> events;         ///< the last 8, oldest first
};

}  // namespace coach
