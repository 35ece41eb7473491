// Everything the page knows about the lesson: filled by the bus, read by any number of pages at once.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/assembly_state.h"
#include "common/assembly/part_poses.h"
#include "common/assembly/robot_act.h"
#include "common/assembly/task.h"
#include "common/geometry/camera.h"
#include "tools/operator/outline.h"

namespace coach {

/// The colour picture of one frame, as it came from the camera.
struct Picture {
  int64_t utime = 0;
  CameraModel camera;
  std::vector<uint8_t> jpeg;
};

/// One moment of the table: poses, their outlines, and the picture they belong to. Never changed after it is made.
struct LiveView {
  int64_t number = 0;                          ///< counts views from 1
  PartPoses poses;                             ///< empty `parts` where no tracker answers
  std::vector<std::vector<Polygon>> outlines;  ///< px; index = part; empty for a part that is not drawn
  std::shared_ptr<const Picture> picture;      ///< null if no camera answers
};

/// What one service says of itself.
struct ServiceReport {
  enum class State { kStarting = 0, kOk = 1, kDegraded = 2, kFailed = 3 };
  std::string service, host, message;
  int pid = 0;
  State state = State::kStarting;
  double rate = 0;                                ///< answered inputs a second
  double latency_p50_ms = 0, latency_p99_ms = 0;  ///< capture to publication
  double work_p50_ms = 0, work_p99_ms = 0;
  int64_t received = 0, answered = 0, dropped = 0, socket_drops = 0, decode_errors = 0;
  int64_t last_operator_command = 0;
  int64_t resident_bytes = 0;
  int64_t seen = 0;  ///< us, this host's clock, when it arrived
};

/// Something the robot was told to do, and what became of it.
struct SpokenAct {
  RobotCommand command;
  ActState state = ActState::kNone;
  std::string reason;
  int64_t seen = 0;  ///< us, this host's clock, when the command was first seen
};

/// The task with what the pages need to draw it. Never changed after it is made.
struct TaskView {
  int64_t revision = 0;  ///< grows by one a task that is loaded
  std::string name;      ///< as the task file calls it
  std::string choice;    ///< as the page's list calls it: the file's name without .yaml
  std::string sha256;
  std::string problem;  ///< why the task file can't be read; `task` is null then
  std::shared_ptr<const Task> task;
  std::string json;                  ///< names, meshes and plan, ready to be sent
  std::vector<TriangleMesh> meshes;  ///< simplified for drawing; index = type
};

/// Thread safe. Times `now` are us since 1970 of this host; utime is the data's time.
class Lesson {
 public:
  struct Options {
    double picture_rate = 15;  ///< Hz; views made at most
    int64_t pose_patience_us =
        1'000'000;             ///< pictures without poses are shown when none came for so long (data's time)
    size_t max_events = 2000;  ///< of the timeline
    size_t max_acts = 40;      ///< of the robot's words
  };
  explicit Lesson(const Options& options);

  void OnTask(std::shared_ptr<const TaskView> task);
  void OnPicture(Picture picture);
  void OnPoses(const PartPoses& poses);
  void OnState(const AssemblyState& state, int64_t now);
  void OnEvent(const GuidanceEvent& event);
  void OnCommand(const RobotCommand& command, int64_t now);
  void OnStatus(const RobotStatus& status, int64_t now);
  void OnHealth(const ServiceReport& report);
  /// Something that is no message changed what the pages show (a command, an annotation).
  void Touch();

  /// A copy of all but pictures and task.
  struct Snapshot {
    int64_t revision = 0;       ///< grows with every change
    int64_t task_revision = 0;  ///< 0: no task seen yet
    std::string task_name, task_choice, task_problem;
    AssemblyState state;
    int64_t state_seen = 0;  ///< us, now; 0 never
    RobotStatus robot;
    int64_t robot_seen = 0;
    std::vector<SpokenAct> acts;  ///< oldest first
    std::vector<ServiceReport> services;
    std::vector<GuidanceEvent> events;  ///< those with id > `after_event`, oldest first
    int64_t data_utime = 0;             ///< us, of the newest frame or poses
  };
  Snapshot Read(int64_t after_event) const;
  std::shared_ptr<const TaskView> task() const;

  /// Waits until the snapshot's revision is above `revision`, for at most `timeout_ms`. @return whether it is.
  bool WaitForChange(int64_t revision, int timeout_ms) const;
  /// Waits for a view newer than `number`. Null if none came within `timeout_ms`.
  std::shared_ptr<const LiveView> WaitForView(int64_t number, int timeout_ms) const;
  std::shared_ptr<const LiveView> view() const;
  /// Wakes every waiting page for the end of the program; nobody waits from now on.
  void Close();

 private:
  void Changed();
  void Show(std::shared_ptr<const Picture> picture, const PartPoses* poses);
  void AddEvent(const GuidanceEvent& event);

  const Options options_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_, viewed_;
  bool closed_ = false;
  int64_t revision_ = 1;
  std::shared_ptr<const TaskView> task_;
  AssemblyState state_;
  int64_t state_seen_ = 0;
  RobotStatus robot_;
  int64_t robot_seen_ = 0;
  std::deque<SpokenAct> acts_;
  std::map<std::string, ServiceReport> services_;
  std::map<int64_t, GuidanceEvent> events_;             // by id
  std::deque<std::shared_ptr<const Picture>> waiting_;  // pictures whose poses have not come yet, oldest first
  std::shared_ptr<const LiveView> view_;
  int64_t shown_utime_ = 0, poses_utime_ = 0;  // us, data's time
};

}  // namespace coach
