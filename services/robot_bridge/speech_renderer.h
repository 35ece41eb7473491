// Speech by espeak-ng (a program of its own, given the text on its standard input), or as somebody recorded it; made
// ready off the caller's thread.
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

#include "services/robot_bridge/recordings.h"
#include "services/robot_bridge/wav.h"

namespace coach {

/// Languages that espeak-ng has voices for ("en", "el", "pt-br", ...); empty if it is not installed.
std::set<std::string> InstalledVoices();

class SpeechRenderer {
 public:
  explicit SpeechRenderer(Recordings recordings = {});
  ~SpeechRenderer();
  SpeechRenderer(const SpeechRenderer&) = delete;
  SpeechRenderer& operator=(const SpeechRenderer&) = delete;

  /// Somebody has recorded this sentence.
  bool HasRecording(const SpeechOrder& speech) const { return recordings_.Find(speech).has_value(); }
  /// It is recorded, or a voice speaks its language, or the base language ("en" for "en-au").
  bool CanSay(const SpeechOrder& speech) const;
  /// Renders in the background. At most 16 wait; the oldest is dropped with an error.
  void Order(const SpeechOrder& speech);
  /// What has been finished since the last call.
  std::vector<RenderedSpeech> Take();

 private:
  RenderedSpeech Render(const SpeechOrder& speech) const;
  void Run(const std::stop_token& stop);

  const Recordings recordings_;
  std::set<std::string> voices_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<SpeechOrder> jobs_;
  std::vector<RenderedSpeech> finished_;
  std::jthread thread_;
};

}  // namespace coach
