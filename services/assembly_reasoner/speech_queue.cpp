#include "services/assembly_reasoner/speech_queue.h"

#include <algorithm>
#include <utility>

namespace coach {
namespace {

int64_t Micros(double seconds) { return static_cast<int64_t>(seconds * 1e6); }

}  // namespace

int CountCharacters(const std::string& utf8) {
  return static_cast<int>(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

void SpeechQueue::Offer(const Utterance& utterance) {
  std::erase_if(waiting_, [&](const Utterance& u) { return u.key == utterance.key; });
  waiting_.push_back(utterance);
}

bool SpeechQueue::Waits(const std::string& key) const {
  return std::any_of(waiting_.begin(), waiting_.end(), [&](const Utterance& u) { return u.key == key; });
}

bool SpeechQueue::MaySpeak(const Utterance& utterance, int64_t now) const {
  if (utterance.solicited) return true;
  const bool gap = last_unsolicited_ == 0 || now - last_unsolicited_ >= Micros(options_.unsolicited_gap);
  const bool pause = quiet_since_ == 0 || now - quiet_since_ >= Micros(options_.pause);
  return gap && pause;
}

std::optional<Utterance> SpeechQueue::Next(int64_t now, const IsTrue& is_true) {
  std::erase_if(waiting_, [&](const Utterance& u) {
    const bool expired = now - u.born > Micros(options_.expiry);
    if (!expired && is_true(u)) return false;
    dropped_.push_back({u, expired ? "waited too long" : "no longer true"});
    return true;
  });
  if (current_ && now >= busy_until_) {
    quiet_since_ = busy_until_;
    current_.reset();
  }
  std::stable_sort(waiting_.begin(), waiting_.end(),
                   [](const Utterance& a, const Utterance& b) { return a.priority > b.priority; });
  for (auto u = waiting_.begin(); u != waiting_.end(); ++u) {
    // The operator's words replace what is being said; everything else waits for its end.
    if (current_ && u->priority < Priority::kOperator) break;
    if (!MaySpeak(*u, now)) continue;
    Utterance chosen = *u;
    waiting_.erase(u);
    return chosen;
  }
  return std::nullopt;
}

void SpeechQueue::Began(int64_t id, const Utterance& utterance, const std::string& text, int64_t now) {
  const double length = 0.5 + CountCharacters(text) / options_.characters_per_second;
  current_ = utterance;
  current_id_ = id;
  interrupted_ = false;
  busy_until_ = now + Micros(length + options_.robot_patience);
  if (!utterance.solicited) last_unsolicited_ = now;
}

void SpeechQueue::Ended(int64_t id, int64_t now) {
  if (!current_ || id != current_id_) return;
  busy_until_ = std::min(busy_until_, now);
  quiet_since_ = now;
  current_.reset();
}

int64_t SpeechQueue::Interrupt(const IsTrue& is_true) {
  if (!current_ || interrupted_ || is_true(*current_)) return 0;
  interrupted_ = true;
  return current_id_;
}

}  // namespace coach
