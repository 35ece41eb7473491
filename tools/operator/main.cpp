// coach-operator: the teacher's page.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <coach/annotation_t.hpp>
#include <coach/config_t.hpp>
#include <cstdlib>
#include <mutex>

#include "common/bus/image_messages.h"
#include "common/bus/messages.h"
#include "common/bus/process_facts.h"
#include "common/bus/service_main.h"
#include "common/bus/task_follower.h"
#include "common/configuration/task_choice.h"
#include "common/imaging/image_codec.h"
#include "services/robot_bridge/robot_options.h"
#include "tools/operator/page_json.h"
#include "tools/operator/page_options.h"
#include "tools/operator/seat_calibration.h"
#include "tools/operator/table_setup.h"
#include "tools/task/task_workshop.h"

namespace coach {
namespace {

constexpr int kPeriodMs = 50;     // a command waits this long at most
constexpr int kJpegQuality = 85;  // where the camera's pictures come unpacked

Picture PictureOf(const color_image_t& message) {
  Picture picture{message.utime, FromMessage(message.intrinsics), {}};
  if (message.encoding == color_image_t::ENCODING_JPEG) {
    picture.jpeg = message.data;
  } else {
    picture.jpeg = EncodeJpeg(FromMessage(message).colour, kJpegQuality);
  }
  return picture;
}

ServiceReport ReportOf(const service_health_t& m) {
  ServiceReport report;
  report.service = m.service;
  report.host = m.host;
  report.message = m.message;
  report.pid = m.pid;
  report.state = static_cast<ServiceReport::State>(std::clamp<int>(m.state, 0, 3));
  report.rate = m.rate;
  report.latency_p50_ms = m.latency_p50_ms;
  report.latency_p99_ms = m.latency_p99_ms;
  report.work_p50_ms = m.work_p50_ms;
  report.work_p99_ms = m.work_p99_ms;
  report.received = m.received;
  report.answered = m.answered;
  report.dropped = m.dropped;
  report.socket_drops = m.socket_drops;
  report.decode_errors = m.decode_errors;
  report.last_operator_command = m.last_operator_command;
  report.resident_bytes = m.resident_bytes;
  report.seen = WallTime();
  return report;
}

annotation_t MessageOf(const Annotation& a) {
  annotation_t message;
  message.utime = a.utime;
  message.id = a.id;
  message.annotator = a.annotator;
  message.kind = a.kind;
  message.subject = a.subject;
  message.value = a.value;
  message.replaces_id = a.replaces_id;
  return message;
}

/// The newest pictures as they came; decoded only when somebody asks.
class NewestFrame {
 public:
  void OnColour(const color_image_t& message) {
    const std::lock_guard lock(mutex_);
    colour_ = message;
    seen_ = SteadyTime();
  }
  void OnDepth(const depth_image_t& message) {
    const std::lock_guard lock(mutex_);
    depth_ = message;
  }
  /// Empty if no picture came within the last three seconds. Colour and depth may be a frame apart.
  std::optional<Frame> Read() const {
    color_image_t colour;
    depth_image_t depth;
    {
      const std::lock_guard lock(mutex_);
      if (seen_ == 0 || SteadyTime() - seen_ > 3'000'000) return std::nullopt;
      colour = colour_;
      depth = depth_;
    }
    Frame frame = FromMessage(colour);
    if (depth.data_size == 0) return frame;
    const Frame other = FromMessage(depth);
    frame.depth = other.depth;
    frame.metres_per_unit = other.metres_per_unit;
    return frame;
  }

