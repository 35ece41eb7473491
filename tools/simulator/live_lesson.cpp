#include "tools/simulator/live_lesson.h"

#include <algorithm>
#include <stdexcept>

namespace coach {

LiveLessonOptions::Temper TemperByName(const std::string& name) {
  if (name == "listens") return LiveLessonOptions::Temper::kListens;
  if (name == "errs") return LiveLessonOptions::Temper::kErrs;
  if (name == "never-listens") return LiveLessonOptions::Temper::kNeverListens;
  throw std::invalid_argument("child: found " + name + ", expected listens, errs or never-listens");
}

LiveLesson::LiveLesson(Scenario scenario, const LiveLessonOptions& options)
    : scenario_(std::move(scenario)),
      options_(options),
      random_(scenario_.options.seed + 77),
      structure_(FinishedStructure(scenario_.stage.task)),
      solids_(scenario_.meshes),
      child_(scenario_.stage.task, solids_, StyleByName(scenario_.options.style), &scenario_.performance, &random_),
      lesson_(scenario_.stage.task, structure_, solids_, &child_, &scenario_.performance, &random_) {}

void LiveLesson::Hear(const std::string& phrase_key, int step) {
  if (phrase_key.rfind("wrong", 0) == 0) SayWrong();
  if (phrase_key == "step" || phrase_key.rfind("idle_", 0) == 0) Ask(step);
}

void LiveLesson::Ask(int connection) {
  asked_ = connection;
  last_word_ = child_.now();
}
void LiveLesson::SayWrong() {
  told_wrong_ = true;
  last_word_ = child_.now();
}
bool LiveLesson::complete() const { return lesson_.complete(); }

void LiveLesson::Advance(double time) {
  if (child_.now() > time) return;  // still busy
  child_.set_now(time);
  Decide(time);
  if (child_.now() > time) last_act_ = child_.now();
}

bool LiveLesson::DecidesAlone(double time) const {
  return options_.temper == LiveLessonOptions::Temper::kNeverListens ||
         (!asked_ && time > last_word_ + options_.patience);
}

void LiveLesson::CorrectWhenTime(double time) {
  const bool told = told_wrong_ && options_.temper != LiveLessonOptions::Temper::kNeverListens;
  if (!told && time <= last_act_ + options_.own_insight) return;
  child_.Wait(options_.reaction);
  lesson_.Undo();
  told_wrong_ = false;
}

void LiveLesson::Decide(double time) {
  if (lesson_.complete()) return;
  if (lesson_.mistaken()) return CorrectWhenTime(time);
  told_wrong_ = false;
  const bool alone = DecidesAlone(time);
  if (alone ? time < last_act_ + options_.own_pace : !asked_.has_value()) return;
  child_.Wait(options_.reaction);
  ++steps_;
  const bool errs =
      options_.temper == LiveLessonOptions::Temper::kErrs ? steps_ % 2 == 0 : alone && random_.Chance(0.5);
  if (errs && lesson_.Err()) return;  // and comes back to what it was asked once this is undone
  lesson_.Build(alone ? -1 : *asked_);
  asked_.reset();
}

}  // namespace coach
