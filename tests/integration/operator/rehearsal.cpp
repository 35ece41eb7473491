// A lesson played by a script instead of services: lets the page be tested, and worked on, without camera, tracker and
// robot. Obeys the page's commands as the real services do.
//
// usage: page-rehearsal TASK.yaml [PORT [SECONDS_PER_STEP [PAGE_FOLDER]]]; prints the page's address, ends with
// SIGTERM.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <deque>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "common/assembly/task_file.h"
#include "common/imaging/image_codec.h"
#include "tools/operator/assembly_plan.h"
#include "tools/operator/page_server.h"

namespace coach {
namespace {

constexpr double kRate = 15;  // Hz
std::atomic<bool> ended{false};

int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

struct Wording {
  const char *hello, *step, *good, *wrong, *praise, *bye;
};
constexpr Wording kEnglish{"Hello! Let us build something together.",
                           "Please join %s and %s.",
                           "Well done!",
                           "Look again: these two do not belong together.",
                           "You did it! What a beautiful work.",
                           "I stop."};
constexpr Wording kGreek{
    "Γεια σου! Ας χτίσουμε κάτι μαζί.", "Ένωσε %s και %s.", "Μπράβο!", "Κοίτα ξανά: αυτά τα δύο δεν ταιριάζουν.",
    "Τα κατάφερες! Τι όμορφη δουλειά.", "Σταματώ."};

class Rehearsal {
 public:
  Rehearsal(std::shared_ptr<const Task> task, Lesson& lesson, double seconds_per_step)
      : task_(std::move(task)),
        lesson_(lesson),
        step_time_(seconds_per_step),
        own_(task_->variants.at(0)),
        goal_(SlotPoses(*task_, own_)) {
    status_.language = "en";
    camera_ = {640, 480, 575, 575, 319.5, 239.5, {}};
    const Matrix3 R =
        (Eigen::AngleAxisd(0.62, Vector3::UnitX()) * Eigen::AngleAxisd(M_PI, Vector3::UnitX())).toRotationMatrix();
    X_CT_ = MakePose(R, Vector3(0, -0.02, 0.75));
    made_.assign(own_.size(), false);
    Vector3 middle = Vector3::Zero();
    for (const auto& X : goal_) middle += X.translation() / static_cast<double>(goal_.size());
    for (auto& X : goal_) X.pretranslate(Vector3(0, 0, 0.015) - middle);
    for (size_t k = 0; k < task_->parts.size(); ++k) {
      const double angle = 0.9 + 2 * M_PI * static_cast<double>(k) / static_cast<double>(task_->parts.size());
      start_.push_back(MakePose(ExpRotation(Vector3(0, 0, 0.7 * static_cast<double>(k))),
                                Vector3(0.21 * std::cos(angle), 0.15 * std::sin(angle), 0.015)));
      // Parts are listed by type in the order in which slots take them.
      int place = 0;
      for (size_t before = 0; before < k; ++before) place += task_->parts[before].type == task_->parts[k].type;
      for (size_t slot = 0; slot < task_->slots.size(); ++slot) {
        if (task_->slots[slot].type == task_->parts[k].type && place-- == 0) slot_of_.push_back(slot);
      }
    }
  }

  void Obey(const OperatorCommand& command) {
    switch (command.kind) {
      case OperatorKind::kStart:
        session_ = command.id;
        clock_ = 0;
        mistake_ = mistake_over_ = false;
        made_.assign(made_.size(), false);
        acts_.clear();
        Say(words_->hello, Priority::kExplanatory);
        phase_ = Phase::kAnnounce;
        Event("session", "start", "operator");
        break;
      case OperatorKind::kPause:
        phase_ = Phase::kPaused;
        break;
      case OperatorKind::kStop:
        acts_.clear();
        status_.reason = "stop";
        phase_ = Phase::kPaused;
        break;
      case OperatorKind::kResume:
        phase_ = Phase::kWait;
        break;
      case OperatorKind::kMarkDone:
      case OperatorKind::kMarkUndone:
        for (size_t c = 0; c < made_.size(); ++c) {
          if (ConnectionAt(c).name == command.argument) made_[c] = command.kind == OperatorKind::kMarkDone;
        }
        break;
      case OperatorKind::kSay:
        Say(command.argument, Priority::kOperator);
        break;
      case OperatorKind::kLanguage:
        words_ = command.argument == "el" ? &kGreek : &kEnglish;
        status_.language = command.argument;
        break;
      default:
        break;
    }
    Event("operator", NameOf(command.kind), command.argument);
    last_command_ = command.id;
  }

  void Tick() {
    utime_ += static_cast<int64_t>(1e6 / kRate);
    if (phase_ != Phase::kPaused && phase_ != Phase::kComplete && session_ != 0) Advance();
    Speak();
    Report();
  }

 private:
  const Connection& ConnectionAt(size_t place) const { return task_->connections[static_cast<size_t>(own_[place])]; }

  int Step() const {
    for (size_t c = 0; c < made_.size(); ++c) {
      if (!made_[c]) return static_cast<int>(c);
    }
    return -1;
  }