 private:
  mutable std::mutex mutex_;
  color_image_t colour_{};
  depth_image_t depth_{};
  int64_t seen_ = 0;
};

/// For a station file that names none: what systemd gives the unit, else a folder beside the file.
std::filesystem::path DefaultStateFolder(const Station& station) {
  if (const char* given = std::getenv("STATE_DIRECTORY")) return given;
  return station.file.empty() ? std::filesystem::path()
                              : std::filesystem::absolute(station.file).parent_path() / "state";
}

/// The usual one while the station file's can't be read.
Pose SeatOf(const Station& station) {
  try {
    return ReadRobotOptions(station.Section("robot")).conductor.X_TR;
  } catch (const ConfigurationError&) {
    return DefaultRobotPose();
  }
}

/// The page's place on the bus. Everything but the annotations' queue belongs to the node's thread.
class OperatorService {
 public:
  OperatorService(const ServiceContext& context, const PageOptions& options)
      : station_(context.station),
        lesson_(options.lesson),
        setup_(
            {station_.file, DefaultStateFolder(station_), ShippedTasks(), [this] { return newest_.Read(); }, &lesson_}),
        outbox_({}, context.station.name),
        annotations_(options.annotations),
        node_(WithPeriod(context.node)) {
    if (annotations_.unreadable_lines() > 0) {
      spdlog::warn("{}: {} lines can't be read", options.annotations.string(), annotations_.unreadable_lines());
    }
    if (!station_.task.empty()) lesson_.OnTask(LoadTaskView(station_.task, ++task_revision_));
    Subscribe();
    server_.emplace(options.server,
                    PageServer::Sources{&lesson_, &outbox_, &annotations_, station_.name,
                                        [this, languages = options.languages] {
                                          const Station now = setup_.station();
                                          return StationFacts{TaskNames(now), languages, SeatOf(now)};
                                        },
                                        [this](const Annotation& a) { Queue(a); }, [this] { node_.Wake(); }, Routes()});
    spdlog::info("the page is at {}", server_->Url());
    node_.SetState(service_health_t::OK, server_->Url());
  }

  void Run() {
    node_.Run([this] { Step(); });
  }

 private:
  static NodeOptions WithPeriod(NodeOptions options) {
    options.period_ms = kPeriodMs;
    return options;
  }

  void Subscribe() {
    node_.SubscribeNewest<color_image_t>([this](const color_image_t& m) {
      node_.Received();
      lesson_.OnPicture(PictureOf(m));
      newest_.OnColour(m);
    });
    node_.SubscribeNewest<depth_image_t>([this](const depth_image_t& m) { newest_.OnDepth(m); });
    node_.Subscribe<config_t>([this](const config_t& m) { setup_.OnConfiguration(m.service, m.yaml); });
    node_.SubscribeNewest<part_poses_t>([this](const part_poses_t& m) {
      const PartPoses poses = FromMessage(m);
      lesson_.OnPoses(poses);
      workshop_.OnPoses(poses);
      calibration_.OnPoses(poses);
      node_.Answered(m.received_utime);
    });
    node_.Subscribe<assembly_state_t>([this](const auto& m) { lesson_.OnState(FromMessage(m), WallTime()); });
    node_.Subscribe<guidance_event_t>([this](const auto& m) { lesson_.OnEvent(FromMessage(m)); });
    node_.Subscribe<task_t>([this](const auto& m) {
      const auto known = lesson_.task();
      if (!known || known->sha256 != m.sha256) FollowTask(m);
    });
    node_.Subscribe<robot_command_t>([this](const auto& m) { lesson_.OnCommand(FromMessage(m), WallTime()); });
    const auto on_status = [this](const robot_status_t& m) { lesson_.OnStatus(FromMessage(m), WallTime()); };
    const auto on_health = [this](const service_health_t& m) {
      lesson_.OnHealth(ReportOf(m));
      outbox_.Echo(m.service, m.last_operator_command);
    };
    node_.Subscribe<robot_status_t>(on_status);
    node_.Subscribe<service_health_t>(on_health);
    if (station_.robot_url != station_.table_url) {
      robot_bus_ = &node_.Join(station_.robot_url);
      robot_bus_->Subscribe<robot_status_t>(on_status);
      robot_bus_->Subscribe<service_health_t>(on_health);
    }
  }

  void FollowTask(const task_t& message) {
    try {
      lesson_.OnTask(MakeTaskView(std::make_shared<Task>(AnnouncedTask(setup_.station(), message)), ++task_revision_));
    } catch (const std::exception& e) {
      spdlog::warn("{}", e.what());
      lesson_.OnTask(UnusableTask(message.name, message.sha256, e.what(), ++task_revision_));
    }
  }

