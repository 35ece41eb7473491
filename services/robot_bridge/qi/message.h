// Messages: a header of 28 bytes and a payload.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace coach::qi {

enum class MessageType : uint8_t {
  kCall = 1,
  kReply = 2,
  kError = 3,
  kPost = 4,
  kEvent = 5,
  kCapability = 6,
  kCancel = 7,
  kCancelled = 8,
};

/// Flag of a payload that is a dynamic value instead of the declared type.
constexpr uint8_t kDynamicPayload = 1;

struct Message {
  uint32_t id = 0;
  MessageType type = MessageType::kCall;
  uint8_t flags = 0;
  uint32_t service = 0, object = 0, action = 0;
  std::string payload;
};

std::string EncodeMessage(const Message& message);

/// Cuts messages out of a stream of bytes.
class MessageReader {
 public:
  /// @param largest payload that is accepted, bytes
  explicit MessageReader(size_t largest) : largest_(largest) {}
  void Append(const char* bytes, size_t size) { buffer_.append(bytes, size); }
  /// The next complete message. @throws FormatError for a wrong magic, version or a payload that is too large: the
  /// stream can't be trusted any more.
  std::optional<Message> Next();

 private:
  size_t largest_;
  std::string buffer_;
};

}  // namespace coach::qi
