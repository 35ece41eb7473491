#include "services/robot_bridge/recordings.h"

#include <array>
#include <fstream>
#include <iterator>

#include "common/configuration/yaml_reader.h"
#include "services/robot_bridge/speech_text.h"
#include "services/robot_bridge/wav.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr std::array<int, 4> kRates{16000, 22050, 44100, 48000};  // Hz

void Check(const fs::path& file) {
  RenderedSpeech speech;
  try {
    speech = ReadWavFile(file);
  } catch (const std::runtime_error& problem) {
    throw ConfigurationError(problem.what());
  }
  for (const int rate : kRates) {
    if (speech.sample_rate == rate && !speech.samples.empty()) return;
  }
  throw ConfigurationError(file.string() + ": found " + std::to_string(speech.samples.size()) + " samples at " +
                           std::to_string(speech.sample_rate) +
                           " Hz, expected sound at 16000, 22050, 44100 or 48000 Hz");
}

}  // namespace

Recordings::Recordings(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw ConfigurationError(folder.string() + ": found no folder, expected recordings");
  for (const auto& language : fs::directory_iterator(folder)) {
    if (!language.is_directory()) continue;
    const std::string code = language.path().filename().string();
    for (const auto& entry : fs::directory_iterator(language.path())) {
      if (entry.path().extension() != ".wav") continue;
      Check(entry.path());
      fs::path words = entry.path();
      words.replace_extension(".txt");
      std::ifstream in(words, std::ios::binary);
      if (in) {
        by_text_[{code, CleanText(std::string{std::istreambuf_iterator<char>(in), {}})}] = entry.path();
      } else {
        by_name_[{code, entry.path().stem().string()}] = entry.path();
      }
    }
  }
}

std::optional<fs::path> Recordings::Find(const SpeechOrder& speech) const {
  if (const auto found = by_text_.find({speech.language, speech.text}); found != by_text_.end()) return found->second;
  if (speech.phrase_key.empty()) return std::nullopt;
  const auto found = by_name_.find({speech.language, speech.phrase_key + "-" + std::to_string(speech.wording + 1)});
  if (found == by_name_.end()) return std::nullopt;
  return found->second;
}

}  // namespace coach
