#include "services/assembly_reasoner/lesson.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace coach {
namespace {

constexpr size_t kRecentEvents = 8;
constexpr int64_t kIdReserve = 1000;  // ids left free after a restart: some may have gone out unrecorded

const char* Name(OperatorKind kind) {
  constexpr const char* kNames[] = {"choose_task", "language", "start", "pause",  "resume",        "skip", "mark_done",
                                    "mark_undone", "repeat",   "say",   "volume", "reset_tracker", "stop", "help"};
  return kNames[static_cast<int>(kind)];
}

bool IsSeen(const PartEstimate& part) {
  return part.status == PartStatus::kTracked || part.status == PartStatus::kOccluded;
}

}  // namespace

Lesson::Lesson(std::vector<Task> tasks, std::map<std::string, PhraseBook> books, const LessonOptions& options,
               std::string station)
    : tasks_(std::move(tasks)),
      books_(std::move(books)),
      options_(options),
      station_(std::move(station)),
      language_(options.language),
      speech_(options.speech),
      policy_(options.response, speech_),
      random_(options.seed) {
  if (tasks_.empty()) throw std::invalid_argument("a lesson needs a task");
  if (!books_.contains(language_)) throw std::invalid_argument("no phrases for the language '" + language_ + "'");
  Choose(0);
}

void Lesson::Choose(size_t task) {
  chosen_ = task;
  reasoner_ = std::make_unique<AssemblyReasoner>(tasks_[task], options_.reasoner);
  skipped_.clear();
  poses_.reset();
  resting_ = false;
  changed_ = now_;
  state_ = {};
}

void Lesson::Begin(int64_t session) {
  greeted_ = greeted_ && session == session_;
  session_ = session;
  begun_ = true;
  resting_ = false;
  skipped_.clear();
  policy_.Begin(now_, greeted_);
}

LessonView Lesson::View(std::vector<ConnectionEvent> events) const {
  return {poses_->utime, reasoner_.get(), &*poses_, std::move(events), skipped_};
}

LessonOutput Lesson::Step(const PartPoses& poses) {
  LessonOutput out;
  if (changed_ != 0 && poses.utime - changed_ < static_cast<int64_t>(options_.task_change * 1e6)) {
    out.accepted = false;
    out.refused = "they may be of the former task's parts";
    Finish(out);
    return out;
  }
  ReasonerOutput reasoned = reasoner_->Step(poses);
  out.accepted = reasoned.accepted;
  out.refused = reasoned.refused;
  state_ = std::move(reasoned.state);
  out.belief = std::move(reasoned.belief);
  if (out.accepted) {
    poses_ = poses;
    now_ = poses.utime;
    if (options_.start_by_itself && !begun_) Begin(poses.utime);
    Tell(reasoned.events, out);
    if (begun_) {
      if (resting_) {
        Rest(out);
      } else {
        policy_.Step(View(std::move(reasoned.events)));
      }
      if (poses_) Speak(out);
    }
  }
  Finish(out);
  return out;
}

void Lesson::Tell(const std::vector<ConnectionEvent>& events, LessonOutput& out) {
  for (const ConnectionEvent& e : events) {
    GuidanceEvent told;
    told.utime = e.decided;
    told.since = e.since;
    told.kind = e.type;
    told.subject = e.name;
    told.part_a = e.part_a;
    told.part_b = e.part_b;
    told.probability = e.probability;
    Emit(told, out);
  }
}

void Lesson::Emit(GuidanceEvent event, LessonOutput& out) {
  event.id = ++last_event_;
  recent_.push_back(event);
  if (recent_.size() > kRecentEvents) recent_.pop_front();
  out.events.push_back(std::move(event));
}

/// The task is built and praised: says that another one follows, and introduces it after the pause.
void Lesson::Rest(LessonOutput& out) {
  if (policy_.phase() == Phase::kPaused || speech_.speaking(now_)) {
    rested_since_ = 0;
    return;
  }
  if (!next_told_) {
    Utterance u;
    u.key = "next_task";
    u.born = now_;
    speech_.Offer(u);
    return;
  }
  if (rested_since_ == 0) rested_since_ = now_;
  if (static_cast<double>(now_ - rested_since_) * 1e-6 >= options_.task_pause) BeginNext(out);
}

