#include "classroom.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/lesson_configuration.h"
#include "services/assembly_reasoner/lesson_file.h"

namespace coach {
namespace {

constexpr int64_t kFrame = 200000;                     // us
constexpr std::array<int, 4> kPartInSlot{0, 2, 1, 3};  // left, front, right, back
const std::string kProject = COACH_SOURCE_DIR;

}  // namespace

const Task& Rectangle() {
  static const Task task = LoadTask(kProject + "/deploy/tasks/rectangle_long_short.yaml", {.read_meshes = false});
  return task;
}

const std::map<std::string, PhraseBook>& Books() {
  static const auto books = LoadPhraseBooks(kProject + "/deploy/phrases");
  return books;
}

Classroom::Classroom(uint64_t seed, LessonOptions options, std::vector<Task> tasks)
    : tasks_(std::move(tasks)), options_(std::move(options)), random_(seed) {
  options_.seed = seed;
  NewLesson();
}

void Classroom::JoinRight(int connection) {
  const Connection& c = Rectangle().connections[connection];
  Join(kPartInSlot[c.slot_a], kPartInSlot[c.slot_b], c.X_AB);
}

void Classroom::Build() {
  for (int c = 0; c < 4; ++c) JoinRight(c);
}

LessonOutput Classroom::Operator(OperatorKind kind, const std::string& argument) {
  OperatorCommand command;
  command.id = ++operator_id_;
  command.kind = kind;
  command.argument = argument;
  LessonOutput out = lesson_->Handle(command);
  Note(out);
  return out;
}

void Classroom::Restart() {
  const std::string state = ToJson(lesson_->Save());
  NewLesson();
  lesson_->Restore(LessonMemoryFromJson(state));
  robot_id_ = 0;
  restarted_ = now_;
}

void Classroom::Run(double seconds) {
  const int before = refused;
  RunOn(seconds);
  EXPECT_EQ(refused, before);
}

void Classroom::RunOn(double seconds) {
  for (int i = 0; i < static_cast<int>(seconds / 0.2); ++i) Frame();
}

std::vector<std::string> Classroom::Keys() const {
  std::vector<std::string> keys;
  for (const Said& s : said) keys.push_back(s.command.phrase_key);
  return keys;
}

int Classroom::Count(const std::string& key) const {
  const auto keys = Keys();
  return static_cast<int>(std::count(keys.begin(), keys.end(), key));
}

const GuidanceEvent* Classroom::Find(const std::string& kind) const {
  const auto found = std::find_if(events.begin(), events.end(), [&](const GuidanceEvent& e) { return e.kind == kind; });
  return found == events.end() ? nullptr : &*found;
}

void Classroom::NewLesson() { lesson_ = std::make_unique<Lesson>(tasks_, Books(), options_, "TEST"); }

void Classroom::Frame() {
  now_ += kFrame;
  if (robot_id_ != 0 && robot_reports && now_ >= robot_until_) {
    RobotStatus status;
    status.session = lesson_->session();
    status.command_id = robot_id_;
    status.state = ActState::kDone;
    robot_id_ = 0;
    lesson_->Handle(status);
  }
  const LessonOutput out = lesson_->Step(Poses());
  if (!out.accepted) ++refused;
  Note(out);
}

Vector6 Classroom::Shake() {
  std::normal_distribution<double> noise(0, 0.0002);
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? 1 : 5) * noise(random_);
  return xi;
}

/// Parts 0.4 m apart, but where their joints put them.
std::vector<Pose> Classroom::PlacesOfParts() const {
  std::vector<Pose> X(4, Pose::Identity());
  std::vector<bool> placed(4, false);
  for (int p = 0; p < 4; ++p) {
    if (placed[p]) continue;
    X[p].translation() = Vector3(0.4 * p, 0, 0);
    placed[p] = true;
    for (int round = 0; round < 4; ++round) {
      for (const auto& [pair, X_AB] : joints_) {
        if (placed[pair.first] && !placed[pair.second]) X[pair.second] = X[pair.first] * X_AB;
        if (placed[pair.second] && !placed[pair.first]) X[pair.first] = X[pair.second] * X_AB.inverse();
        if (placed[pair.first] || placed[pair.second]) placed[pair.first] = placed[pair.second] = true;
      }
    }
  }
  return X;
}

PartPoses Classroom::Poses() {
  PartPoses poses;
  poses.utime = now_;
  poses.foreign.push_back({.velocity = Vector3(hand_speed(now_), 0, 0)});
  for (const Pose& X : PlacesOfParts()) {
    PartEstimate part;
    part.X_TP = Perturb(X, Shake());
    part.covariance = Matrix6::Identity() * 4e-8;
    part.visible_fraction = hidden ? 0 : 0.9;
    part.status = hidden ? PartStatus::kLost : PartStatus::kTracked;
    if (moving) part.velocity[0] = 0.2;
    poses.parts.push_back(part);
  }
  for (const auto& [pair, X_AB] : joints_) {
    if (hidden) break;
    PairEvidence e;
    const bool in_order = pair.first < pair.second;
    e.part_a = std::min(pair.first, pair.second);
    e.part_b = std::max(pair.first, pair.second);
    e.X_AB = Perturb(in_order ? X_AB : X_AB.inverse(), Shake());
    e.covariance = Matrix6::Identity() * 1e-7;
    e.visible_fraction = {0.9, 0.9};
    poses.pairs.push_back(e);
  }
  return poses;
}

void Classroom::Note(const LessonOutput& out) {
  state_ = out.state;
  events.insert(events.end(), out.events.begin(), out.events.end());
  for (const RobotCommand& command : out.commands) {
    if (command.kind == ActKind::kCancel) robot_until_ = now_;  // the robot falls silent and reports it
    if (command.kind == ActKind::kStop) robot_id_ = 0;
    if (command.kind != ActKind::kAct) continue;
    const bool operators = command.priority >= Priority::kOperator;
    EXPECT_TRUE(operators || robot_id_ == 0 || !robot_reports) << "two sentences at once: " << command.text;
    robot_id_ = command.id;
    robot_until_ = now_ + static_cast<int64_t>((0.5 + CountCharacters(command.text) / 14.0) * 1e6);
    said.push_back({command, now_, out.state});
  }
}

}  // namespace coach
