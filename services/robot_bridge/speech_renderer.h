// Speech by espeak-ng (a program of its own, given the text on its standard input), rendered off the caller's thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
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

/// Languages that espeak-ng has voices for ("en", "el", "pt-br", ...); empty if it is not installed.
std::set<std::string> InstalledVoices();

class SpeechRenderer {
 public:
  SpeechRenderer();
  ~SpeechRenderer();
  SpeechRenderer(const SpeechRenderer&) = delete;
  SpeechRenderer& operator=(const SpeechRenderer&) = delete;

  /// A voice speaks the language, or its base language ("en" for "en-au").
  bool Speaks(const std::string& language) const;
  /// Renders in the background. At most 16 wait; the oldest is dropped with an error.
  void Order(int64_t id, const std::string& text, const std::string& language);
  /// What has been finished since the last call.
  std::vector<RenderedSpeech> Take();

 private:
  struct Job {
    int64_t id;
    std::string text, language;
  };
  void Run(const std::stop_token& stop);

  std::set<std::string> voices_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Job> jobs_;
  std::vector<RenderedSpeech> finished_;
  std::jthread thread_;
};

}  // namespace coach
