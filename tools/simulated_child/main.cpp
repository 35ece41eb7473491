// coach-simulated-child: a simulated child at a table as a camera on the bus. It hears the robot and does as told, or
// not, so that a lesson closes its loop without camera, robot or child. It takes the place of coach-capture.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "common/assembly/task_file.h"
#include "common/bus/image_messages.h"
#include "common/bus/messages.h"
#include "common/bus/service_main.h"
#include "tools/simulator/live_lesson.h"

namespace coach {
namespace {

constexpr int kJpegQuality = 85;

struct Arguments {
  ScenarioOptions scenario;
  std::string temper = "listens";
};

class SimulatedChild {
 public:
  SimulatedChild(const NodeOptions& node, const Task& task, const Arguments& arguments)
      : node_(node),
        lesson_(MakeScenario(task, arguments.scenario), {.temper = TemperByName(arguments.temper)}),
        simulator_(lesson_.scenario().stage, arguments.scenario.seed),
        period_(1 / arguments.scenario.fps) {
    node_.Subscribe<robot_command_t>([this](const robot_command_t& m) { Hear(m); });
    node_.Subscribe<assembly_state_t>([this](const assembly_state_t& m) { step_ = m.step; });
  }

  void Run() {
    start_ = Clock::now();
    node_.Run([this] { Step(); });
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Commands are repeated until they are acknowledged: each is heard once.
  void Hear(const robot_command_t& m) {
    const std::pair<int64_t, int64_t> command{m.session, m.id};
    if (command <= last_command_ || m.kind != robot_command_t::ACT) return;
    last_command_ = command;
    lesson_.Hear(m.phrase_key, step_);
  }

  void Step() {
    const double now = std::chrono::duration<double>(Clock::now() - start_).count();
    if (now < next_) return;
    next_ = std::max(next_ + period_, now - period_);
    lesson_.Advance(now);
    Frame frame = simulator_.Render(lesson_.performance(), lesson_.scenario().camera, now, nullptr);
    frame.received_utime = node_.Now();
    node_.Received();
    node_.Publish(ToColourMessage(frame, ColourEncoding::kJpeg, kJpegQuality));
    node_.Publish(ToDepthMessage(frame, DepthEncoding::kZstd));
    node_.Answered(frame.received_utime);
    node_.SetState(service_health_t::OK, "");
    if (lesson_.complete() && !said_complete_) {
      said_complete_ = true;
      spdlog::info("the structure is complete after {:.1f} s", now);
    }
  }

  Node node_;
  LiveLesson lesson_;
  Simulator simulator_;
  double period_;
  double next_ = 0;  // s
  int step_ = -1;
  std::pair<int64_t, int64_t> last_command_{0, 0};  // session, id
  bool said_complete_ = false;
  Clock::time_point start_;
};

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  coach::Arguments arguments;
  arguments.scenario.name = "ready";
  arguments.scenario.fps = 10;
  const auto add_options = [&](CLI::App& app) {
    app.add_option("--temper", arguments.temper, "listens, errs or never-listens")
        ->check(CLI::IsMember({"listens", "errs", "never-listens"}));
    app.add_option("--seed", arguments.scenario.seed, "room and child");
    app.add_option("--fps", arguments.scenario.fps, "Hz")->check(CLI::Range(1.0, 60.0));
    app.add_option("--style", arguments.scenario.style, "slow, normal, hasty or hesitant");
    app.add_option("--width", arguments.scenario.width, "px")->check(CLI::Range(160, 1280));
    app.add_option("--height", arguments.scenario.height, "px")->check(CLI::Range(120, 960));
  };
  return coach::ServiceMain(argc, argv, "simulated-child", "A simulated child before a simulated camera.", add_options,
                            [&](coach::ServiceContext& context) {
                              context.node.service = "capture";
                              context.node.period_ms = 5;
                              const coach::Task task = coach::LoadTask(context.station.task);
                              coach::SimulatedChild(context.node, task, arguments).Run();
                            });
}
