#include "common/bus/command_signature.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "common/bus/decode_message.h"

namespace coach {
namespace {

const std::string kKey = "sixteen bytes or more";

robot_command_t Signed() {
  robot_command_t command{};
  command.id = 17;
  command.station = "TABLE1";
  command.session = 3;
  command.text = "Hello";
  command.phrase_key = "introduction";
  command.language = "en";
  command.point = 1;
  command.point_target[0] = 0.25F;
  command.sent_utime = 1'700'000'000'000'000;
  command.valid_for_us = 4'000'000;
  Sign(command, kKey);
  return command;
}

TEST(CommandSignature, FitsWhatWasSignedByTheSameKeyOnly) {
  const robot_command_t command = Signed();
  EXPECT_TRUE(SignatureFits(command, kKey));
  EXPECT_FALSE(SignatureFits(command, kKey + "!"));
  EXPECT_FALSE(SignatureFits(robot_command_t{}, kKey)) << "unsigned";
}

TEST(CommandSignature, AForgeryOfAnyByteIsNoticed) {
  const robot_command_t command = Signed();
  std::vector<uint8_t> bytes(static_cast<size_t>(command.getEncodedSize()));
  command.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  int forged = 0;
  for (size_t i = 8; i < bytes.size(); ++i) {  // after the type's fingerprint
    std::vector<uint8_t> changed = bytes;
    changed[i] ^= 1;
    robot_command_t other{};
    try {
      other = DecodeMessage<robot_command_t>(changed);
    } catch (const std::invalid_argument&) {
      continue;  // a length that no longer fits is no command at all
    }
    std::vector<uint8_t> again(static_cast<size_t>(other.getEncodedSize()));
    other.encode(again.data(), 0, static_cast<int>(again.size()));
    if (again == bytes) continue;  // the end of a text, which is not read
    EXPECT_FALSE(SignatureFits(other, kKey)) << "byte " << i;
    ++forged;
  }
  EXPECT_GT(forged, 100);
}

}  // namespace
}  // namespace coach
