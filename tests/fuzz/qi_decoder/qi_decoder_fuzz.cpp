// Fuzzes what the qi client makes of bytes from the other side: the first byte chooses what they are taken for.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "services/robot_bridge/qi/codec.h"
#include "services/robot_bridge/qi/message.h"
#include "services/robot_bridge/qi/meta_object.h"

using namespace coach::qi;

namespace {

void Use(uint8_t choice, std::string_view bytes) {
  static const Signature kMetaObject = ParseSignature(kMetaObjectSignature);
  static const Signature kInfo =
      ParseSignature("(sIsI[s]ss)<ServiceInfo,name,serviceId,machineId,processId,endpoints,sessionId,objectUid>");
  switch (choice % 5) {
    case 0: {
      MessageReader reader(1 << 16);
      reader.Append(bytes.data(), bytes.size());
      while (reader.Next()) {
      }
      break;
    }
    case 1: {  // what has been read can be written, and means the same
      const Value value = Decode(ParseSignature("m"), bytes);
      const std::string again = Encode(ParseSignature(NaturalSignature(value)), value);
      Decode(ParseSignature(NaturalSignature(value)), again);
      break;
    }
    case 2:
      MetaObjectOf(Decode(kMetaObject, bytes)).Resolve("say", {"a"});
      break;
    case 3:
      ServiceInfoOf(kInfo, Decode(kInfo, bytes));
      break;
    default:
      ParseSignature(ParseSignature(bytes).Text());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  try {
    Use(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const FormatError&) {
    // the only answer to bytes that are wrong
  }
  return 0;
}
