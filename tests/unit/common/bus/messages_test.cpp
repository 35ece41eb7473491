#include "common/bus/messages.h"

#include <gmock/gmock.h>

#include "common/bus/message_check.h"
#include "random_domain.h"

namespace coach {
namespace {

using namespace random_domain;
using testing::HasSubstr;

template <class M>
std::vector<uint8_t> Encode(const M& message) {
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

/// struct -> message -> bytes -> message -> struct -> message -> bytes gives the same bytes, for random content.
template <class Make>
void ExpectRoundTrip(const Make& make) {
  Random random(17);
  for (int trial = 0; trial < 200; ++trial) {
    const auto original = make(random);
    const auto message = ToMessage(original);
    EXPECT_TRUE(CountsAgree(message));
    const std::vector<uint8_t> bytes = Encode(message);
    auto decoded = message;
    decoded = {};
    ASSERT_EQ(decoded.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
    const auto back = FromMessage(decoded);
    EXPECT_EQ(back.utime, original.utime);
    EXPECT_EQ(Encode(ToMessage(back)), bytes);
  }
}

TEST(Messages, EveryTypeComesBackAsItWas) {
  ExpectRoundTrip(RandomDetections);
  ExpectRoundTrip(RandomBelief);
  ExpectRoundTrip(RandomEvent);
  ExpectRoundTrip(RandomAssemblyState);
  ExpectRoundTrip(RandomRobotStatus);
  ExpectRoundTrip(RandomOperatorCommand);
}

TEST(Messages, RobotCommandsComeBackAsTheyWere) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const robot_command_t message = ToMessage(RandomRobotCommand(random));
    EXPECT_EQ(Encode(ToMessage(FromMessage(message))), Encode(message));
  }
}

TEST(Messages, PosesComeBackAsTheyWere) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const PartPoses a = RandomPartPoses(random), b = FromMessage(ToMessage(a));
    ASSERT_EQ(a.parts.size(), b.parts.size());
    ASSERT_EQ(a.pairs.size(), b.pairs.size());
    ASSERT_EQ(a.foreign.size(), b.foreign.size());
    EXPECT_TRUE(a.X_TC.isApprox(b.X_TC, 1e-12));
    EXPECT_EQ(a.X_TC_covariance, b.X_TC_covariance);
    EXPECT_EQ(a.table_found, b.table_found);
    EXPECT_EQ(a.table_residual, b.table_residual);
    EXPECT_EQ(a.sequence, b.sequence);
    for (size_t i = 0; i < a.parts.size(); ++i) {
      EXPECT_TRUE(a.parts[i].X_TP.isApprox(b.parts[i].X_TP, 1e-12));
      EXPECT_EQ(a.parts[i].velocity, b.parts[i].velocity);
      EXPECT_EQ(a.parts[i].covariance, b.parts[i].covariance);
      EXPECT_EQ(a.parts[i].visible_fraction, b.parts[i].visible_fraction);
      EXPECT_EQ(a.parts[i].status, b.parts[i].status);
      EXPECT_EQ(a.parts[i].confidence, b.parts[i].confidence);
      EXPECT_EQ(a.parts[i].ambiguous_with, b.parts[i].ambiguous_with);
      EXPECT_EQ(a.parts[i].ambiguous_probability, b.parts[i].ambiguous_probability);
      EXPECT_EQ(a.parts[i].identity_exchange, b.parts[i].identity_exchange);
    }
    for (size_t i = 0; i < a.pairs.size(); ++i) {
      EXPECT_EQ(a.pairs[i].part_a, b.pairs[i].part_a);
      EXPECT_EQ(a.pairs[i].part_b, b.pairs[i].part_b);
      EXPECT_TRUE(a.pairs[i].X_AB.isApprox(b.pairs[i].X_AB, 1e-12));
      EXPECT_EQ(a.pairs[i].covariance, b.pairs[i].covariance);
      EXPECT_EQ(a.pairs[i].candidate_kind, b.pairs[i].candidate_kind);
      EXPECT_EQ(a.pairs[i].candidate, b.pairs[i].candidate);
      EXPECT_EQ(a.pairs[i].log_evidence, b.pairs[i].log_evidence);
      EXPECT_EQ(a.pairs[i].pixels, b.pairs[i].pixels);
      EXPECT_EQ(a.pairs[i].surface_distance, b.pairs[i].surface_distance);
      EXPECT_EQ(a.pairs[i].motion, b.pairs[i].motion);
      EXPECT_EQ(a.pairs[i].relative_motion, b.pairs[i].relative_motion);
      EXPECT_EQ(a.pairs[i].visible_fraction, b.pairs[i].visible_fraction);
      EXPECT_EQ(a.pairs[i].constrained, b.pairs[i].constrained);
    }
    for (size_t i = 0; i < a.foreign.size(); ++i) {
      EXPECT_EQ(a.foreign[i].centre, b.foreign[i].centre);
      EXPECT_EQ(a.foreign[i].radius, b.foreign[i].radius);
      EXPECT_EQ(a.foreign[i].velocity, b.foreign[i].velocity);
    }
  }
}

