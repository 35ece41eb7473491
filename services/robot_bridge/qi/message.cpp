#include "services/robot_bridge/qi/message.h"

#include <cstring>

#include "services/robot_bridge/qi/signature.h"

namespace coach::qi {
namespace {

constexpr size_t kHeader = 28;
constexpr char kMagic[] = "\x42\xde\xad\x42";

template <class T>
void Put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T>
T Get(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

}  // namespace

std::string EncodeMessage(const Message& message) {
  std::string out(kMagic, 4);
  Put(out, message.id);
  Put(out, static_cast<uint32_t>(message.payload.size()));
  Put<uint16_t>(out, 0);
  Put(out, static_cast<uint8_t>(message.type));
  Put(out, message.flags);
  Put(out, message.service);
  Put(out, message.object);
  Put(out, message.action);
  return out + message.payload;
}

std::optional<Message> MessageReader::Next() {
  if (buffer_.size() < kHeader) return std::nullopt;
  const char* header = buffer_.data();
  if (std::memcmp(header, kMagic, 4) != 0) throw FormatError("not a qi message");
  const auto size = Get<uint32_t>(header + 8);
  if (Get<uint16_t>(header + 12) != 0) throw FormatError("a qi message of an unknown version");
  if (size > largest_) throw FormatError("a qi message of " + std::to_string(size) + " bytes");
  if (buffer_.size() < kHeader + size) return std::nullopt;
  Message message;
  message.id = Get<uint32_t>(header + 4);
  message.type = static_cast<MessageType>(header[14]);
  message.flags = static_cast<uint8_t>(header[15]);
  message.service = Get<uint32_t>(header + 16);
  message.object = Get<uint32_t>(header + 20);
  message.action = Get<uint32_t>(header + 24);
  message.payload = buffer_.substr(kHeader, size);
  buffer_.erase(0, kHeader + size);
  return message;
}

}  // namespace coach::qi