void Lesson::BeginNext(LessonOutput& out) {
  Choose(chosen_ + 1);
  out.belief.connections.clear();  // they were of the former task
  GuidanceEvent e;
  e.utime = e.since = now_;
  e.kind = "session";
  e.subject = "next_task";
  e.reason = task().name;
  Emit(e, out);
  Begin(session_);
}

bool Lesson::IsTrue(const Utterance& utterance, const LessonView& view) const {
  return utterance.key == "next_task" ? resting_ : policy_.IsTrue(utterance, view);
}

/// Withdraws what has become false, then says what is due.
void Lesson::Speak(LessonOutput& out) {
  const LessonView view = View({});
  const auto is_true = [&](const Utterance& u) { return IsTrue(u, view); };
  if (const int64_t id = speech_.Interrupt(is_true)) {
    RobotCommand cancel = Command(*speech_.current());
    cancel.kind = ActKind::kCancel;
    cancel.replaces_id = id;
    out.commands.push_back(cancel);
    GuidanceEvent e;
    e.utime = e.since = view.now;
    e.kind = "act";
    e.subject = speech_.current()->key;
    e.reason = "withdrawn: no longer true";
    Emit(e, out);
  }
  if (const auto next = speech_.Next(view.now, is_true)) Say(*next, out);
}

RobotCommand Lesson::Command(const Utterance& utterance) {
  RobotCommand command;
  command.id = ++last_command_;
  command.station = station_;
  command.session = session_;
  command.priority = utterance.priority;
  command.language = language_;
  command.phrase_key = utterance.key;
  command.valid_for_us = static_cast<int64_t>(options_.validity * 1e6);
  return command;
}

std::string Lesson::Words(const Utterance& u, RobotCommand& command) {
  if (!u.text.empty()) return u.text;
  const PhraseBook& book = books_.at(language_);
  const int n = book.Wordings(u.key);
  std::deque<int>& last = wordings_[language_ + " " + u.key];
  while (static_cast<int>(last.size()) > std::min(options_.no_repeat, n - 1)) last.pop_front();
  std::vector<int> fresh;
  for (int w = 0; w < n; ++w) {
    if (std::find(last.begin(), last.end(), w) == last.end()) fresh.push_back(w);
  }
  command.wording = fresh[random_() % fresh.size()];
  last.push_back(command.wording);
  PhraseValues values;
  const Task& t = task();
  if (u.part_a >= 0) values.type_a = t.parts[u.part_a].type;
  if (u.part_b >= 0) values.type_b = t.parts[u.part_b].type;
  values.left = std::max(0, state_.required - state_.made);
  if (u.connection >= 0) {
    const double angle = RotationAngle(t.connections[u.connection].X_AB.linear()) * 180 / std::numbers::pi;
    values.angle = static_cast<int>(std::lround(angle / 5)) * 5;
  }
  return book.Render(t, u.key, command.wording, values, options_.group);
}

/// Where the robot looks, where it points, the colour of its eyes.
void Lesson::Aim(const Utterance& u, RobotCommand& command) const {
  if (!poses_) return;
  const auto place = [&](int part) -> std::optional<Vector3> {
    if (part < 0 || !IsSeen(poses_->parts[part])) return std::nullopt;
    return poses_->parts[part].X_TP.translation();
  };
  const auto a = place(u.part_a), b = place(u.part_b);
  command.look_target = a ? a : b;
  if (u.key == "praise" && a && b) command.look_target = Vector3((*a + *b) / 2);
  const bool points = u.key == "step" || u.key == "idle_3" || u.key == "idle_3_straight" || u.key == "idle_4" ||
                      u.priority == Priority::kCorrective;
  if (points && u.key != "repair") command.point_target = b ? b : a;
  if (u.part_a >= 0 && u.priority != Priority::kCongratulatory) command.eye_colour = task().TypeOf(u.part_a).colour;
  command.order = u.key == "idle_2" ? ActOrder::kLookThenSay : ActOrder::kTogether;
}

