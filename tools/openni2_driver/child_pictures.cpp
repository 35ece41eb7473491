#include <algorithm>

#include "common/assembly/task_file.h"
#include "common/bus/bus.h"
#include "common/bus/messages.h"
#include "common/configuration/station.h"
#include "tools/openni2_driver/picture_source.h"
#include "tools/simulator/live_lesson.h"
#include "tools/simulator/truth_files.h"

namespace coach {
namespace {

ScenarioOptions RoomOptionsOf(const ChildOptions& options) {
  ScenarioOptions scenario;
  scenario.name = "ready";
  scenario.seed = options.seed;
  scenario.fps = options.fps;
  return scenario;
}

class ChildPictures final : public PictureSource {
 public:
  ChildPictures(const ChildOptions& options, const Station& station)
      : options_(options),
        bus_(station.table_url, station.name),
        lesson_(MakeScenario(LoadTask(station.task), RoomOptionsOf(options)), {.temper = TemperByName(options.temper)}),
        simulator_(lesson_.scenario().stage, options.seed) {
    bus_.Subscribe<robot_command_t>([this](const robot_command_t& m) { Hear(m); });
    bus_.Subscribe<assembly_state_t>([this](const assembly_state_t& m) { step_ = m.step; });
  }
  ~ChildPictures() override {
    if (!options_.truth.empty()) WriteTrueEvents();
  }

  const CameraModel& camera() const override { return simulator_.stage().camera; }
  double fps() const override { return options_.fps; }

  Frame At(int count) override {
    bus_.Handle(0);
    now_ = count / options_.fps;
    lesson_.Advance(now_);
    return simulator_.Render(lesson_.performance(), lesson_.scenario().camera, now_, nullptr);
  }

 private:
  /// Commands are repeated until they are acknowledged: each is heard once.
  void Hear(const robot_command_t& m) {
    const std::pair<int64_t, int64_t> command{m.session, m.id};
    if (command <= last_command_ || m.kind != robot_command_t::ACT) return;
    last_command_ = command;
    lesson_.Hear(m.phrase_key, step_);
  }

  void WriteTrueEvents() const {
    Scenario seen = lesson_.scenario();
    seen.frame_times = {now_};
    try {
      std::filesystem::create_directories(options_.truth);
      WriteEvents(options_.truth, seen, {});
    } catch (const std::exception&) {
      // The lesson is over, nobody is there to be told; who looks for the file will miss it.
    }
  }

  ChildOptions options_;
  Bus bus_;
  LiveLesson lesson_;
  Simulator simulator_;
  int step_ = -1;
  std::pair<int64_t, int64_t> last_command_{0, 0};  // session, id
  double now_ = 0;                                  // s
};

}  // namespace

std::unique_ptr<PictureSource> OpenChildPictures(const ChildOptions& options) {
  return std::make_unique<ChildPictures>(options, ReadStation(options.station));
}

}  // namespace coach
