#include "services/robot_bridge/wav.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace coach {
namespace {

constexpr std::uintmax_t kLargestFile = 16 << 20;  // bytes; six minutes of speech

template <class T>
void Append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T ReadAt(const std::string& bytes, size_t at) {
  T value{};
  if (at + sizeof value > bytes.size()) throw std::runtime_error("WAV: truncated");
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace

std::string WavFile(const RenderedSpeech& speech) {
  const auto data_size = static_cast<uint32_t>(speech.samples.size() * 2);
  std::string bytes = "RIFF";
  Append<uint32_t>(bytes, 36 + data_size);
  bytes += "WAVEfmt ";
  Append<uint32_t>(bytes, 16);
  Append<uint16_t>(bytes, 1);  // PCM
  Append<uint16_t>(bytes, 1);  // mono
  Append<uint32_t>(bytes, static_cast<uint32_t>(speech.sample_rate));
  Append<uint32_t>(bytes, static_cast<uint32_t>(speech.sample_rate) * 2);
  Append<uint16_t>(bytes, 2);
  Append<uint16_t>(bytes, 16);
  bytes += "data";
  Append<uint32_t>(bytes, data_size);
  bytes.append(reinterpret_cast<const char*>(speech.samples.data()), data_size);
  return bytes;
}

RenderedSpeech ReadWav(const std::string& bytes) {
  if (bytes.size() < 12 || bytes.compare(0, 4, "RIFF") != 0 || bytes.compare(8, 4, "WAVE") != 0) {
    throw std::runtime_error("WAV: no RIFF/WAVE header");
  }
  RenderedSpeech speech;
  size_t channels = 0;
  for (size_t at = 12; at + 8 <= bytes.size();) {
    const std::string kind = bytes.substr(at, 4);
    const size_t size = ReadAt<uint32_t>(bytes, at + 4);
    at += 8;
    if (kind == "fmt ") {
      channels = ReadAt<uint16_t>(bytes, at + 2);
      speech.sample_rate = static_cast<int>(ReadAt<uint32_t>(bytes, at + 4));
      const bool pcm16 = ReadAt<uint16_t>(bytes, at) == 1 && ReadAt<uint16_t>(bytes, at + 14) == 16;
      if (!pcm16 || channels < 1 || channels > 2 || speech.sample_rate < 8000 || speech.sample_rate > 96000) {
        throw std::runtime_error("WAV: only 16-bit PCM, mono or stereo, 8 to 96 kHz");
      }
    } else if (kind == "data") {
      if (channels == 0) throw std::runtime_error("WAV: data before format");
      const size_t frames = std::min(size, bytes.size() - at) / (2 * channels);
      speech.samples.resize(frames);
      for (size_t i = 0; i < frames; ++i) {
        int sum = 0;
        for (size_t c = 0; c < channels; ++c) sum += ReadAt<int16_t>(bytes, at + 2 * (i * channels + c));
        speech.samples[i] = static_cast<int16_t>(sum / static_cast<int>(channels));
      }
      return speech;
    }
    at += size + size % 2;
  }
  throw std::runtime_error("WAV: no data");
}

RenderedSpeech ReadWavFile(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > kLargestFile) throw std::runtime_error(file.string() + ": can't be read, or over 16 MB");
  std::ifstream in(file, std::ios::binary);
  try {
    return ReadWav({std::istreambuf_iterator<char>(in), {}});
  } catch (const std::runtime_error& problem) {
    throw std::runtime_error(file.string() + ": " + problem.what());
  }
}

}  // namespace coach
