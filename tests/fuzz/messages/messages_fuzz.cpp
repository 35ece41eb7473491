// Fuzzes what comes from the bus, as common/bus/bus.h takes it: check, decode, convert to the domain. The first byte
// chooses the type and whether its fingerprint is put in front (or must be guessed). What was accepted must survive
// the way back to the bus.
#include <coach/robot_command_t.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <vector>

#include "common/bus/decode_message.h"
#include "common/bus/image_messages.h"
#include "common/bus/messages.h"

using namespace coach;

namespace {

template <class M>
void Use(std::span<const uint8_t> bytes) {
  const M message = DecodeMessage<M>(bytes);
  if (!CountsAgree(message)) std::abort();
  if constexpr (requires { FromMessage(message); }) {
    const auto domain = FromMessage(message);
    if constexpr (requires { ToMessage(domain); }) {
      const auto again = ToMessage(domain);
      if (!CountsAgree(again)) std::abort();
      std::vector<uint8_t> encoded(static_cast<size_t>(again.getEncodedSize()));
      if (again.encode(encoded.data(), 0, static_cast<int>(encoded.size())) < 0) std::abort();
      FromMessage(DecodeMessage<M>(encoded));  // throws only if what was accepted once is refused the second time
    }
  }
}

using Entry = void (*)(std::span<const uint8_t>);
struct Type {
  Entry use;
  int64_t (*hash)();
};
template <class... M>
std::vector<Type> TypesOf() {
  return {{Use<M>, M::getHash}...};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::vector<Type> types =
      TypesOf<color_image_t, depth_image_t, detections_t, part_poses_t, connection_belief_t, assembly_state_t,
              guidance_event_t, task_t, table_scene_t, robot_command_t, robot_status_t, operator_command_t,
              annotation_t, service_health_t, config_t>();
  if (size == 0) return 0;
  const Type& type = types[(data[0] & 127) % types.size()];
  std::vector<uint8_t> bytes;
  if (data[0] < 128) {
    const auto hash = static_cast<uint64_t>(type.hash());
    for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<uint8_t>(hash >> shift));
  }
  bytes.insert(bytes.end(), data + 1, data + size);
  try {
    type.use(bytes);
  } catch (const std::invalid_argument&) {
    // the answer to a message that is wrong
  } catch (const std::length_error&) {
    // what the generated decoders throw for a negative count; the bus counts it like the others
  }
  return 0;
}
