#include "services/robot_bridge/log_back_end.h"

#include <cstdio>

#include "services/robot_bridge/speech_text.h"

namespace coach {

std::vector<BackEndEvent> LogBackEnd::Poll(int64_t now) {
  if (!speech_) return {};
  if (speech_end_ == 0) speech_end_ = now + static_cast<int64_t>(SpeakingTime(speech_->text) * 1e6);
  if (now < speech_end_) return {};
  const BackEndEvent done{BackEndEvent::Kind::kSpeechDone, speech_->id, ""};
  speech_.reset();
  return {done};
}

void LogBackEnd::Say(const SpeechOrder& speech) {
  speech_ = speech;
  speech_end_ = 0;
  write_("say " + std::to_string(speech.id) + " " + speech.language + " \"" + speech.text + "\"");
}

void LogBackEnd::Silence() {
  speech_.reset();
  write_("silence");
}

void LogBackEnd::Move(const JointPath& path) {
  std::string line = "move";
  for (int j = 0; j < kNumJoints && !path.points.empty(); ++j) {
    if (!path.moves[static_cast<size_t>(j)]) continue;
    char angle[64];
    std::snprintf(angle, sizeof angle, " %s %.3f", LimitOf(j).name.data(),
                  path.points.back().angles[static_cast<size_t>(j)]);
    line += angle;
  }
  char duration[32];
  std::snprintf(duration, sizeof duration, " in %.2f s", path.duration());
  write_(line + duration);
}

void LogBackEnd::SetVolume(double volume) {
  char line[32];
  std::snprintf(line, sizeof line, "volume %.2f", volume);
  write_(line);
}

}  // namespace coach
