// coach-operator: the teacher's page.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <coach/annotation_t.hpp>
#include <mutex>

#include "common/bus/image_messages.h"
#include "common/bus/messages.h"
#include "common/bus/process_facts.h"
#include "common/bus/service_main.h"
#include "common/configuration/task_choice.h"
#include "common/imaging/image_codec.h"
#include "tools/operator/page_json.h"
#include "tools/operator/page_options.h"

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

/// The page's place on the bus. Everything but the annotations' queue belongs to the node's thread.
class OperatorService {
 public:
  OperatorService(const ServiceContext& context, const PageOptions& options)
      : station_(context.station),
        lesson_(options.lesson),
        outbox_({}, context.station.name),
        annotations_(options.annotations),
        node_(WithPeriod(context.node)) {
    if (annotations_.unreadable_lines() > 0) {
      spdlog::warn("{}: {} lines can't be read", options.annotations.string(), annotations_.unreadable_lines());
    }
    if (!station_.task.empty()) UseTask(station_.task, "");
    Subscribe();
    server_.emplace(options.server,
                    PageServer::Sources{&lesson_, &outbox_, &annotations_, station_.name,
                                        [this, languages = options.languages] {
                                          return Choices{TaskNames(station_), languages};
                                        },
                                        [this](const Annotation& a) { Queue(a); }, [this] { node_.Wake(); }});
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
    });
    node_.SubscribeNewest<part_poses_t>([this](const part_poses_t& m) {
      lesson_.OnPoses(FromMessage(m));
      node_.Answered(m.received_utime);
    });
    node_.Subscribe<assembly_state_t>([this](const auto& m) { lesson_.OnState(FromMessage(m), WallTime()); });
    node_.Subscribe<guidance_event_t>([this](const auto& m) { lesson_.OnEvent(FromMessage(m)); });
    node_.Subscribe<task_t>([this](const auto& m) {
      const auto known = lesson_.task();
      if (!known || known->sha256 != m.sha256) UseTask(m.file, m.sha256);
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

  void UseTask(const std::filesystem::path& file, const std::string& sha256) {
    const auto view = LoadTaskView(file, sha256, ++task_revision_);
    if (!view->problem.empty()) spdlog::warn("{}", view->problem);
    lesson_.OnTask(view);
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
      if (command.kind == OperatorKind::kStop && robot_bus_) robot_bus_->Publish(message);
    }
    std::vector<annotation_t> annotations;
    {
      const std::lock_guard lock(queue_mutex_);
      annotations.swap(queue_);
    }
    for (const auto& annotation : annotations) node_.Publish(annotation);
  }

  const Station station_;
  Lesson lesson_;
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