  void Advance() {
    clock_ += 1 / kRate;
    const int step = Step();
    const double into = clock_ / step_time_;
    if (step == 1 && !mistake_over_ && into > 0.2) {
      if (!mistake_) {
        Event("wrong", task_->mistakes.empty() ? "unknown" : task_->mistakes[0].name, "held 2 s");
        Say(words_->wrong, Priority::kCorrective);
      }
      mistake_ = into < 0.6;
      mistake_over_ = !mistake_;
      phase_ = mistake_ ? Phase::kWrong : Phase::kWait;
      if (mistake_) return;
    }
    if (into < 1) return;
    clock_ = 0;
    made_[static_cast<size_t>(step)] = true;
    Event("connect", ConnectionAt(static_cast<size_t>(step)).name, "likelihood ratio 12.4");
    const bool over = Step() < 0;
    phase_ = over ? Phase::kComplete : Phase::kWait;
    Say(over ? words_->praise : words_->good, Priority::kCongratulatory);
    if (!over) Announce();
  }

  void Announce() {
    const auto& connection = ConnectionAt(static_cast<size_t>(Step()));
    char text[300];
    std::snprintf(text, sizeof text, words_->step, task_->slots[static_cast<size_t>(connection.slot_a)].name.c_str(),
                  task_->slots[static_cast<size_t>(connection.slot_b)].name.c_str());
    Say(text, Priority::kExplanatory, goal_[static_cast<size_t>(connection.slot_b)].translation());
  }

  void Say(const std::string& text, Priority priority, std::optional<Vector3> point = std::nullopt) {
    RobotCommand command;
    command.id = ++act_id_;
    command.session = session_;
    command.text = text;
    command.priority = priority;
    command.language = status_.language;
    command.point_target = point;
    lesson_.OnCommand(command, Now());
    acts_.push_back(command.id);
  }

  /// Every act takes 1.5 s.
  void Speak() {
    if (acts_.empty()) {
      status_.speaking = false;
    } else if (speaking_since_ < 0 || !status_.speaking) {
      speaking_since_ = utime_;
      status_.speaking = true;
      status_.command_id = acts_.front();
      status_.state = ActState::kStarted;
    } else if (utime_ - speaking_since_ > 1'500'000) {
      status_.state = ActState::kDone;
      status_.speaking = false;
      acts_.pop_front();
    }
    status_.session = session_;
    status_.connected = true;
    status_.back_end = "virtual";
    lesson_.OnStatus(status_, Now());
  }

  void Event(const std::string& kind, const std::string& subject, const std::string& reason) {
    GuidanceEvent event{++event_id_, utime_, utime_ - 400'000, kind, subject, -1, -1, 0.97, reason};
    if (kind == "connect" || kind == "wrong") event.part_a = 0, event.part_b = 1;
    events_.push_back(event);
    while (events_.size() > 8) events_.pop_front();
  }

  void Report() {
    AssemblyState state;
    state.utime = utime_;
    state.session = session_;
    state.task = task_->name;
    state.phase = session_ ? phase_ : Phase::kIntroduction;
    state.step = session_ && Step() >= 0 ? own_[static_cast<size_t>(Step())] : -1;
    state.required = static_cast<int>(made_.size());
    for (size_t c = 0; c < made_.size(); ++c) {
      const auto& connection = ConnectionAt(c);
      state.made += made_[c];
      ConnectionState one{own_[c], -1, -1, made_[c] ? 0.99 : 0.02,
                          made_[c] ? ConnectionState::State::kMade : ConnectionState::State::kOpen};
      for (size_t k = 0; made_[c] && k < slot_of_.size(); ++k) {
        if (slot_of_[k] == static_cast<size_t>(connection.slot_a)) one.part_a = static_cast<int>(k);
        if (slot_of_[k] == static_cast<size_t>(connection.slot_b)) one.part_b = static_cast<int>(k);
      }
      state.connections.push_back(one);
    }
    if (mistake_) {
      const int which = task_->mistakes.empty() ? kUnknownContact : -1;
      state.connections.push_back({which, 0, 1, 0.9, ConnectionState::State::kMade});
    }
    state.events.assign(events_.begin(), events_.end());
    lesson_.OnState(state, Now());
    ReportPoses();
    ReportHealth();
  }

  void ReportPoses() {
    PartPoses poses;
    poses.utime = utime_;
    poses.X_TC = X_CT_.inverse();
    poses.table_found = true;
    for (size_t k = 0; k < task_->parts.size(); ++k) {
      PartEstimate part;
      part.X_TP = Pose(start_[k]);
      bool joined = false, next = false;
      for (size_t c = 0; c < made_.size(); ++c) {
        const auto& connection = ConnectionAt(c);
        const bool mine = slot_of_[k] == static_cast<size_t>(connection.slot_a) ||
                          slot_of_[k] == static_cast<size_t>(connection.slot_b);
        joined = joined || (mine && made_[c]);
        next = next || (mine && static_cast<int>(c) == Step());
      }
      if (joined || (next && session_)) {
        const double u = joined ? 1 : std::min(1.0, 1.2 * clock_ / step_time_);
        const Pose& to = goal_[slot_of_[k]];
        const Vector6 way = Difference(start_[k], to);
        part.X_TP = Perturb(start_[k], Vector6(u * way));
        part.X_TP.translation().z() += 0.05 * std::sin(M_PI * u);
        part.status = u > 0.4 && u < 0.6 ? PartStatus::kOccluded : PartStatus::kTracked;
      } else {
        part.status = PartStatus::kTracked;
      }
      part.visible_fraction = part.confidence = 0.9;
      poses.parts.push_back(part);
    }
    poses.foreign.push_back({Vector3(0.05, -0.2, 0.06), 0.05, Vector3::Zero()});
    lesson_.OnPicture({utime_, camera_, Draw(poses)});
    lesson_.OnPoses(poses);
  }

  std::vector<uint8_t> Draw(const PartPoses& poses) {
    cv::Mat image(480, 640, CV_8UC3, cv::Scalar(150, 178, 196));
    cv::rectangle(image, {0, 0}, {640, 90}, cv::Scalar(120, 130, 134), cv::FILLED);
    for (size_t k = 0; k < poses.parts.size(); ++k) {
      const auto& type = task_->types[static_cast<size_t>(task_->parts[k].type)];
      cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar((type.hsv.low[0] + type.hsv.high[0]) / 2, 190, 150)), bgr;
      cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
      for (const auto& polygon : Silhouette(type.mesh, X_CT_ * poses.parts[k].X_TP, camera_)) {
        std::vector<cv::Point> corners;
        for (const auto& p : polygon) corners.emplace_back(cvRound(p.x()), cvRound(p.y()));
        cv::fillPoly(image, std::vector{corners}, cv::Scalar(bgr.at<cv::Vec3b>(0)));
      }
    }
    return EncodeJpeg(image, 90);
  }