void Lesson::Say(const Utterance& u, LessonOutput& out) {
  RobotCommand command = Command(u);
  command.text = Words(u, command);
  Aim(u, command);
  speech_.Began(command.id, u, command.text, now_);
  policy_.Spoken(u, now_);
  greeted_ |= u.key == "introduction";
  next_told_ |= u.key == "next_task";
  if (u.key == "complete" && HasNext()) {
    resting_ = true;
    next_told_ = false;
    rested_since_ = 0;
  }
  GuidanceEvent e;
  e.utime = e.since = now_;
  e.kind = "say";
  e.subject = u.key;
  e.part_a = u.part_a;
  e.part_b = u.part_b;
  e.reason = command.text;
  Emit(e, out);
  last_said_ = command;
  out.commands.push_back(std::move(command));
}

LessonOutput Lesson::Handle(const OperatorCommand& command) {
  LessonOutput out;
  const std::string refusal = Obey(command, out);
  GuidanceEvent e;
  e.utime = e.since = now_;
  e.kind = "operator";
  e.subject = Name(command.kind);
  e.reason = refusal.empty() ? command.argument : "refused: " + refusal;
  Emit(e, out);
  if (begun_ && poses_) {
    Speak(out);
    state_.step = policy_.step();
  }
  Finish(out);
  return out;
}

/// @returns why the command can't be obeyed; empty if it was
std::string Lesson::Obey(const OperatorCommand& command, LessonOutput& out) {
  const bool running = begun_ && (resting_ || policy_.phase() != Phase::kComplete);
  switch (command.kind) {
    case OperatorKind::kChooseTask:
      return ChooseTask(command.argument);
    case OperatorKind::kLanguage:
      if (!books_.contains(command.argument)) return "no phrases for the language '" + command.argument + "'";
      language_ = command.argument;
      return "";
    case OperatorKind::kStart:
      if (running && !resting_) return "the lesson is running";
      if (resting_) {
        BeginNext(out);
      } else {
        Begin(command.id);
      }
      return "";
    case OperatorKind::kPause:
      if (!running || policy_.phase() == Phase::kPaused) return "nothing is running";
      policy_.Pause(now_);
      return "";
    case OperatorKind::kResume:
      if (!begun_ || policy_.phase() != Phase::kPaused) return "the lesson is not paused";
      policy_.Resume(now_);
      return "";
    case OperatorKind::kSkip:
      return running ? Skip(out) : "no step is asked for";
    case OperatorKind::kMarkDone:
    case OperatorKind::kMarkUndone:
      return Mark(command.argument, command.kind == OperatorKind::kMarkDone, out);
    case OperatorKind::kRepeat:
      if (last_said_.text.empty()) return "nothing was said yet";
      SayAtOnce("operator", last_said_.text, out);
      return "";
    case OperatorKind::kSay:
      if (command.argument.empty() || command.argument.size() > 400) return "the text has to have 1 to 400 bytes";
      SayAtOnce("operator", command.argument, out);
      return "";
    case OperatorKind::kHelp:
      if (!running || resting_) return "no step is asked for";
      policy_.Help();
      return "";
    case OperatorKind::kStop:
      if (running) policy_.Pause(now_);
      Stop(out);
      return "";
    case OperatorKind::kVolume:
    case OperatorKind::kResetTracker:
      return "";
  }
  return "an unknown command";
}

std::string Lesson::ChooseTask(const std::string& name) {
  const auto found = std::find_if(tasks_.begin(), tasks_.end(),
                                  [&](const Task& t) { return t.name == name || t.file.stem() == name; });
  if (found == tasks_.end()) return "no task is called '" + name + "'";
  Choose(static_cast<size_t>(found - tasks_.begin()));
  if (begun_) Begin(session_);
  return "";
}

/// The step, or what is left of the pause between two tasks.
std::string Lesson::Skip(LessonOutput& out) {
  if (resting_) {
    BeginNext(out);
    return "";
  }
  if (policy_.step() < 0) return "no step is asked for";
  skipped_.push_back(policy_.step());
  policy_.AnnounceAgain();
  SayAtOnce("skipped", "", out);
  return "";
}