  std::vector<PageServer::Route> Routes() {
    using Request = PageServer::Request;
    using Answer = PageServer::Answer;
    return {
        {"/api/setup", false, [this](const Request&) { return Answer{setup_.Status()}; }},
        {"/api/setup/colour", true, [this](const Request& r) { return Answer{setup_.SuggestColour(r.body)}; }},
        {"/api/setup/seat", true, [this](const Request& r) { return Answer{setup_.SuggestSeat(r.body)}; }},
        {"/api/setup/calibration", false, [this](const Request&) { return Answer{calibration_.Status()}; }},
        {"/api/setup/calibrate", true, [this](const Request& r) { return Answer{StartCalibration(r.body)}; }},
        {"/api/setup/save", true, [this](const Request& r) { return Answer{setup_.Save(r.body)}; }},
        {"/api/task/mesh", true, [this](const Request& r) { return Answer{workshop_.AddMesh(r.name, r.body)}; },
         TaskWorkshop::kLargestFile},
        {"/api/task/make", true, [this](const Request& r) { return Answer{workshop_.Make(r.body, TaskOnTable())}; }},
        {"/api/task/book", false,
         [this](const Request& r) {
           return Answer{BookOf(TaskFileNamed(setup_.station(), r.name)), "text/html; charset=utf-8"};
         }},
    };
  }

  std::string StartCalibration(const std::string& request) {
    const AssemblyState state = lesson_.Read(0).state;
    const bool rests =
        state.phase == Phase::kIntroduction || state.phase == Phase::kPaused || state.phase == Phase::kComplete;
    const RobotOptions options = ReadRobotOptions(setup_.station().Section("robot"));
    return calibration_.Start(request, options.nao, state.session != 0 && !rests);
  }

  std::shared_ptr<const Task> TaskOnTable() const {
    const auto view = lesson_.task();
    return view ? view->task : nullptr;
  }

  void Queue(const Annotation& annotation) {
    const std::lock_guard lock(queue_mutex_);
    queue_.push_back(MessageOf(annotation));
    node_.Wake();
  }

  void Step() {
    for (const auto& command : outbox_.Due(WallTime())) {
      const auto message = ToMessage(command);
      node_.Publish(message);
      if (command.kind != OperatorKind::kStop) continue;
      calibration_.Stop();
      if (robot_bus_) robot_bus_->Publish(message);
    }
    calibration_.Step(SteadyTime());
    std::vector<annotation_t> annotations;
    {
      const std::lock_guard lock(queue_mutex_);
      annotations.swap(queue_);
    }
    for (const auto& annotation : annotations) node_.Publish(annotation);
  }

  const Station station_;
  Lesson lesson_;
  NewestFrame newest_;
  TableSetup setup_;
  TaskWorkshop workshop_{[this] { return OwnTaskFolder(setup_.station()); }};
  SeatCalibration calibration_{[](const NaoOptions& options) { return std::make_unique<NaoRobot>(options); }};
  CommandOutbox outbox_;
  AnnotationBook annotations_;
  Node node_;
  Bus* robot_bus_ = nullptr;
  int64_t task_revision_ = 0;
  std::mutex queue_mutex_;
  std::vector<annotation_t> queue_;
  std::optional<PageServer> server_;  // last: its threads use everything above
};

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  using namespace coach;
  std::string address, folder;
  int port = -1;
  return ServiceMain(
      argc, argv, "operator", "The teacher's page: picture, assembly, robot's words, health and controls in a browser",
      [&](CLI::App& app) {
        app.add_option("--address", address,
                       "address to listen on (default: the station file's, else this computer only)");
        app.add_option("--port", port, "port to listen on; 0: any (default: the station file's, else 8080)");
        app.add_option("--page-folder", folder, "the page's files, instead of those built in");
      },
      [&](ServiceContext& context) {
        PageOptions options = ReadPageOptions(context.station);
        if (!address.empty()) options.server.address = address;
        if (port >= 0) options.server.port = port;
        options.server.folder = folder;
        OperatorService(context, options).Run();
      });
}
