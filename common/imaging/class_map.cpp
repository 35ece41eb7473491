#include "common/imaging/class_map.h"

#include <stdexcept>
#include <string>

namespace coach {
namespace {

struct Run {
  uint8_t value = 0;
  size_t length = 0;
};

void Append(std::vector<Run>& runs, const Run& run) {
  if (!runs.empty() && runs.back().value == run.value)
    runs.back().length += run.length;
  else
    runs.push_back(run);
}

std::vector<Run> Runs(std::span<const uint8_t> map) {
  std::vector<Run> runs;
  for (const uint8_t value : map) Append(runs, {value, 1});
  return runs;
}

/// Runs shorter than `shortest` take the value of the run before them.
std::vector<Run> Simplify(const std::vector<Run>& runs, size_t shortest) {
  std::vector<Run> simple;
  for (const Run& run : runs) {
    const bool keep = simple.empty() || run.length >= shortest;
    Append(simple, {keep ? run.value : simple.back().value, run.length});
  }
  return simple;
}

std::vector<uint8_t> Code(const std::vector<Run>& runs) {
  std::vector<uint8_t> bytes;
  for (const Run& run : runs) {
    bytes.push_back(run.value);
    size_t rest = run.length - 1;
    for (; rest >= 128; rest >>= 7) bytes.push_back(static_cast<uint8_t>(rest | 128));
    bytes.push_back(static_cast<uint8_t>(rest));
  }
  return bytes;
}

}  // namespace

std::vector<uint8_t> EncodeClassMap(std::span<const uint8_t> map, size_t max_bytes) {
  const std::vector<Run> runs = Runs(map);
  std::vector<uint8_t> bytes = Code(runs);
  for (size_t shortest = 2; bytes.size() > max_bytes && shortest < 2 * map.size(); shortest *= 2)
    bytes = Code(Simplify(runs, shortest));
  return bytes;
}

std::vector<uint8_t> DecodeClassMap(std::span<const uint8_t> bytes, size_t pixels) {
  if (bytes.empty()) return {};
  if (bytes.size() > kMaxClassMapBytes)
    throw std::invalid_argument("class map of " + std::to_string(bytes.size()) + " bytes");
  std::vector<uint8_t> map;
  map.reserve(pixels);
  for (size_t i = 0; i < bytes.size();) {
    const uint8_t value = bytes[i++];
    size_t rest = 0;
    bool more = true;
    for (int shift = 0; more; shift += 7) {
      if (i == bytes.size() || shift > 28)
        throw std::invalid_argument("class map: a run's length is cut off or too long");
      rest |= static_cast<size_t>(bytes[i] & 127) << shift;
      more = bytes[i++] & 128;
    }
    if (rest >= pixels - map.size()) throw std::invalid_argument("class map: more pixels than the image has");
    map.insert(map.end(), rest + 1, value);
  }
  if (map.size() != pixels) throw std::invalid_argument("class map: fewer pixels than the image has");
  return map;
}

}  // namespace coach
