#include "tools/report/incidents.h"

#include <algorithm>
#include <map>

namespace coach {
namespace {

using Kind = Incident::Kind;

double Seconds(int64_t from, int64_t to) { return static_cast<double>(to - from) / 1e6; }

void OfService(const std::string& service, const std::vector<const HealthSample*>& samples, const Session& session,
               const IncidentOptions& options, std::vector<Incident>& out) {
  const HealthSample* trouble = nullptr;
  int64_t dropped = 0, socket = 0, errors = 0, first_drop = 0;
  const auto since = [](int64_t now, int64_t before) { return now >= before ? now - before : now; };
  for (size_t i = 0; i < samples.size(); ++i) {
    const HealthSample& h = *samples[i];
    if (i > 0) {
      const HealthSample& before = *samples[i - 1];
      if (h.pid != before.pid || h.host != before.host)
        out.push_back({Kind::kRestart, h.utime, 0, service + " was started again"});
      if (Seconds(before.utime, h.utime) > options.silence)
        out.push_back(
            {Kind::kSilence, before.utime, Seconds(before.utime, h.utime), service + " gave no sign of life"});
      const int64_t lost = since(h.dropped, before.dropped), at_socket = since(h.socket_drops, before.socket_drops),
                    bad = since(h.decode_errors, before.decode_errors);
      if (first_drop == 0 && lost + at_socket + bad > 0) first_drop = h.utime;
      dropped += lost;
      socket += at_socket;
      errors += bad;
    }
    const bool bad = h.state >= 2;
    if (trouble && (!bad || h.message != trouble->message)) {
      out.push_back(
          {Kind::kTrouble, trouble->utime, Seconds(trouble->utime, h.utime), service + ": " + trouble->message});
      trouble = nullptr;
    }
    if (bad && !trouble) trouble = &h;
  }
  if (trouble)
    out.push_back(
        {Kind::kTrouble, trouble->utime, Seconds(trouble->utime, session.end), service + ": " + trouble->message});
  if (!samples.empty() && Seconds(samples.back()->utime, session.end) > options.silence)
    out.push_back({Kind::kSilence, samples.back()->utime, Seconds(samples.back()->utime, session.end),
                   service + " gave no sign of life until the end"});
  if (dropped > 0)
    out.push_back(
        {Kind::kDrops, first_drop, 0, service + ": " + std::to_string(dropped) + " inputs superseded by newer ones"});
  if (socket > 0)
    out.push_back(
        {Kind::kDrops, first_drop, 0, service + ": " + std::to_string(socket) + " packets lost in the computer"});
  if (errors > 0)
    out.push_back({Kind::kDrops, first_drop, 0, service + ": " + std::to_string(errors) + " unreadable messages"});
}

/// Runs of frames for which `holds`, longer than `least` seconds.
template <class Holds>
void Runs(const Session& session, double least, Kind kind, const std::string& what, Holds holds,
          std::vector<Incident>& out) {
  const TrackedFrame* first = nullptr;
  const auto close = [&](int64_t until) {
    if (first && Seconds(first->utime, until) >= least)
      out.push_back({kind, first->utime, Seconds(first->utime, until), what});
    first = nullptr;
  };
  for (const TrackedFrame& f : session.frames) {
    if (!holds(f)) {
      close(f.utime);
    } else if (!first) {
      first = &f;
    }
  }
  if (!session.frames.empty()) close(session.frames.back().utime);
}

void OfTracking(const Session& session, const IncidentOptions& options, std::vector<Incident>& out) {
  size_t parts = 0;
  for (const TrackedFrame& f : session.frames) parts = std::max(parts, f.parts.size());
  for (size_t p = 0; p < parts; ++p) {
    std::string name = "part " + std::to_string(p + 1);
    for (const TaskNames& t : session.tasks) {
      if (p < t.parts.size()) name = t.parts[p];
    }
    Runs(
        session, options.lost, Kind::kTracking, name + " was lost",
        [&](const TrackedFrame& f) { return p < f.parts.size() && f.parts[p].status == PartStatus::kLost; }, out);
  }
  Runs(
      session, options.lost, Kind::kTracking, "the table was not found",
      [](const TrackedFrame& f) { return !f.table_found; }, out);
  for (size_t i = 1; i < session.frames.size(); ++i) {
    const double gap = Seconds(session.frames[i - 1].utime, session.frames[i].utime);
    if (gap > options.gap) out.push_back({Kind::kGap, session.frames[i - 1].utime, gap, "no poses"});
  }
}

void OfRobot(const Session& session, const IncidentOptions& options, std::vector<Incident>& out) {
  for (size_t i = 0; i < session.links.size(); ++i) {
    const RobotLink& link = session.links[i];
    const int64_t until = i + 1 < session.links.size() ? session.links[i + 1].utime : session.end;
    if (!link.connected && Seconds(link.utime, until) >= options.robot)
      out.push_back(
          {Kind::kRobot, link.utime, Seconds(link.utime, until), "no connection to the robot (" + link.back_end + ")"});
  }
  for (const RobotAct& act : session.acts) {
    if (act.state != ActState::kFailed && act.state != ActState::kExpired) continue;
    std::string what = act.state == ActState::kFailed ? "could not be done" : "came too late";
    if (!act.reason.empty()) what += " (" + act.reason + ")";
    out.push_back({Kind::kRobot, act.sent, 0,
                   what + ": " + (act.command.text.empty() ? act.command.phrase_key : act.command.text)});
  }
  const bool answers = !session.links.empty();
  if (!answers && session.has_bus && !session.acts.empty())
    out.push_back({Kind::kRobot, session.acts.front().sent, 0, "the robot never answered"});
}

}  // namespace

const char* ToString(Incident::Kind kind) {
  constexpr const char* kNames[] = {"restart", "silence", "trouble", "drops", "tracking", "robot", "gap"};
  return kNames[static_cast<int>(kind)];
}

std::vector<Incident> Incidents(const Session& session, const IncidentOptions& options) {
  std::vector<Incident> out;
  std::map<std::string, std::vector<const HealthSample*>> services;
  for (const HealthSample& h : session.health) services[h.service].push_back(&h);
  for (const auto& [service, samples] : services) OfService(service, samples, session, options, out);
  OfTracking(session, options, out);
  OfRobot(session, options, out);
  std::stable_sort(out.begin(), out.end(), [](const Incident& a, const Incident& b) { return a.utime < b.utime; });
  return out;
}

}  // namespace coach
