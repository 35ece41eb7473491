// The bytes of a message as LCM hands it over.
#pragma once

#include <lcm/lcm.h>

#include <cstdint>
#include <span>
#include <stdexcept>

namespace coach {

constexpr uint32_t kMaxMessageBytes = 1U << 28;  ///< LCM's own limit

/// @throws std::invalid_argument for a size that no message can have: of a packet that ends within the channel's name
/// LCM 1.3.1 says that it has 2^32 - 1 bytes or a few less.
inline std::span<const uint8_t> ReceivedBytes(const lcm_recv_buf_t& message) {
  if (message.data_size > kMaxMessageBytes) throw std::invalid_argument("packet is cut off in the channel's name");
  return {static_cast<const uint8_t*>(message.data), message.data_size};
}

}  // namespace coach
