#include "tools/report/log_session.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "common/bus/decode_message.h"
#include "common/bus/messages.h"
#include "tools/log/log_file.h"

namespace coach {
namespace {

using Bytes = std::span<const uint8_t>;

/// Sorts messages into a session.
class Collector {
 public:
  explicit Collector(Session& session) : session_(session) {
    Add<part_poses_t>([this](const auto& m) { OnPoses(m); });
    Add<assembly_state_t>([this](const auto& m) { OnState(m); });
    Add<guidance_event_t>([this](const auto& m) { OnEvent(FromMessage(m)); });
    Add<task_t>([this](const auto& m) { OnTask(m); });
    Add<robot_command_t>([this](const auto& m) { OnCommand(FromMessage(m)); });
    Add<robot_status_t>([this](const auto& m) { OnStatus(FromMessage(m)); });
    Add<service_health_t>([this](const auto& m) { OnHealth(m); });
    Add<config_t>([this](const auto& m) { OnConfiguration(m); });
    Add<annotation_t>([this](const auto& m) {
      annotations_.push_back({m.utime, m.id, m.annotator, m.kind, m.subject, m.value, m.replaces_id});
    });
  }

  bool Wants(const std::string& channel) const { return handlers_.contains(channel); }

  void Take(int64_t logged, const std::string& channel, Bytes bytes) {
    logged_ = logged;
    if (!clock_known_) waiting_.push_back({logged, channel, {bytes.begin(), bytes.end()}});
    if (!clock_known_ && !SetClock(channel, bytes)) return;
    if (waiting_.empty()) {
      handlers_.at(channel)(bytes);
      return;
    }
    for (const auto& [at, name, content] : std::exchange(waiting_, {})) {
      logged_ = at;
      handlers_.at(name)(content);
    }
  }

  /// What is left when the log ends.
  void Finish() {
    clock_known_ = true;  // no data: the recorder's clock it is
    for (const auto& [at, name, content] : std::exchange(waiting_, {})) {
      logged_ = at;
      handlers_.at(name)(content);
    }
    session_.annotations = InForce(annotations_);
    std::stable_sort(session_.annotations.begin(), session_.annotations.end(),
                     [](const Annotation& a, const Annotation& b) { return a.utime < b.utime; });
    for (const auto& [channel, count] : other_version_)
      session_.problems.push_back(channel + ": " + std::to_string(count) +
                                  " messages of another version of Coach, left out");
    for (const auto& [channel, count] : damaged_)
      session_.problems.push_back(channel + ": " + std::to_string(count) + " damaged messages, left out");
  }

 private:
  struct Waiting {
    int64_t logged;
    std::string channel;
    std::vector<uint8_t> bytes;
  };

  template <Message M>
  void Add(std::function<void(const M&)> handler) {
    handlers_[kChannel<M>] = [this, handler = std::move(handler)](Bytes bytes) {
      if (!HasFingerprint<M>(bytes)) {
        ++other_version_[kChannel<M>];
        return;
      }
      try {
        handler(DecodeMessage<M>(bytes));
      } catch (const std::exception&) {
        ++damaged_[kChannel<M>];
      }
    };
  }

  /// Frames tie the recorder's clock to the data's.
  bool SetClock(const std::string& channel, Bytes bytes) {
    if (channel != kChannel<part_poses_t> || !HasFingerprint<part_poses_t>(bytes)) return false;
    try {
      clock_ = logged_ - DecodeMessage<part_poses_t>(bytes).utime;
    } catch (const std::exception&) {
      return false;
    }
    return clock_known_ = true;
  }

  int64_t Now() const { return logged_ - clock_; }

  void Note(int64_t utime) {
    if (!begun_) session_.begin = session_.end = utime;
    begun_ = true;
    session_.begin = std::min(session_.begin, utime);
    session_.end = std::max(session_.end, utime);
  }

  void OnPoses(const part_poses_t& m) {
    const PartPoses poses = FromMessage(m);
    clock_ = logged_ - poses.utime;
    TrackedFrame frame;
    frame.utime = poses.utime;
    if (poses.received_utime > 0) frame.latency_ms = static_cast<float>(logged_ - poses.received_utime) / 1000;
    frame.table_found = m.table_found != 0;
    for (const PartEstimate& part : poses.parts) {
      frame.parts.push_back({part.status, static_cast<float>(part.visible_fraction)});
      frame.exchanges += part.identity_exchange >= 0;
    }
    frame.exchanges = (frame.exchanges + 1) / 2;  // both partners say it
    session_.frames.push_back(std::move(frame));
    Note(poses.utime);
  }

  void OnState(const assembly_state_t& m) {
    AssemblyState state = FromMessage(m);
    for (const GuidanceEvent& e : state.events) OnEvent(e);
    state.events.clear();
    if (state.utime == 0) state.utime = Now();
    Note(state.utime);
    session_.states.push_back(std::move(state));
  }

