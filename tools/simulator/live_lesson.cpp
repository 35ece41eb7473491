#include "tools/simulator/live_lesson.h"

#include <algorithm>

namespace coach {

LiveLesson::LiveLesson(Scenario scenario, const LiveLessonOptions& options)
    : scenario_(std::move(scenario)),
      options_(options),
      random_(scenario_.options.seed + 77),
      structure_(FinishedStructure(scenario_.stage.task)),
      solids_(scenario_.meshes),
      child_(scenario_.stage.task, solids_, StyleByName(scenario_.options.style), &scenario_.performance, &random_),
      lesson_(scenario_.stage.task, structure_, solids_, &child_, &scenario_.performance, &random_) {}

LiveLesson::~LiveLesson() = default;

void LiveLesson::Ask(int connection) { asked_ = connection; }
void LiveLesson::SayWrong() { told_wrong_ = true; }
bool LiveLesson::complete() const { return lesson_.complete(); }

void LiveLesson::Advance(double time) {
  if (child_.now() > time) return;  // still busy
  child_.set_now(time);
  Decide(time);
  if (child_.now() > time) last_act_ = child_.now();
}

void LiveLesson::Decide(double time) {
  const bool listens = options_.temper != LiveLessonOptions::Temper::kNeverListens;
  if (lesson_.complete()) return;
  if (lesson_.mistaken()) {
    if ((listens && told_wrong_) || time > last_act_ + options_.own_insight) {
      child_.Wait(options_.reaction);
      lesson_.Undo();
      told_wrong_ = false;
    }
    return;
  }
  told_wrong_ = false;
  if (listens ? !asked_.has_value() : time < last_act_ + options_.own_pace) return;
  child_.Wait(options_.reaction);
  ++steps_;
  const bool errs =
      options_.temper == LiveLessonOptions::Temper::kErrs ? steps_ % 2 == 0 : !listens && random_.Chance(0.5);
  if (!errs || !lesson_.Err()) lesson_.Build(listens ? *asked_ : -1);
  asked_.reset();
}

}  // namespace coach