  void ReportHealth() {
    for (const char* name : {"capture", "detector", "pose-filter", "assembly-reasoner", "robot-bridge"}) {
      ServiceReport report;
      report.service = name;
      report.host = "rehearsal";
      report.pid = 1000;
      report.state = ServiceReport::State::kOk;
      report.rate = kRate;
      report.latency_p50_ms = 22;
      report.latency_p99_ms = 41;
      report.received = utime_ / 66'000;
      report.answered = report.received;
      report.resident_bytes = 48'000'000;
      report.last_operator_command = last_command_;
      report.seen = Now();
      lesson_.OnHealth(report);
    }
  }

  std::shared_ptr<const Task> task_;
  Lesson& lesson_;
  double step_time_;
  std::vector<int> own_;  // connections of the task's own variant
  std::vector<Pose> goal_, start_;
  std::vector<size_t> slot_of_;
  CameraModel camera_;
  Pose X_CT_;
  std::vector<bool> made_;
  const Wording* words_ = &kEnglish;
  RobotStatus status_;
  std::deque<int64_t> acts_;
  std::deque<GuidanceEvent> events_;
  int64_t utime_ = 0, session_ = 0, act_id_ = 0, event_id_ = 0, last_command_ = 0, speaking_since_ = -1;
  double clock_ = 0;
  bool mistake_ = false, mistake_over_ = false;
  Phase phase_ = Phase::kIntroduction;
};

/// Below the camera, facing the child.
Pose RobotSeat() { return MakePose(ExpRotation(Vector3(0, 0, M_PI / 2)), Vector3(0, -0.5, 0.08)); }

int Main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: page-rehearsal TASK.yaml [PORT [SECONDS_PER_STEP [PAGE_FOLDER]]]\n");
    return 2;
  }
  const auto task = std::make_shared<const Task>(LoadTask(argv[1]));
  Lesson lesson({});
  lesson.OnTask(MakeTaskView(task, 1));
  CommandOutbox outbox({}, "REHEARSAL");
  AnnotationBook annotations("");
  PageServer::Options options;
  options.port = argc > 2 ? std::atoi(argv[2]) : 0;
  options.folder = argc > 4 ? argv[4] : "";
  const PageServer server(options, {&lesson, &outbox, &annotations, "REHEARSAL",
                                    [&] {
                                      return StationFacts{{task->file.stem()}, {"en", "el"}, RobotSeat()};
                                    },
                                    [](const Annotation&) {}, [] {}});
  std::printf("%s\n", server.Url().c_str());
  std::fflush(stdout);
  std::signal(SIGTERM, [](int) { ended = true; });
  std::signal(SIGINT, [](int) { ended = true; });
  Rehearsal rehearsal(task, lesson, argc > 3 ? std::atof(argv[3]) : 4);
  while (!ended) {
    for (const auto& command : outbox.Due(Now())) {
      rehearsal.Obey(command);
      for (const auto& service : Concerned(command.kind)) outbox.Echo(service, command.id);
    }
    rehearsal.Tick();
    std::this_thread::sleep_for(std::chrono::milliseconds(static_cast<int>(1000 / kRate)));
  }
  return 0;
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  try {
    return coach::Main(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "page-rehearsal: %s\n", e.what());
    return 1;
  }
}