  void OnEvent(const GuidanceEvent& e) {
    if (!known_events_.emplace(e.id, e.utime, e.kind, e.subject).second) return;
    session_.events.push_back(e);
    if (e.utime == 0) session_.events.back().utime = session_.events.back().since = Now();  // before the first frame
    Note(session_.events.back().utime);
  }

  void OnTask(const task_t& m) {
    const auto known = [&](const TaskNames& t) { return t.name == m.name && t.sha256 == m.sha256; };
    if (std::any_of(session_.tasks.begin(), session_.tasks.end(), known)) return;
    session_.tasks.push_back({m.name, m.sha256, m.types, m.parts, m.connections, m.mistakes,
                              std::vector<int>(m.part_types.begin(), m.part_types.end())});
  }

  void OnCommand(const RobotCommand& command) {
    Note(Now());
    const auto [place, fresh] = act_of_.emplace(std::pair(command.session, command.id), session_.acts.size());
    if (fresh) session_.acts.push_back({command, Now(), 0, 0, ActState::kNone, "", false, false});
  }

  void OnStatus(const RobotStatus& status) {
    Note(Now());
    if (session_.links.empty() || session_.links.back().connected != status.connected ||
        session_.links.back().back_end != status.back_end)
      session_.links.push_back({Now(), status.connected, status.back_end});
    const auto found = act_of_.find(std::pair(status.session, status.command_id));
    if (found == act_of_.end()) return;
    RobotAct& act = session_.acts[found->second];
    if (act.ended != 0) return;
    act.state = status.state;
    act.reason = status.reason;
    act.point_clamped |= status.point_clamped;
    act.gaze_clamped |= status.gaze_clamped;
    if (status.state == ActState::kStarted && act.started == 0) act.started = Now();
    if (status.state >= ActState::kDone) act.ended = Now();
  }

  void OnHealth(const service_health_t& m) {
    Note(Now());
    session_.health.push_back({Now(), m.service, m.host, m.message, m.pid, m.state, m.latency_p50_ms, m.latency_p99_ms,
                               m.received, m.answered, m.dropped, m.socket_drops, m.decode_errors});
  }

  void OnConfiguration(const config_t& m) {
    const auto known = [&](const Configuration& c) {
      return c.service == m.service && c.version == m.version && c.sha256 == m.sha256;
    };
    if (std::any_of(session_.configurations.begin(), session_.configurations.end(), known)) return;
    session_.configurations.push_back({m.service, m.version, m.sha256, m.yaml});
  }

  Session& session_;
  std::map<std::string, std::function<void(Bytes)>> handlers_;
  std::map<std::string, int64_t> other_version_, damaged_;
  std::vector<Waiting> waiting_;  // what came before the first frame
  std::vector<Annotation> annotations_;
  std::set<std::tuple<int64_t, int64_t, std::string, std::string>> known_events_;
  std::map<std::pair<int64_t, int64_t>, size_t> act_of_;  // session and id of a command
  int64_t logged_ = 0, clock_ = 0;                        // us; clock: recorder's time - data's time
  bool clock_known_ = false, begun_ = false;
};

std::pair<std::string, std::string> StationAndChannel(const std::string& name) {
  const size_t slash = name.rfind('/');
  if (slash == std::string::npos) return {"", name};
  return {name.substr(0, slash), name.substr(slash + 1)};
}

/// Messages of each station on channels that a report reads.
std::map<std::string, int64_t> Stations(const std::vector<std::filesystem::path>& files, const Collector& collector) {
  std::map<std::string, int64_t> stations;
  for (const auto& file : files) {
    LogReader reader(file);
    while (const auto event = reader.Next()) {
      const auto [station, channel] = StationAndChannel(event->channel);
      if (collector.Wants(channel)) ++stations[station];
    }
  }
  return stations;
}

}  // namespace

Session ReadLogSession(const std::vector<std::filesystem::path>& files, const std::string& station) {
  Session session;
  session.has_bus = true;
  session.station = station;
  Collector collector(session);
  const auto stations = Stations(files, collector);
  if (station.empty() && !stations.empty())
    session.station = std::max_element(stations.begin(), stations.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
  for (const auto& [name, count] : stations) {
    if (name != session.station)
      session.problems.push_back("station " + name + ": " + std::to_string(count) + " messages, left out");
  }
  for (const auto& file : files) {
    LogReader reader(file);
    int64_t events = 0;
    for (; const auto event = reader.Next(); ++events) {
      const auto [from, channel] = StationAndChannel(event->channel);
      if (from == session.station && collector.Wants(channel)) collector.Take(event->utime, channel, event->bytes);
    }
    const std::string name = file.filename().string();
    if (events == 0) {
      session.problems.push_back(name + ": the recording is empty");
    } else if (!reader.complete()) {
      session.problems.push_back(name + ": the recording is cut off or damaged; the report covers what comes before");
    }
  }
  if (stations.empty() || !stations.contains(session.station))
    session.problems.push_back("no message of Coach" + (station.empty() ? "" : " of the station " + station));
  collector.Finish();
  return session;
}

}  // namespace coach
