// One voice: which utterance is spoken next, and when. No clock: `now` (us) is the time of the data.
//
// * Only one utterance at a time. The next one begins when the robot has reported the end of the last, or when its
//   estimated length and `robot_patience` are over.
// * The most important first, the oldest of equals. What has waited longer than `expiry` is dropped, as is what is no
//   longer true (the caller's predicate).
// * Unsolicited utterances (reminders, announcements) begin at least `unsolicited_gap` apart and `pause` after whatever
//   was said before.
// * Nothing interrupts the robot's sentence but the operator, or its having become false.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/robot_act.h"

namespace coach {

struct SpeechOptions {
  double expiry = 4;                  ///< s that an utterance may wait
  double unsolicited_gap = 6;         ///< s between the beginnings of two unsolicited utterances
  double pause = 0.8;                 ///< s of silence before an unsolicited utterance
  double characters_per_second = 14;  ///< of speech, to estimate its length
  double robot_patience = 3;          ///< s after the estimated end for the robot's report
};

struct Utterance {
  std::string key;   ///< kind of phrase; "operator" with `text`
  std::string text;  ///< rendered by the caller when it is chosen; given only for the operator's words
  Priority priority = Priority::kExplanatory;
  bool solicited = false;  ///< answers something the child or the operator did
  int connection = -1;     ///< that it is about: index into Task::connections; -1 none
  int part_a = -1, part_b = -1;
  int64_t born = 0;  ///< us, when its reason arose
};

class SpeechQueue {
 public:
  using IsTrue = std::function<bool(const Utterance&)>;
  struct Dropped {
    Utterance utterance;
    std::string reason;
  };

  explicit SpeechQueue(const SpeechOptions& options = {}) : options_(options) {}

  /// Takes the place of a waiting utterance of the same key.
  void Offer(const Utterance& utterance);
  bool Waits(const std::string& key) const;
  void Clear() { waiting_.clear(); }
  /// Drops what waits and is of this priority at most.
  void Withdraw(Priority most) {
    std::erase_if(waiting_, [&](const Utterance& u) { return u.priority <= most; });
  }

  /// Drops what is stale or false and chooses what is to be said now, if anything.
  std::optional<Utterance> Next(int64_t now, const IsTrue& is_true);
  /// What Next() chose goes to the robot as command `id`.
  void Began(int64_t id, const Utterance& utterance, const std::string& text, int64_t now);
  /// The robot reports that command `id` is over.
  void Ended(int64_t id, int64_t now);
  /// The command being spoken that has become false or must give way to the operator; its id once, then 0.
  int64_t Interrupt(const IsTrue& is_true);

  bool speaking(int64_t now) const { return now < busy_until_; }
  int64_t quiet_since() const { return quiet_since_; }  ///< us, end of the last utterance; 0 nothing was said
  const std::optional<Utterance>& current() const { return current_; }
  std::vector<Dropped> TakeDropped() { return std::exchange(dropped_, {}); }

 private:
  bool MaySpeak(const Utterance& utterance, int64_t now) const;

  SpeechOptions options_;
  std::deque<Utterance> waiting_;
  std::optional<Utterance> current_;
  int64_t current_id_ = 0, busy_until_ = 0, quiet_since_ = 0, last_unsolicited_ = 0;
  bool interrupted_ = false;
  std::vector<Dropped> dropped_;
};

/// Characters of a UTF-8 text.
int CountCharacters(const std::string& utf8);

}  // namespace coach
