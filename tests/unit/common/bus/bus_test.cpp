#include "common/bus/bus.h"

#include <gmock/gmock.h>
#include <lcm/lcm.h>

#include <filesystem>
#include <random>

#include "common/bus/messages.h"

namespace coach {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class M>
std::vector<uint8_t> Encode(const M& message) {
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

connection_belief_t Belief(int64_t utime) {
  connection_belief_t m;
  m.utime = utime;
  m.num_connections = 1;
  m.connections.resize(1);
  m.connections[0] = {};
  return m;
}

part_poses_t Poses(int64_t utime) {
  PartPoses poses;
  poses.utime = utime;
  return ToMessage(poses);
}

TEST(Bus, DeliversInOrder) {
  Bus bus("memq://", "S");
  std::vector<int64_t> seen;
  bus.Subscribe<connection_belief_t>([&](const connection_belief_t& m) { seen.push_back(m.utime); });
  for (int i = 1; i <= 200; ++i) EXPECT_TRUE(bus.Publish(Belief(i)));
  EXPECT_EQ(bus.Handle(0), 200);
  ASSERT_EQ(seen.size(), 200U);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(seen[static_cast<size_t>(i)], i + 1);
}

TEST(Bus, NewestOnlyDeliversTheNewestAndCountsTheOthers) {
  Bus bus("memq://", "S");
  std::vector<int64_t> seen;
  bus.SubscribeNewest<part_poses_t>([&](const part_poses_t& m) { seen.push_back(m.utime); });
  for (int i = 1; i <= 5; ++i) bus.Publish(Poses(i));
  bus.Handle(0);
  bus.Publish(Poses(6));
  bus.Handle(0);
  EXPECT_THAT(seen, ElementsAre(5, 6));
  EXPECT_EQ(bus.received(), 6);
  EXPECT_EQ(bus.skipped(), 4);
}

TEST(Bus, OtherStationsAreNotHeardEvenIfTheirNamesLookAlike) {
  const std::string file = testing::TempDir() + "/coach_stations_test.lcm";
  std::filesystem::remove(file);
  lcm_t* log = lcm_create(("file://" + file + "?mode=w").c_str());
  ASSERT_NE(log, nullptr);
  const std::vector<uint8_t> bytes = Encode(Belief(1));
  for (const char* channel :
       {"TABLE.1/CONNECTION_BELIEF", "TABLE_1/CONNECTION_BELIEF", "TABLE.10/CONNECTION_BELIEF", "CONNECTION_BELIEF"})
    lcm_publish(log, channel, bytes.data(), static_cast<unsigned>(bytes.size()));
  lcm_destroy(log);
  Bus bus("file://" + file + "?speed=0", "TABLE.1");
  int calls = 0;
  bus.Subscribe<connection_belief_t>([&](const connection_belief_t&) { ++calls; });
  while (bus.Handle(100) >= 0) {
  }
  EXPECT_EQ(calls, 1);
}

TEST(Bus, SurvivesMalformedMessagesAndThrowingHandlers) {
  Bus bus("memq://", "S");
  int calls = 0;
  bus.Subscribe<connection_belief_t>([&](const connection_belief_t& m) {
    ++calls;
    if (m.utime == 7) throw std::runtime_error("handler");
    if (m.utime == 8) throw 8;
  });
  const auto with_count = [](int16_t count) {
    std::vector<uint8_t> bytes = Encode(Belief(1));
    bytes[16] = static_cast<uint8_t>(count >> 8);
    bytes[17] = static_cast<uint8_t>(count);
    return bytes;
  };
  for (const int16_t count : {int16_t{-1}, int16_t{0}, int16_t{2}, int16_t{0x7fff}})
    bus.PublishBytes("CONNECTION_BELIEF", with_count(count));
  std::vector<uint8_t> bytes = Encode(Belief(1));
  bytes.push_back(0);
  bus.PublishBytes("CONNECTION_BELIEF", bytes);  // too long
  for (size_t size : {size_t{1}, size_t{8}, size_t{12}, bytes.size() - 2})
    bus.PublishBytes("CONNECTION_BELIEF", std::span(bytes).first(size));
  bus.PublishBytes("CONNECTION_BELIEF", Encode(Poses(1)));
  bus.Publish(Belief(7));
  bus.Publish(Belief(8));
  bus.Publish(Belief(1));
  EXPECT_EQ(bus.Handle(0), 13);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(bus.errors(), 12);
}

template <class M>
void ExpectHostileByteCountsAreRefused(const M& message, size_t count_offset) {
  Bus bus("memq://", "S");
  bus.SubscribeNewest<M>([](const M&) { FAIL() << "decoded"; });
  int64_t sent = 0;
  for (const uint32_t count : {0x7fffffffU, 0x10000000U, 0xffffffffU, 0x80000000U, 1U}) {
    std::vector<uint8_t> bytes = Encode(message);
    for (size_t i = 0; i < 4; ++i) bytes[count_offset + i] = static_cast<uint8_t>(count >> (24 - 8 * i));
    bus.PublishBytes(kChannel<M>, bytes);
    bus.Handle(0);
    EXPECT_EQ(bus.errors(), ++sent);
  }
}

TEST(Bus, HostileByteCountsAllocateNothing) {
  const color_image_t colour{};
  ExpectHostileByteCountsAreRefused(colour, static_cast<size_t>(colour.getEncodedSize()) - 4);
  const depth_image_t depth{};
  ExpectHostileByteCountsAreRefused(depth, static_cast<size_t>(depth.getEncodedSize()) - 4);
  detections_t detections{};
  detections.num_regions = 2;
  detections.regions.resize(2);
  ExpectHostileByteCountsAreRefused(detections, static_cast<size_t>(detections.getEncodedSize()) - 4);
}

TEST(Bus, RandomBytesOnEveryChannelAreCountedDrops) {
  Bus bus("memq://", "S");
  bus.Subscribe<assembly_state_t>([](const assembly_state_t&) { FAIL(); });
  bus.Subscribe<task_t>([](const task_t&) { FAIL(); });
  bus.Subscribe<robot_command_t>([](const robot_command_t&) { FAIL(); });
  bus.SubscribeNewest<detections_t>([](const detections_t&) { FAIL(); });
  std::mt19937 random(1);
  const auto put = [&]<class M>(M, int trials) {
    const std::vector<uint8_t> head = Encode(M{});
    for (int i = 0; i < trials; ++i) {
      std::vector<uint8_t> bytes(head.begin(), head.begin() + 8);  // the right fingerprint
      bytes.resize(8 + random() % 400);
      for (size_t k = 8; k < bytes.size(); ++k) bytes[k] = static_cast<uint8_t>(random());
      bus.PublishBytes(kChannel<M>, bytes);
      bus.Handle(0);
    }
  };
  put(assembly_state_t{}, 200);
  put(task_t{}, 200);
  put(robot_command_t{}, 200);
  put(detections_t{}, 200);
  EXPECT_EQ(bus.errors(), 800);
}

TEST(Bus, RefusesToSendWhatItsCountsDoNotAgreeWith) {
  Bus bus("memq://", "S");
  connection_belief_t message = Belief(1);
  message.num_connections = 5;
  EXPECT_FALSE(bus.Publish(message));
  EXPECT_EQ(bus.publish_errors(), 1);
}

TEST(Bus, ARecordingIsReadInLockstepToItsEnd) {
  const std::string file = testing::TempDir() + "/coach_bus_test.lcm";
  std::filesystem::remove(file);
  {
    Bus writer("file://" + file + "?mode=w", "S");
    for (int i = 1; i <= 50; ++i) writer.Publish(Poses(i));
  }
  Bus bus("file://" + file + "?speed=0", "S");
  EXPECT_TRUE(bus.lockstep());
  std::vector<int64_t> seen;
  bus.SubscribeNewest<part_poses_t>([&](const part_poses_t& m) { seen.push_back(m.utime); });
  size_t handled = 0;
  while (bus.Handle(100) >= 0) EXPECT_EQ(seen.size(), ++handled);
  EXPECT_EQ(seen.size(), 50U);
  EXPECT_EQ(bus.skipped(), 0);
  EXPECT_EQ(bus.Handle(100), -1);
}

std::string ErrorOf(const std::string& url, const std::string& station) {
  try {
    Bus bus(url, station);
  } catch (const BusError& e) {
    return e.what();
  }
  return "";
}

TEST(Bus, SaysWhatIsWrongWithAnAddress) {
  EXPECT_THAT(ErrorOf("memq://", ""), HasSubstr("station"));
  EXPECT_THAT(ErrorOf("memq://", "a/b"), HasSubstr("station 'a/b'"));
  EXPECT_THAT(ErrorOf("udpm://10.0.0.1:7667", "S"), HasSubstr("multicast group"));
  EXPECT_THAT(ErrorOf("udpm://239.255.76.67:99999", "S"), HasSubstr("multicast group"));
  EXPECT_THAT(ErrorOf("nonsense://", "S"), HasSubstr("nonsense://"));
  EXPECT_THAT(ErrorOf("file:///nowhere/x.lcm", "S"), HasSubstr("recording"));
}

}  // namespace
}  // namespace coach
