#include "tools/operator/lesson.h"

#include <algorithm>
#include <chrono>

namespace coach {
namespace {

constexpr size_t kMaxWaiting = 30;         // pictures; at 30 Hz the tracker's delay may be a second
constexpr int64_t kFirstPoses = 200'000;   // us of pictures before those without poses are shown
constexpr int64_t kRestarted = 2'000'000;  // us; time that runs back by more is a new recording

bool Drawn(const PartEstimate& part) {
  return part.status == PartStatus::kTracked || part.status == PartStatus::kOccluded ||
         part.status == PartStatus::kLost;
}

/// A state that a command can still leave.
bool Open(ActState state) {
  return state == ActState::kNone || state == ActState::kQueued || state == ActState::kStarted;
}

}  // namespace

Lesson::Lesson(const Options& options) : options_(options) {}

void Lesson::Changed() {
  ++revision_;
  changed_.notify_all();
}

void Lesson::Touch() {
  const std::lock_guard lock(mutex_);
  Changed();
}

void Lesson::OnTask(std::shared_ptr<const TaskView> task) {
  const std::lock_guard lock(mutex_);
  task_ = std::move(task);
  Changed();
}

void Lesson::OnPicture(Picture picture) {
  auto shared = std::make_shared<const Picture>(std::move(picture));
  {
    const std::lock_guard lock(mutex_);
    if (!waiting_.empty() && shared->utime < waiting_.back()->utime) waiting_.clear();
    waiting_.push_back(shared);
    while (waiting_.size() > kMaxWaiting) waiting_.pop_front();
    // Pictures that a busy tracker leaves out are left out here too: outlines that come and go disturb the eye.
    const int64_t silent = shared->utime - poses_utime_;
    if (poses_utime_ != 0 && silent > -kRestarted && silent < options_.pose_patience_us) return;
    if (poses_utime_ == 0 && shared->utime - waiting_.front()->utime < kFirstPoses) return;
  }
  Show(shared, nullptr);
}

void Lesson::OnPoses(const PartPoses& poses) {
  std::shared_ptr<const Picture> picture;
  {
    const std::lock_guard lock(mutex_);
    poses_utime_ = poses.utime;
    const auto match =
        std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& p) { return p->utime == poses.utime; });
    if (match != waiting_.end()) {
      picture = *match;
      waiting_.erase(waiting_.begin(), match + 1);
    }
  }
  Show(picture, &poses);
}

void Lesson::Show(std::shared_ptr<const Picture> picture, const PartPoses* poses) {
  const int64_t utime = poses ? poses->utime : picture->utime;
  auto view = std::make_shared<LiveView>();
  std::shared_ptr<const TaskView> task;
  {
    const std::lock_guard lock(mutex_);
    const int64_t since = utime - shown_utime_;
    // A tenth of a period of tolerance: a camera of exactly this rate is not halved by its jitter.
    if (view_ && since > -kRestarted && since < static_cast<int64_t>(0.9e6 / options_.picture_rate)) return;
    shown_utime_ = utime;
    task = task_;
  }
  view->picture = std::move(picture);
  if (poses) {
    view->poses = *poses;
    const Task* parts = task ? task->task.get() : nullptr;
    if (view->picture && parts && parts->parts.size() == poses->parts.size()) {
      const Pose X_CT = poses->X_TC.inverse();
      for (size_t k = 0; k < poses->parts.size(); ++k) {
        const auto& mesh = task->meshes[static_cast<size_t>(parts->parts[k].type)];
        view->outlines.push_back(Drawn(poses->parts[k])
                                     ? Silhouette(mesh, X_CT * poses->parts[k].X_TP, view->picture->camera)
                                     : std::vector<Polygon>{});
      }
    }
  } else {
    view->poses.utime = utime;
  }
  const std::lock_guard lock(mutex_);
  view->number = view_ ? view_->number + 1 : 1;
  view_ = std::move(view);
  viewed_.notify_all();
}

void Lesson::AddEvent(const GuidanceEvent& event) {
  if (events_.contains(event.id)) return;
  events_[event.id] = event;
  while (events_.size() > options_.max_events) events_.erase(events_.begin());
}

void Lesson::OnState(const AssemblyState& state, int64_t now) {
  const std::lock_guard lock(mutex_);
  if (state.session != state_.session) {
    events_.clear();
    acts_.clear();
  }
  state_ = state;
  state_seen_ = now;
  for (const auto& event : state.events) AddEvent(event);
  Changed();
}

void Lesson::OnEvent(const GuidanceEvent& event) {
  const std::lock_guard lock(mutex_);
  AddEvent(event);
  Changed();
}

void Lesson::OnCommand(const RobotCommand& command, int64_t now) {
  const std::lock_guard lock(mutex_);
  const bool known = std::any_of(acts_.begin(), acts_.end(), [&](const SpokenAct& act) {
    return act.command.id == command.id && act.command.session == command.session;
  });
  if (known) return;
  acts_.push_back({command, ActState::kNone, "", now});
  while (acts_.size() > options_.max_acts) acts_.pop_front();
  Changed();
}

void Lesson::OnStatus(const RobotStatus& status, int64_t now) {
  const std::lock_guard lock(mutex_);
  robot_ = status;
  robot_seen_ = now;
  for (auto& act : acts_) {
    if (act.command.id != status.command_id || act.command.session != status.session || !Open(act.state)) continue;
    act.state = status.state;
    act.reason = status.reason;
  }
  Changed();
}

void Lesson::OnHealth(const ServiceReport& report) {
  const std::lock_guard lock(mutex_);
  services_[report.service] = report;
  Changed();
}

Lesson::Snapshot Lesson::Read(int64_t after_event) const {
  const std::lock_guard lock(mutex_);
  Snapshot snapshot;
  snapshot.revision = revision_;
  if (task_) {
    snapshot.task_revision = task_->revision;
    snapshot.task_name = task_->name;
    snapshot.task_choice = task_->choice;
    snapshot.task_problem = task_->problem;
  }
  snapshot.state = state_;
  snapshot.state_seen = state_seen_;
  snapshot.robot = robot_;
  snapshot.robot_seen = robot_seen_;
  snapshot.acts.assign(acts_.begin(), acts_.end());
  for (const auto& [name, report] : services_) snapshot.services.push_back(report);
  for (auto event = events_.upper_bound(after_event); event != events_.end(); ++event) {
    snapshot.events.push_back(event->second);
  }
  snapshot.data_utime = std::max(state_.utime, view_ ? view_->poses.utime : 0);
  return snapshot;
}

std::shared_ptr<const TaskView> Lesson::task() const {
  const std::lock_guard lock(mutex_);
  return task_;
}

bool Lesson::WaitForChange(int64_t revision, int timeout_ms) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [&] { return closed_ || revision_ > revision; });
  return revision_ > revision;
}

std::shared_ptr<const LiveView> Lesson::WaitForView(int64_t number, int timeout_ms) const {
  std::unique_lock lock(mutex_);
  const auto newer = [&] { return view_ && view_->number > number; };
  viewed_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [&] { return closed_ || newer(); });
  return newer() ? view_ : nullptr;
}

std::shared_ptr<const LiveView> Lesson::view() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

void Lesson::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
  viewed_.notify_all();
}

}  // namespace coach
