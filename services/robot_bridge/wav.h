// Sound as samples and as WAV files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace coach {

/// 16-bit mono speech.
struct RenderedSpeech {
  int64_t id = 0;
  int sample_rate = 22050;       ///< Hz
  std::vector<int16_t> samples;  ///< empty if it failed
  std::string error;             ///< why it failed
  double seconds() const { return static_cast<double>(samples.size()) / sample_rate; }
};

/// A complete WAV file.
std::string WavFile(const RenderedSpeech& speech);
/// Reads 16-bit PCM WAV (stereo is mixed down); a length that goes beyond the data, as streaming writers leave it, is
/// cut.
/// @throws std::runtime_error for anything else.
RenderedSpeech ReadWav(const std::string& bytes);
/// The same of a file of at most 16 MB. @throws std::runtime_error naming it
RenderedSpeech ReadWavFile(const std::filesystem::path& file);

}  // namespace coach
