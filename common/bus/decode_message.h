// From the bytes of the wire, or of a recording, to a message.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <type_traits>

#include "common/bus/message_check.h"

namespace coach {

/// @throws std::invalid_argument if the bytes are another type or version, are cut off, go on behind the message, or
/// claim arrays that they don't hold.
template <Message M>
M DecodeMessage(std::span<const uint8_t> bytes) {
  CheckBeforeDecoding(std::type_identity<M>(), bytes);
  M message;
  const int size = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, size) != size) throw std::invalid_argument("not a message of this type");
  return message;
}

/// Whether the bytes begin with the fingerprint of M as this version of Coach knows it.
template <Message M>
bool HasFingerprint(std::span<const uint8_t> bytes) {
  if (bytes.size() < 8) return false;
  const uint64_t hash = static_cast<uint64_t>(BigEndian(bytes, 0, 4)) << 32 | BigEndian(bytes, 4, 4);
  return hash == static_cast<uint64_t>(M::getHash());
}

}  // namespace coach