TEST(Messages, TableScenesComeBackToFloatPrecisionAndFitOnePacket) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const TableScene a = RandomTableScene(random), b = FromMessage(ToMessage(a));
    ASSERT_EQ(a.parts.size(), b.parts.size());
    for (size_t i = 0; i < a.parts.size(); ++i) {
      EXPECT_TRUE(a.parts[i].X_TP.isApprox(b.parts[i].X_TP, 1e-6));
      EXPECT_EQ(a.parts[i].status, b.parts[i].status);
    }
    EXPECT_LT(ToMessage(a).getEncodedSize(), 1400);
  }
}

template <class M>
std::string Refusal(const M& message) {
  try {
    FromMessage(message);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Messages, NumbersThatAreNoneAreRefusedByName) {
  Random random(6);
  const double nan = std::nan("");
  PartPoses good = RandomPartPoses(random);
  const part_poses_t message = ToMessage(good);
  ASSERT_EQ(Refusal(message), "");
  const auto spoil = [&](auto change) {
    part_poses_t bad = message;
    change(bad);
    return Refusal(bad);
  };
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.parts[0].X_TP.position[1] = nan; }), HasSubstr("pose.position is nan"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.parts[1].X_TP.orientation[0] = nan; }), HasSubstr("pose.orientation"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.X_TC.orientation[0] += 0.5; }), HasSubstr("no unit quaternion"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.parts[0].covariance[3] = INFINITY; }), HasSubstr("part.covariance"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.parts[0].covariance[0] = -1; }), HasSubstr("negative"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.parts[0].status = 9; }), HasSubstr("part.status is 9"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.parts[0].confidence = 1.5; }), HasSubstr("part.confidence"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.parts[0].ambiguous_with = m.num_parts; }),
              HasSubstr("part.ambiguous_with"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.num_parts = -1; }), HasSubstr("num_parts"));
  EXPECT_THAT(spoil([&](part_poses_t& m) { m.num_parts += 1; }), HasSubstr("num_parts"));
  EXPECT_THAT(spoil([&](part_poses_t& m) {
                m.num_foreign = 1000;
                m.foreign.resize(1000);
              }),
              HasSubstr("num_foreign is 1000"));
}

TEST(Messages, RegionsOutsideTheImageAreRefused) {
  Detections detections;
  detections.width = 64;
  detections.height = 48;
  detections.num_classes = 1;
  detections.regions.resize(1);
  const detections_t good = ToMessage(detections);
  EXPECT_EQ(Refusal(good), "");
  detections_t bad = good;
  bad.regions[0].box[0] = 60;
  bad.regions[0].box[2] = 5;
  EXPECT_THAT(Refusal(bad), HasSubstr("region.box"));
  bad = good;
  bad.regions[0].colour_class = 1;
  EXPECT_THAT(Refusal(bad), HasSubstr("region.colour_class"));
  bad = good;
  bad.width = -5;
  EXPECT_THAT(Refusal(bad), HasSubstr("width is -5"));
}

TEST(Messages, SpeechIsBoundedBothWays) {
  RobotCommand command;
  command.text = std::string(400, 'x');
  robot_command_t message = ToMessage(command);
  message.text += 'x';
  EXPECT_THAT(Refusal(message), HasSubstr("401 bytes"));
  command.text += 'x';
  EXPECT_THROW(ToMessage(command), std::invalid_argument);
}

TEST(Messages, TaskNamesAreInTheOrderOfTheirIndices) {
  Task task;
  task.name = "t";
  task.types.resize(2);
  task.types[0].name = "long";
  task.types[1].name = "short";
  task.types[1].colour = "red";
  task.parts = {{"long_1", 0}, {"short_1", 1}, {"short_2", 1}};
  task.mistakes.resize(1);
  task.mistakes[0].name = "crossed";
  const task_t m = ToMessage(task);
  EXPECT_TRUE(CountsAgree(m));
  EXPECT_EQ(m.types[1], "short");
  EXPECT_EQ(m.colours[1], "red");
  EXPECT_EQ(m.parts[2], "short_2");
  EXPECT_EQ(m.part_types[2], 1);
  EXPECT_EQ(m.mistakes[0], "crossed");
}

}  // namespace
}  // namespace coach
