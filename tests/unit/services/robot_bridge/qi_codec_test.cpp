#include <gtest/gtest.h>

#include <random>

#include "services/robot_bridge/qi/codec.h"
#include "services/robot_bridge/qi/message.h"
#include "services/robot_bridge/qi/meta_object.h"
#include "services/robot_bridge/qi/transport.h"

namespace coach::qi {
namespace {

std::string Bytes(const std::string& hex) {
  std::string out;
  std::string digits;
  for (const char c : hex) {
    if (c != ' ') digits += c;
  }
  for (size_t i = 0; i + 1 < digits.size(); i += 2)
    out += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return out;
}

// Bytes written out by hand from the protocol's description.
TEST(QiCodecTest, GoldenBytesOfEveryType) {
  const struct {
    const char* signature;
    Value value;
    const char* hex;
  } kCases[] = {
      {"b", true, "01"},
      {"c", -2, "fe"},
      {"C", 254, "fe"},
      {"w", -2, "feff"},
      {"W", 513, "0102"},
      {"i", -2, "feffffff"},
      {"I", int64_t{4294967294}, "feffffff"},
      {"l", -2, "feffffffffffffff"},
      {"f", 0.5, "0000003f"},
      {"d", 0.5, "000000000000e03f"},
      {"s", "hi", "02000000 6869"},
      {"r", Raw{"hi"}, "02000000 6869"},
      {"v", Value(), ""},
      {"[s]", List{"a", "b"}, "02000000 01000000 61 01000000 62"},
      {"{sI}", Map{{{"a", 7}}}, "01000000 01000000 61 07000000"},
      {"(sf)", Tuple{{"a", 0.5}}, "01000000 61 0000003f"},
      {"m", "hi", "01000000 73 02000000 6869"},
      {"m", 0.5, "01000000 66 0000003f"},
      {"m", List{0.5, 0.5}, "03000000 5b665d 02000000 0000003f 0000003f"},
      {"m", List{List{0.5}}, "05000000 5b5b665d5d 01000000 01000000 0000003f"},
      {"m", List{1, "a"}, "03000000 5b6d5d 02000000 01000000 69 01000000 01000000 73 01000000 61"},
      {"+i", 7, "01 07000000"},
      {"+i", Value(), "00"},
      {"(ss)<Two,first,second>", Tuple{{"", ""}}, "00000000 00000000"},
  };
  for (const auto& c : kCases) {
    const Signature signature = ParseSignature(c.signature);
    EXPECT_EQ(Encode(signature, c.value), Bytes(c.hex)) << c.signature;
    EXPECT_EQ(Encode(signature, Decode(signature, Bytes(c.hex))), Bytes(c.hex)) << c.signature;
  }
}

TEST(QiCodecTest, ValuesThatDoNotFitAreRefused) {
  EXPECT_THROW(Encode(ParseSignature("C"), 256), FormatError);
  EXPECT_THROW(Encode(ParseSignature("I"), -1), FormatError);
  EXPECT_THROW(Encode(ParseSignature("i"), 0.5), FormatError);
  EXPECT_THROW(Encode(ParseSignature("s"), 1), FormatError);
  EXPECT_THROW(Encode(ParseSignature("(ss)"), Tuple{{"one"}}), FormatError);
}

TEST(QiCodecTest, HostilePayloadsAreRefused) {
  EXPECT_THROW(Decode(ParseSignature("[v]"), Bytes("ffffffff")), FormatError);
  EXPECT_THROW(Decode(ParseSignature("[i]"), Bytes("ffffff7f 00000000")), FormatError);
  EXPECT_THROW(Decode(ParseSignature("s"), Bytes("ffffffff 61")), FormatError);
  EXPECT_THROW(Decode(ParseSignature("i"), Bytes("0000000000")), FormatError);
  EXPECT_THROW(Decode(ParseSignature("X"), ""), FormatError);
  std::string nested;
  for (int i = 0; i < 100; ++i) nested += Bytes("01000000 6d");
  EXPECT_THROW(Decode(ParseSignature("m"), nested), FormatError);
  EXPECT_THROW(ParseSignature(std::string(100, '[') + "i" + std::string(100, ']')), FormatError);
  for (const char* bad : {"", "[", "[i", "{s}", "(i", "q", "ii", "(ss)<a", "[i)"})
    EXPECT_THROW(ParseSignature(bad), FormatError) << bad;
}

TEST(QiCodecTest, RandomBytesNeverDoMoreThanThrow) {
  std::mt19937 random(4);
  const char* signatures[] = {"m", "(sIsI[s]s)", "[m]", "{sm}", kMetaObjectSignature, "o"};
  int decoded = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string bytes(random() % 30, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random() % 8 == 0 ? random() % 256 : random() % 4 == 0 ? 1 : 0);
    try {
      Decode(ParseSignature(signatures[i % 6]), bytes);
      ++decoded;
    } catch (const FormatError&) {
    }
  }
  EXPECT_GT(decoded, 0);
}

TEST(QiMessageTest, HeaderByteByByte) {
  Message message;
  message.id = 0x01020304;
  message.type = MessageType::kCall;
  message.service = 1;
  message.object = 1;
  message.action = 100;
  message.payload = "ab";
  const std::string bytes = Bytes("42dead42 04030201 02000000 0000 01 00 01000000 01000000 64000000 6162");
  EXPECT_EQ(EncodeMessage(message), bytes);
  MessageReader reader(1000);
  for (const char byte : bytes + bytes) reader.Append(&byte, 1);
  for (int i = 0; i < 2; ++i) {
    const auto read = reader.Next();
    ASSERT_TRUE(read);
    EXPECT_EQ(read->id, message.id);
    EXPECT_EQ(read->payload, "ab");
  }
  EXPECT_FALSE(reader.Next());
}

TEST(QiMessageTest, StreamsThatCantBeTrusted) {
  MessageReader wrong(1000);
  wrong.Append("HTTP/1.1 400 Bad Request\r\n\r\n", 28);
  EXPECT_THROW(wrong.Next(), FormatError);
  MessageReader large(1000);
  const std::string header = Bytes("42dead42 00000000 e9030000 0000 02 00 00000000 00000000 00000000");
  large.Append(header.data(), header.size());
  EXPECT_THROW(large.Next(), FormatError);
}

TEST(QiMetaObjectTest, OverloadsByNumberAndTypes) {
  MetaObject meta;
  const auto add = [&](uint32_t id, const char* name, const char* parameters) {
    meta.methods.push_back({id, name, ParseSignature(parameters), ParseSignature("v")});
  };
  add(107, "say", "(ss)");
  add(103, "say", "(s)");
  add(110, "fadeRGB", "(sffff)");
  add(111, "fadeRGB", "(ssf)");
  add(112, "fadeRGB", "(sif)");
  add(120, "setAngles", "(mmf)");
  EXPECT_EQ(meta.Resolve("say", {"a"})->id, 103u);
  EXPECT_EQ(meta.Resolve("say", {"a", "b"})->id, 107u);
  EXPECT_EQ(meta.Resolve("fadeRGB", {"FaceLeds", 255, 0.3})->id, 112u);
  EXPECT_EQ(meta.Resolve("fadeRGB", {"FaceLeds", "red", 0.3})->id, 111u);
  EXPECT_EQ(meta.Resolve("fadeRGB", {"FaceLeds", 0.1, 0.2, 0.3, 1.0})->id, 110u);
  EXPECT_EQ(meta.Resolve("setAngles", {List{"HeadYaw"}, 0.5, 0.1})->id, 120u);
  EXPECT_EQ(meta.Resolve("say", {1}), nullptr);
  EXPECT_EQ(meta.Resolve("sing", {"a"}), nullptr);
}

TEST(QiMetaObjectTest, ServiceInfoOfBothGenerations) {
  const Value six = Tuple{{"ALMotion", 42, "machine", 7, List{"tcp://a:9559"}, "session"}};
  EXPECT_EQ(ServiceInfoOf(
                ParseSignature("(sIsI[s]s)<ServiceInfo,name,serviceId,machineId,processId,endpoints,sessionId>"), six)
                .id,
            42u);
  EXPECT_EQ(ServiceInfoOf(ParseSignature("(sIsI[s]s)"), six).endpoints, std::vector<std::string>{"tcp://a:9559"});
  // Members in another order are found by their names.
  const Value turned = Tuple{{42, "ALMotion", List{"tcp://a:9559"}}};
  const ServiceInfo info = ServiceInfoOf(ParseSignature("(Is[s])<ServiceInfo,serviceId,name,endpoints>"), turned);
  EXPECT_EQ(info.id, 42u);
  EXPECT_EQ(info.endpoints.size(), 1u);
  EXPECT_THROW(ServiceInfoOf(ParseSignature("(s)"), Tuple{{"x"}}), FormatError);
}

TEST(QiEndpointTest, Urls) {
  EXPECT_EQ(ParseEndpoint("tcp://nao.local")->port, 9559);
  EXPECT_EQ(ParseEndpoint("tcps://10.0.0.2")->port, 9503);
  EXPECT_EQ(ParseEndpoint("tcp://[::1]:77")->host, "::1");
  EXPECT_EQ(ToString(*ParseEndpoint("tcp://[::1]:77")), "tcp://[::1]:77");
  for (const char* bad : {"nao.local:9559", "http://a:1", "tcp://", "tcp://a:0", "tcp://a:70000", "tcp://a:x"}) {
    EXPECT_FALSE(ParseEndpoint(bad)) << bad;
  }
}

}  // namespace
}  // namespace coach::qi
