#include "tools/report/incidents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coach {
namespace {

using testing::ElementsAre;

constexpr int64_t kSecond = 1'000'000;

std::vector<std::string> Told(const Session& session) {
  std::vector<std::string> out;
  for (const Incident& i : Incidents(session))
    out.push_back(std::to_string(i.utime / kSecond) + " " + std::to_string(static_cast<int>(i.seconds)) + " " + i.what);
  return out;
}

HealthSample Sign(int64_t second, int pid = 1) {
  HealthSample h;
  h.utime = second * kSecond;
  h.service = "detector";
  h.pid = pid;
  h.state = 1;
  return h;
}

TEST(Incidents, ServicesThatDieFallSilentOrComplain) {
  Session s;
  s.end = 20 * kSecond;
  s.health = {Sign(0), Sign(1), Sign(7), Sign(8, 2), Sign(9, 2), Sign(10, 2)};
  s.health[4].state = 2;
  s.health[4].message = "no camera";
  s.health[2].dropped = 4;
  s.health[3].dropped = 2;  // of the new process
  s.health[3].decode_errors = 1;
  EXPECT_THAT(Told(s),
              ElementsAre("1 6 detector gave no sign of life", "7 0 detector: 6 inputs superseded by newer ones",
                          "7 0 detector: 1 unreadable messages", "8 0 detector was started again",
                          "9 1 detector: no camera", "10 10 detector gave no sign of life until the end"));
}

TEST(Incidents, PartsThatAreLostAndPosesThatStop) {
  Session s;
  TaskNames names;
  names.parts = {"long_1", "short_1"};
  s.tasks = {names};
  for (int t = 0; t < 40; ++t) {
    if (t >= 30 && t < 34) continue;
    TrackedFrame f;
    f.utime = t * kSecond / 2;
    f.parts.assign(2, {PartStatus::kTracked, 1});
    if (t >= 10 && t < 20) f.parts[1].status = PartStatus::kLost;
    if (t == 25) f.parts[0].status = PartStatus::kLost;  // too short to tell
    f.table_found = t < 36;
    s.frames.push_back(f);
  }
  EXPECT_THAT(Told(s), ElementsAre("5 5 short_1 was lost", "14 2 no poses", "18 1 the table was not found"));
}

TEST(Incidents, RobotsThatGoAndActsThatFail) {
  Session s;
  s.end = 10 * kSecond;
  s.links = {{0, false, "nao"}, {kSecond / 2, true, "nao"}, {4 * kSecond, false, "nao"}};
  RobotAct act;
  act.sent = 3 * kSecond;
  act.command.text = "Hello";
  act.state = ActState::kExpired;
  s.acts = {act};
  EXPECT_THAT(Told(s), ElementsAre("3 0 came too late: Hello", "4 6 no connection to the robot (nao)"));
  s.links.clear();
  s.has_bus = true;
  EXPECT_THAT(Told(s), ElementsAre("3 0 came too late: Hello", "3 0 the robot never answered"));
}

TEST(Incidents, NothingIsNothing) { EXPECT_THAT(Told({}), ElementsAre()); }

}  // namespace
}  // namespace coach
