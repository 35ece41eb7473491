// Sentences that somebody has recorded, in place of a synthesised voice.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "services/robot_bridge/back_end.h"

namespace coach {

/// FOLDER/LANGUAGE/KEY-N.wav is wording N (from 1, as they stand in the phrase file) of the phrase KEY: for phrases
/// without placeholders. FOLDER/LANGUAGE/ANY.wav with ANY.txt beside it is the sentence that the text file holds. WAV:
/// 16 bits, mono or stereo, at 16000, 22050, 44100 or 48000 Hz, as robots take it.
class Recordings {
 public:
  Recordings() = default;  ///< none
  /// Looks at every file. @throws ConfigurationError naming what can't be used
  explicit Recordings(const std::filesystem::path& folder);

  /// By the words, else by phrase and wording.
  std::optional<std::filesystem::path> Find(const SpeechOrder& speech) const;
  size_t size() const { return by_text_.size() + by_name_.size(); }

 private:
  using Name = std::pair<std::string, std::string>;  // language; text, or key and number
  std::map<Name, std::filesystem::path> by_text_, by_name_;
};

}  // namespace coach
