// What must hold before a generated decoder or encoder may be trusted with a message.
//
// Generated decoders make an array as long as the message claims before they see that its bytes are missing. 16-bit
// counts bound that to some megabytes; the 32-bit counts of image bytes are checked here. Generated encoders read as
// many elements as the count says, whatever the array holds.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <type_traits>

#include "common/bus/channels.h"

namespace coach {

inline uint32_t BigEndian(std::span<const uint8_t> bytes, size_t offset, size_t size) {
  if (offset + size > bytes.size()) throw std::invalid_argument("message is cut off");
  uint32_t value = 0;
  for (size_t i = 0; i < size; ++i) value = value << 8 | bytes[offset + i];
  return value;
}

/// The last field of M is an array of bytes whose 32-bit count stands right before it; `before` more bytes precede them
/// than in an empty message.
template <class M>
void CheckTrailingBytes(std::span<const uint8_t> bytes, size_t before) {
  const size_t begin = static_cast<size_t>(M().getEncodedSize()) + before;
  if (BigEndian(bytes, begin - 4, 4) != bytes.size() - begin)
    throw std::invalid_argument("byte count does not fit the message");
}

template <class M>
void CheckBeforeDecoding(std::type_identity<M>, std::span<const uint8_t>) {}
inline void CheckBeforeDecoding(std::type_identity<color_image_t>, std::span<const uint8_t> bytes) {
  CheckTrailingBytes<color_image_t>(bytes, 0);
}
inline void CheckBeforeDecoding(std::type_identity<depth_image_t>, std::span<const uint8_t> bytes) {
  CheckTrailingBytes<depth_image_t>(bytes, 0);
}
inline void CheckBeforeDecoding(std::type_identity<detections_t>, std::span<const uint8_t> bytes) {
  const size_t regions = BigEndian(bytes, static_cast<size_t>(detections_t().getEncodedSize()) - 6, 2);
  CheckTrailingBytes<detections_t>(bytes, regions * static_cast<size_t>(region_t()._getEncodedSizeNoHash()));
}

template <class Vector>
bool Agrees(int64_t count, const Vector& array) {
  return count == static_cast<int64_t>(array.size());
}

/// Every count of the message equals the size of its array.
template <class M>
bool CountsAgree(const M&) {
  return true;
}
inline bool CountsAgree(const color_image_t& m) { return Agrees(m.data_size, m.data); }
inline bool CountsAgree(const depth_image_t& m) { return Agrees(m.data_size, m.data); }
inline bool CountsAgree(const detections_t& m) {
  return Agrees(m.num_regions, m.regions) && Agrees(m.class_map_size, m.class_map);
}
inline bool CountsAgree(const part_poses_t& m) {
  return Agrees(m.num_parts, m.parts) && Agrees(m.num_pairs, m.pairs) && Agrees(m.num_foreign, m.foreign);
}
inline bool CountsAgree(const connection_belief_t& m) { return Agrees(m.num_connections, m.connections); }
inline bool CountsAgree(const assembly_state_t& m) {
  return Agrees(m.num_connections, m.connections) && Agrees(m.num_events, m.events);
}
inline bool CountsAgree(const table_scene_t& m) {
  return Agrees(m.num_parts, m.parts) && Agrees(m.num_foreign, m.foreign);
}
inline bool CountsAgree(const task_t& m) {
  return Agrees(m.num_types, m.types) && Agrees(m.num_types, m.colours) && Agrees(m.num_parts, m.parts) &&
         Agrees(m.num_parts, m.part_types) && Agrees(m.num_connections, m.connections) &&
         Agrees(m.num_mistakes, m.mistakes);
}

}  // namespace coach
