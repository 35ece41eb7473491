// The map of colour classes on the wire: run-length coded, at most 20 kB.
//
// The map has one byte a pixel, row by row: bit c is set where the pixel's colour is in class c. It travels as runs in
// reading order (runs go on over the ends of rows): one byte value, then the run's length in px - 1 as a little-endian
// base-128 number (7 bits a byte, high bit set on all but the last).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace coach {

constexpr size_t kMaxClassMapBytes = 20'000;

/// Codes a map of width * height bytes. A map whose code would be longer than max_bytes (speckle) is simplified until
/// it fits: runs shorter than 2, 4, 8, ... px take the value of the run before them. An empty map gives no bytes.
std::vector<uint8_t> EncodeClassMap(std::span<const uint8_t> map, size_t max_bytes = kMaxClassMapBytes);

/// The map of exactly `pixels` bytes; no bytes give an empty map.
/// @throws std::invalid_argument if the code does not fill it exactly or is longer than kMaxClassMapBytes.
std::vector<uint8_t> DecodeClassMap(std::span<const uint8_t> bytes, size_t pixels);

}  // namespace coach
