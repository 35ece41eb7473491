#include "services/robot_bridge/virtual_robot.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "services/robot_bridge/speech_text.h"

namespace coach {
namespace {

using nlohmann::json;

constexpr size_t kMostTriangles = 1500;  // a finer mesh is shown as its box
constexpr double kPause = 0.25;          // s between two sentences

double Round(double value) { return std::round(value * 1e4) / 1e4; }

/// Names come from files: bytes that are no UTF-8 must not stop the page.
std::string Dump(const json& event) { return event.dump(-1, ' ', false, json::error_handler_t::replace); }

json ListOf(const Vector3& p) { return {Round(p.x()), Round(p.y()), Round(p.z())}; }

json QuaternionOf(const Matrix3& R) {
  const Eigen::Quaterniond q(R);
  return {Round(q.w()), Round(q.x()), Round(q.y()), Round(q.z())};
}

TriangleMesh BoxOf(const TriangleMesh& mesh) {
  const MeshExtent extent = Extent(mesh);
  TriangleMesh box;
  for (int i = 0; i < 8; ++i) {
    box.vertices.emplace_back((i & 1) != 0 ? extent.high.x() : extent.low.x(),
                              (i & 2) != 0 ? extent.high.y() : extent.low.y(),
                              (i & 4) != 0 ? extent.high.z() : extent.low.z());
  }
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return box;
}

json ShapeOf(const TriangleMesh& mesh) {
  const TriangleMesh& shape = mesh.triangles.size() > kMostTriangles ? BoxOf(mesh) : mesh;
  json vertices = json::array(), triangles = json::array();
  for (const Vector3& vertex : shape.vertices) vertices.push_back(ListOf(vertex));
  for (const auto& triangle : shape.triangles) triangles.push_back(triangle);
  return {{"vertices", vertices}, {"triangles", triangles}};
}

json JointList() {
  json joints = json::array();
  for (int j = 0; j < kNumJoints; ++j) {
    joints.push_back({{"name", LimitOf(j).name},
                      {"low", LimitOf(j).low},
                      {"high", LimitOf(j).high},
                      {"rest", RestAngles()[static_cast<size_t>(j)]}});
  }
  return joints;
}

}  // namespace

VirtualRobot::VirtualRobot(const VirtualRobotOptions& options, const Pose& X_TR, Recordings recordings)
    : X_TR_(X_TR), server_(options), renderer_(std::move(recordings)) {
  SendHello();
}

void VirtualRobot::SendHello() {
  const json hello{
      {"type", "hello"},
      {"protocol", 1},
      {"joints", JointList()},
      {"robot", {{"position", ListOf(X_TR_.translation())}, {"orientation", QuaternionOf(X_TR_.linear())}}},
      {"task", json::parse(task_json_)}};
  server_.Send("hello", Dump(hello));
}

void VirtualRobot::ShowTask(const Task& task) {
  json types = json::array(), parts = json::array();
  for (const PartType& type : task.types) {
    const auto colour = EyeColourOf(type.colour);
    types.push_back({{"name", type.name},
                     {"colour", HexOf(colour.value_or(EyeColour{150, 155, 165}))},
                     {"shape", ShapeOf(type.mesh)}});
  }
  for (const Part& part : task.parts) parts.push_back({{"name", part.name}, {"type", part.type}});
  task_json_ = Dump({{"name", task.name}, {"types", types}, {"parts", parts}});
  SendHello();
}

void VirtualRobot::Say(const SpeechOrder& speech) {
  speech_ = Speech{};
  speech_->order = speech;
  if (renderer_.CanSay(speech)) {
    renderer_.Order(speech);
  } else {
    speech_->refused = true;
  }
}

void VirtualRobot::Announce(const RenderedSpeech& rendered, int64_t now) {
  Speech& speech = *speech_;
  speech.begun = now;
  const bool audible = rendered.error.empty() && !rendered.samples.empty();
  speech.seconds = audible ? rendered.seconds() : SpeakingTime(speech.order.text);
  json say{{"type", "say"},
           {"id", speech.order.id},
           {"text", speech.order.text},
           {"language", speech.order.language},
           {"seconds", Round(speech.seconds)},
           {"audio", nullptr}};
  if (audible) {
    server_.OfferSpeech(speech.order.id, WavFile(rendered));
    say["audio"] = "/speech/" + std::to_string(speech.order.id) + ".wav";
  }
  server_.Send("say", Dump(say));
}

bool VirtualRobot::Over(int64_t now) const {
  const double passed = static_cast<double>(now - speech_->begun) * 1e-6;
  if (!speech_->heard) return passed > speech_->seconds + kPause;
  return speech_->speakers.empty() || passed > 2 * speech_->seconds + 3;
}

std::vector<BackEndEvent> VirtualRobot::Poll(int64_t now) {
  std::vector<BackEndEvent> events;
  for (const RenderedSpeech& rendered : renderer_.Take()) {
    if (speech_ && speech_->order.id == rendered.id && speech_->begun == 0) Announce(rendered, now);
  }
  for (const ScreenReport& report : server_.TakeReports()) {
    if (report.kind == ScreenReport::Kind::kHelp) {
      events.push_back({BackEndEvent::Kind::kHelpTouched, 0, ""});
    } else if (speech_ && report.id == speech_->order.id) {
      speech_->heard = true;
      if (report.kind == ScreenReport::Kind::kSpeechStarted) {
        speech_->speakers.insert(report.client);
      } else {
        speech_->speakers.erase(report.client);
      }
    }
  }
  if (speech_ && speech_->refused) {
    events.push_back({BackEndEvent::Kind::kSpeechFailed, speech_->order.id,
                      "no voice for the language '" + speech_->order.language + "'"});
    speech_.reset();
  } else if (speech_ && speech_->begun != 0 && Over(now)) {
    events.push_back({BackEndEvent::Kind::kSpeechDone, speech_->order.id, ""});
    speech_.reset();
    server_.Send("say", Dump({{"type", "said"}}));
  }
  return events;
}

void VirtualRobot::Silence() {
  speech_.reset();
  server_.Send("say", Dump({{"type", "silence"}}));
}

void VirtualRobot::Move(const JointPath& path) {
  json names = json::array(), times = json::array(), angles = json::array();
  std::vector<size_t> moving;
  for (size_t j = 0; j < path.moves.size(); ++j) {
    if (!path.moves[j]) continue;
    moving.push_back(j);
    names.push_back(LimitOf(static_cast<int>(j)).name);
  }
  for (const JointPath::Point& point : path.points) {
    times.push_back(Round(point.time));
    json row = json::array();
    for (const size_t j : moving) row.push_back(Round(point.angles[j]));
    angles.push_back(row);
  }
  // One topic for each limb: who attaches later gets the last word on all of them.
  const std::string topic =
      moving.empty() ? "" : "move " + std::string(LimitOf(static_cast<int>(moving[0])).name, 0, 1);
  server_.Send(topic, Dump({{"type", "move"}, {"joints", names}, {"times", times}, {"angles", angles}}));
}

void VirtualRobot::Freeze() { server_.Send("", Dump({{"type", "freeze"}})); }

void VirtualRobot::SetEyes(const EyeColour& colour) {
  server_.Send("eyes", Dump({{"type", "eyes"}, {"colour", HexOf(colour)}}));
}

void VirtualRobot::Rest() { server_.Send("rest", Dump({{"type", "rest"}})); }
void VirtualRobot::Wake() { server_.Send("rest", Dump({{"type", "wake"}})); }

void VirtualRobot::SetVolume(double volume) {
  server_.Send("volume", Dump({{"type", "volume"}, {"volume", Round(volume)}}));
}

void VirtualRobot::ShowScene(const TableScene& scene) {
  json parts = json::array(), hands = json::array();
  for (const TableScene::TablePart& part : scene.parts) {
    if (!part.X_TP.matrix().allFinite()) continue;
    parts.push_back({{"part", part.part},
                     {"position", ListOf(part.X_TP.translation())},
                     {"orientation", QuaternionOf(part.X_TP.linear())},
                     {"status", ToString(part.status)}});
  }
  for (const ForeignBlob& blob : scene.foreign)
    hands.push_back({{"centre", ListOf(blob.centre)}, {"radius", Round(blob.radius)}});
  server_.Send("scene", Dump({{"type", "scene"}, {"parts", parts}, {"hands", hands}}));
}

void VirtualRobot::ShowTarget(const std::optional<Vector3>& p_T) {
  server_.Send("target", Dump({{"type", "target"}, {"position", p_T ? ListOf(*p_T) : json(nullptr)}}));
}

}  // namespace coach