void Lesson::SayAtOnce(const std::string& key, const std::string& text, LessonOutput& out) {
  Utterance u;
  u.key = key;
  u.text = text;
  u.priority = Priority::kOperator;
  u.solicited = true;
  u.born = now_;
  Say(u, out);
}

void Lesson::Stop(LessonOutput& out) {
  speech_.Clear();
  Utterance u;
  u.priority = Priority::kStop;
  RobotCommand stop = Command(u);
  stop.kind = ActKind::kStop;
  if (speech_.current()) speech_.Ended(last_said_.id, now_);
  out.commands.push_back(stop);
}

std::string Lesson::Mark(const std::string& name, bool made, LessonOutput& out) {
  if (!poses_) return "no poses have come yet";
  int connection = name.empty() ? policy_.step() : -1;
  for (size_t i = 0; i < task().connections.size(); ++i) {
    if (task().connections[i].name == name) connection = static_cast<int>(i);
  }
  if (connection < 0) return "no connection is called '" + name + "'";
  const auto events = reasoner_->Override(connection, made, poses_->utime);
  if (events.empty()) return std::string("it is ") + (made ? "made, or no part is free for it" : "open") + " already";
  Tell(events, out);
  return "";
}

void Lesson::Handle(const RobotStatus& status) {
  if (status.session == session_ && status.state >= ActState::kDone) speech_.Ended(status.command_id, now_);
  if (help_requests_ >= 0 && status.help_requests > help_requests_) policy_.Help();
  help_requests_ = status.help_requests;
}

void Lesson::Finish(LessonOutput& out) {
  for (GuidanceEvent& e : policy_.TakeEvents()) Emit(std::move(e), out);
  for (const SpeechQueue::Dropped& d : speech_.TakeDropped()) {
    GuidanceEvent e;
    e.utime = e.since = now_;
    e.kind = "act";
    e.subject = d.utterance.key;
    e.part_a = d.utterance.part_a;
    e.part_b = d.utterance.part_b;
    e.reason = "not said: " + d.reason;
    if (d.utterance.key != "step") Emit(e, out);
  }
  state_.session = session_;
  state_.task = task().name;
  state_.phase = policy_.phase();
  state_.idle_level = policy_.idle_level();
  if (begun_) state_.step = policy_.step();
  state_.events.assign(recent_.begin(), recent_.end());
  out.state = state_;
}

LessonMemory Lesson::Save() const {
  return {session_,          task().name,    language_, begun_,      greeted_,
          reasoner_->Save(), policy_.Save(), skipped_,  last_event_, last_command_};
}

void Lesson::Restore(const LessonMemory& memory) {
  const auto found = std::find_if(tasks_.begin(), tasks_.end(), [&](const Task& t) { return t.name == memory.task; });
  if (found == tasks_.end()) throw std::invalid_argument("the stored lesson is of an unknown task");
  const auto is_known = [&](int c) { return c >= 0 && c < static_cast<int>(found->connections.size()); };
  if (!std::all_of(memory.skipped.begin(), memory.skipped.end(), is_known))
    throw std::invalid_argument("the stored lesson skips an unknown connection");
  if (memory.policy.step != -1 && !is_known(memory.policy.step))
    throw std::invalid_argument("the stored lesson asks for an unknown connection");
  Choose(static_cast<size_t>(found - tasks_.begin()));
  reasoner_->Restore(memory.assembly);
  skipped_ = memory.skipped;
  if (books_.contains(memory.language)) language_ = memory.language;
  session_ = memory.session;
  begun_ = memory.begun;
  last_event_ = memory.last_event + kIdReserve;
  last_command_ = memory.last_command + kIdReserve;
  if (!begun_) return;
  greeted_ = memory.greeted;
  policy_.Restore(memory.policy, greeted_);
  resting_ = next_told_ = memory.policy.celebrated && HasNext();
  rested_since_ = 0;
}

}  // namespace coach
