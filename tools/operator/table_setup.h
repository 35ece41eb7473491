// What the set-up pages ask for and decide: camera, task, colours, robot. Reads and writes the station file.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/assembly/task.h"
#include "common/configuration/station.h"
#include "common/imaging/frame.h"
#include "tools/operator/lesson.h"

namespace coach {

/// Thread safe. JSON in, JSON out; the other side is page/setup.js.
class TableSetup {
 public:
  struct Sources {
    std::filesystem::path file;                   ///< station file; empty: nothing can be saved
    std::filesystem::path state_folder;           ///< written to a station file that names none
    std::filesystem::path shipped_tasks;          ///< offered beside the station's own
    std::function<std::optional<Frame>()> frame;  ///< the newest colour and depth
    const Lesson* lesson = nullptr;
  };
  explicit TableSetup(Sources sources);

  /// The station file as it is now; defaults while it can't be read.
  Station station() const;

  /// Says with which settings a service runs. @param yaml the station file's text as the service read it
  void OnConfiguration(const std::string& service, const std::string& yaml);

  /// {file, problem, camera: {...CameraCheck}, task: {choice, problem}, tasks: [...], colours: [{name, types, range,
  /// own, table_share, part_share, overlaps}], robot: {...}, old: [services that run with older settings]}
  std::string Status() const;

  /// {x, y, colour}: suggests the colour's range from the part or region that was clicked (px).
  /// -> {range, pixels, part, table_share, overlaps} @throws std::invalid_argument no_task, no_picture, not_on_table or
  /// few_pixels
  std::string SuggestColour(const std::string& request) const;

  /// {near, far, ahead, height}: part indices and metres; the robot's seat by SeatFromMarks.
  /// -> {position, roll_pitch_yaw} @throws std::invalid_argument unseen or close
  std::string SuggestSeat(const std::string& request) const;

  /// {task?, colours?: {name: range or null}, robot?: {back_end?, volume?, position?, roll_pitch_yaw?, url?}}: checks
  /// the settings as the services will and saves them. -> Status()
  /// @throws ConfigurationError naming what can't be, std::runtime_error if the file can't be written
  std::string Save(const std::string& request);

 private:
  std::shared_ptr<const Task> TaskOf(const Station& station, std::string& problem) const;
  std::filesystem::path FileOfTask(const Station& station, const std::string& name) const;

  const Sources sources_;
  mutable std::mutex mutex_;
  std::map<std::string, std::string> running_;  // service: the settings it runs with
  std::mutex saving_;
  mutable std::filesystem::path task_file_;  // of task_
  mutable std::filesystem::file_time_type task_time_{};
  mutable std::shared_ptr<const Task> task_;
};

/// The tasks that come with the program: in share/coach/tasks, or in deploy/tasks of the folder it was built in. Empty
/// if there are none.
std::filesystem::path ShippedTasks();

}  // namespace coach
