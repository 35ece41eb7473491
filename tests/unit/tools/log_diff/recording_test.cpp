#include "tools/log_diff/recording.h"

#include <gmock/gmock.h>
#include <lcm/lcm.h>

namespace coach {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Payloads = std::vector<std::vector<uint8_t>>;

TEST(Differences, IdenticalRecordingsHaveNone) {
  const Recording a{{"S/PART_POSES", Payloads{{1, 2}, {3}}}};
  EXPECT_THAT(Differences(a, a), IsEmpty());
  EXPECT_THAT(Differences({}, {}), IsEmpty());
}

TEST(Differences, HealthOfAnyStationDoesNotCount) {
  const Recording a{{"A/SERVICE_HEALTH", Payloads{{1}}}, {"S/TASK", Payloads{{7}}}};
  const Recording b{{"B/SERVICE_HEALTH", Payloads{{2}, {3}}}, {"S/TASK", Payloads{{7}}}};
  EXPECT_THAT(Differences(a, b), IsEmpty());
}

TEST(Differences, NameChannelMessageAndByte) {
  const Recording a{{"S/A", Payloads{{1}, {2, 3, 4}}}, {"S/B", Payloads{{1}, {2}}}, {"S/C", Payloads{{1}}}};
  const Recording b{{"S/A", Payloads{{1}, {2, 9, 4}}}, {"S/B", Payloads{{1}}}};
  EXPECT_THAT(Differences(a, b),
              ElementsAre(HasSubstr("S/A: message 1 differs from byte 1"), HasSubstr("S/B: message 1 is missing"),
                          HasSubstr("S/C: message 0 is missing")));
}

TEST(ReadRecording, KeepsTheOrderOfEachChannel) {
  const std::string file = testing::TempDir() + "/coach_recording_test.lcm";
  lcm_t* log = lcm_create(("file://" + file + "?mode=w").c_str());
  ASSERT_NE(log, nullptr);
  for (uint8_t i = 0; i < 5; ++i) lcm_publish(log, i % 2 ? "ODD" : "EVEN", &i, 1);
  lcm_destroy(log);
  EXPECT_EQ(ReadRecording(file), (Recording{{"EVEN", {{0}, {2}, {4}}}, {"ODD", {{1}, {3}}}}));
  EXPECT_THROW(ReadRecording("/nowhere.lcm"), std::runtime_error);
}

}  // namespace
}  // namespace coach
