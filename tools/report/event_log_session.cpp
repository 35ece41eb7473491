#include "tools/report/event_log_session.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace coach {
namespace {

using Json = nlohmann::json;

GuidanceEvent EventFrom(const Json& json) {
  GuidanceEvent e;
  e.id = json.at("id");
  e.utime = json.at("utime");
  e.since = json.at("since");
  e.kind = json.at("kind");
  e.subject = json.at("subject");
  e.part_a = json.at("part_a");
  e.part_b = json.at("part_b");
  e.probability = json.at("probability");
  e.reason = json.at("reason");
  return e;
}

}  // namespace

Session ParseEventLog(std::string_view text) {
  Session session;
  int64_t line = 0, unreadable = 0, first_unreadable = 0;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    const std::string_view content = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++line;
    if (content.find_first_not_of(" \r\t") == std::string_view::npos) continue;
    try {
      session.events.push_back(EventFrom(Json::parse(content)));
    } catch (const Json::exception&) {
      if (++unreadable == 1) first_unreadable = line;
    }
  }
  if (unreadable > 0)
    session.problems.push_back(std::to_string(unreadable) + " lines can't be read, the first is line " +
                               std::to_string(first_unreadable));
  if (session.events.empty()) {
    session.problems.push_back("the event log is empty");
    return session;
  }
  int64_t next = 0;  // decisions before the first frame carry no time
  for (auto e = session.events.rbegin(); e != session.events.rend(); ++e) {
    if (e->utime == 0) e->utime = e->since = next;
    next = e->utime;
  }
  const auto [first, last] = std::minmax_element(session.events.begin(), session.events.end(),
                                                 [](const auto& a, const auto& b) { return a.utime < b.utime; });
  session.begin = first->utime;
  session.end = last->utime;
  return session;
}

}  // namespace coach
