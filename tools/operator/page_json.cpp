#include "tools/operator/page_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/assembly/task_file.h"
#include "tools/operator/assembly_plan.h"
#include "tools/operator/json_text.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxTriangles = 3000;       // of a mesh that a page draws
constexpr int64_t kSilentAfter = 3'500'000;  // us without a sign of life

constexpr std::array<std::pair<OperatorKind, const char*>, 14> kKinds{{
    {OperatorKind::kChooseTask, "choose_task"},
    {OperatorKind::kLanguage, "language"},
    {OperatorKind::kStart, "start"},
    {OperatorKind::kPause, "pause"},
    {OperatorKind::kResume, "resume"},
    {OperatorKind::kSkip, "skip"},
    {OperatorKind::kMarkDone, "mark_done"},
    {OperatorKind::kMarkUndone, "mark_undone"},
    {OperatorKind::kRepeat, "repeat"},
    {OperatorKind::kSay, "say"},
    {OperatorKind::kVolume, "volume"},
    {OperatorKind::kResetTracker, "reset_tracker"},
    {OperatorKind::kStop, "stop"},
    {OperatorKind::kHelp, "help"},
}};

Json PolygonsJson(const std::vector<Polygon>& polygons) {
  Json list = Json::array();
  for (const auto& polygon : polygons) {
    Json flat = Json::array();
    for (const auto& p : polygon) {
      flat.push_back(Rounded(p.x(), 10));
      flat.push_back(Rounded(p.y(), 10));
    }
    list.push_back(std::move(flat));
  }
  return list;
}

Json MeshJson(const TriangleMesh& mesh) {
  Json vertices = Json::array(), triangles = Json::array();
  for (const auto& p : mesh.vertices) {
    for (int k = 0; k < 3; ++k) vertices.push_back(Rounded(p[k] * 1000, 100));
  }
  for (const auto& t : mesh.triangles) {
    for (const int vertex : t) triangles.push_back(vertex);
  }
  return {{"vertices_mm", std::move(vertices)}, {"triangles", std::move(triangles)}};
}

/// The colour in the middle of a range, as red, green, blue 0..255. A hue that wraps goes through red.
std::array<int, 3> MiddleColour(const HsvRange& range) {
  const int span = (range.high[0] - range.low[0] + 180) % 180;
  const double hue = std::fmod(range.low[0] + 0.5 * span, 180) / 30;  // sixths of the circle
  const double saturation = std::clamp(0.5 * (range.low[1] + range.high[1]) / 255, 0.0, 1.0);
  const double value = std::clamp(0.5 * (range.low[2] + range.high[2]) / 255, 0.0, 1.0);
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue, 6);
    return static_cast<int>(std::lround(255 * (value - value * saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0))));
  };
  return {channel(5), channel(3), channel(1)};
}

Json PlanJson(const Task& task, const std::vector<int>& variant) {
  const AssemblyPlan plan = PlanOf(task, variant);
  Json slots = Json::array(), joints = Json::array();
  for (const auto& slot : plan.slots) {
    slots.push_back({{"outlines", PolygonsJson(slot.outlines)},
                     {"label", {Rounded(slot.label.x(), 10), Rounded(slot.label.y(), 10)}},
                     {"height", Rounded(slot.height, 10)}});
  }
  for (const auto& joint : plan.joints) {
    joints.push_back(
        {{"connection", joint.connection}, {"place", {Rounded(joint.place.x(), 10), Rounded(joint.place.y(), 10)}}});
  }
  return {{"width", Rounded(plan.width, 10)},
          {"height", Rounded(plan.height, 10)},
          {"slots", std::move(slots)},
          {"joints", std::move(joints)}};
}

Json TaskJson(const Task& task, const std::vector<TriangleMesh>& meshes) {
  Json types = Json::array(), parts = Json::array(), slots = Json::array(), connections = Json::array(),
       mistakes = Json::array(), plans = Json::array();
  for (size_t k = 0; k < task.types.size(); ++k) {
    types.push_back({{"name", task.types[k].name},
                     {"colour", task.types[k].colour},
                     {"rgb", MiddleColour(task.types[k].hsv)},
                     {"mesh", MeshJson(meshes[k])}});
  }
  for (const auto& part : task.parts) parts.push_back({{"name", part.name}, {"type", part.type}});
  for (const auto& slot : task.slots) slots.push_back({{"name", slot.name}, {"type", slot.type}});
  for (const auto& c : task.connections) {
    connections.push_back(
        {{"name", c.name}, {"slots", {c.slot_a, c.slot_b}}, {"closes_by_itself", c.closes_by_itself}});
  }
  for (const auto& m : task.mistakes) mistakes.push_back({{"name", m.name}, {"types", {m.type_a, m.type_b}}});
  for (const auto& variant : task.variants) plans.push_back(PlanJson(task, variant));
  return {{"types", std::move(types)},       {"parts", std::move(parts)},
          {"slots", std::move(slots)},       {"connections", std::move(connections)},
          {"mistakes", std::move(mistakes)}, {"steps", task.steps},
          {"plans", std::move(plans)}};
}

Json EventJson(const GuidanceEvent& e) {
  return {
      {"id", e.id},           {"utime", e.utime},   {"since", e.since},   {"kind", e.kind},
      {"subject", e.subject}, {"part_a", e.part_a}, {"part_b", e.part_b}, {"probability", Rounded(e.probability, 1000)},
      {"reason", e.reason}};
}

Json LessonJson(const Lesson::Snapshot& snapshot, int64_t now) {
  const AssemblyState& state = snapshot.state;
  Json connections = Json::array();
  for (const auto& c : state.connections) {
    connections.push_back({{"connection", c.connection},
                           {"part_a", c.part_a},
                           {"part_b", c.part_b},
                           {"probability", Rounded(c.probability, 1000)},
                           {"state", static_cast<int>(c.state)},
                           {"since", c.since},
                           {"decided", c.decided}});
  }
  return {{"alive", now - snapshot.state_seen < kSilentAfter},
          {"session", state.session},
          {"utime", state.utime},
          {"phase", static_cast<int>(state.phase)},
          {"idle_level", state.idle_level},
          {"step", state.step},
          {"made", state.made},
          {"required", state.required},
          {"connections", std::move(connections)}};
}

Json RobotJson(const Lesson::Snapshot& snapshot, int64_t now) {
  const RobotStatus& robot = snapshot.robot;
  return {{"alive", now - snapshot.robot_seen < kSilentAfter},
          {"connected", robot.connected},
          {"speaking", robot.speaking},
          {"back_end", robot.back_end},
          {"language", robot.language},
          {"battery", Rounded(robot.battery, 100)},
          {"point_clamped", robot.point_clamped},
          {"gaze_clamped", robot.gaze_clamped},
          {"reason", robot.reason}};
}

Json ActJson(const SpokenAct& act) {
  Json json{{"id", act.command.id},
            {"kind", static_cast<int>(act.command.kind)},
            {"text", act.command.text},
            {"key", act.command.phrase_key},
            {"language", act.command.language},
            {"priority", static_cast<int>(act.command.priority)},
            {"eye_colour", act.command.eye_colour},
            {"state", static_cast<int>(act.state)},
            {"reason", act.reason},
            {"seen", act.seen}};
  const auto target = [&](const char* name, const std::optional<Vector3>& p) {
    if (p) json[name] = {Rounded(p->x(), 1e4), Rounded(p->y(), 1e4), Rounded(p->z(), 1e4)};
  };
  target("point", act.command.point_target);
  target("look", act.command.look_target);
  return json;
}

Json ServiceJson(const ServiceReport& s, int64_t now) {
  return {{"service", s.service},
          {"host", s.host},
          {"pid", s.pid},
          {"alive", now - s.seen < kSilentAfter},
          {"state", static_cast<int>(s.state)},
          {"message", s.message},
          {"rate", Rounded(s.rate, 10)},
          {"latency_p50_ms", Rounded(s.latency_p50_ms, 10)},
          {"latency_p99_ms", Rounded(s.latency_p99_ms, 10)},
          {"work_p50_ms", Rounded(s.work_p50_ms, 10)},
          {"work_p99_ms", Rounded(s.work_p99_ms, 10)},
          {"received", s.received},
          {"answered", s.answered},
          {"dropped", s.dropped},
          {"socket_drops", s.socket_drops},
          {"decode_errors", s.decode_errors},
          {"resident_mb", Rounded(static_cast<double>(s.resident_bytes) / 1e6, 10)}};
}

Json CommandJson(const CommandOutbox::Entry& entry) {
  constexpr std::array<const char*, 3> kFates{"pending", "done", "unanswered"};
  return {{"id", entry.command.id},
          {"kind", NameOf(entry.command.kind)},
          {"argument", entry.command.argument},
          {"fate", kFates[static_cast<size_t>(entry.fate)]},
          {"waiting_for", entry.waiting_for}};
}

Json AnnotationJson(const Annotation& a) {
  return {{"utime", a.utime}, {"id", a.id},           {"annotator", a.annotator},
          {"kind", a.kind},   {"subject", a.subject}, {"value", a.value}};
}

template <class List, class Function>
Json Mapped(const List& list, const Function& function) {
  Json json = Json::array();
  for (const auto& item : list) json.push_back(function(item));
  return json;
}

Json PoseJson(const Pose& X) {
  const Eigen::Quaterniond q(X.rotation());
  return {Rounded(X.translation().x(), 1e5),
          Rounded(X.translation().y(), 1e5),
          Rounded(X.translation().z(), 1e5),
          Rounded(q.w(), 1e5),
          Rounded(q.x(), 1e5),
          Rounded(q.y(), 1e5),
          Rounded(q.z(), 1e5)};
}

}  // namespace

std::optional<OperatorKind> OperatorKindOf(const std::string& name) {
  for (const auto& [kind, text] : kKinds) {
    if (name == text) return kind;
  }
  return std::nullopt;
}

const char* NameOf(OperatorKind kind) {
  for (const auto& [known, text] : kKinds) {
    if (known == kind) return text;
  }
  return "unknown";
}

std::shared_ptr<const TaskView> MakeTaskView(std::shared_ptr<const Task> task, int64_t revision) {
  auto view = std::make_shared<TaskView>();
  view->revision = revision;
  view->name = task->name;
  view->choice = task->file.stem();
  view->sha256 = task->sha256;
  for (const auto& type : task->types) view->meshes.push_back(Simplified(type.mesh, kMaxTriangles));
  Json json = TaskJson(*task, view->meshes);
  json["revision"] = revision;
  json["name"] = task->name;
  view->json = Dump(json);
  view->task = std::move(task);
  return view;
}

std::shared_ptr<const TaskView> UnusableTask(const std::string& name, const std::string& sha256,
                                             const std::string& problem, int64_t revision) {
  auto view = std::make_shared<TaskView>();
  view->revision = revision;
  view->name = view->choice = name;
  view->sha256 = sha256;
  view->problem = problem;
  view->json = Dump({{"revision", revision}, {"name", name}});
  return view;
}

std::shared_ptr<const TaskView> LoadTaskView(const std::filesystem::path& file, int64_t revision) {
  try {
    return MakeTaskView(std::make_shared<const Task>(LoadTask(file)), revision);
  } catch (const std::exception& e) {
    return UnusableTask(file.stem(), "", e.what(), revision);
  }
}

std::string StateJson(const Lesson::Snapshot& snapshot, const std::vector<CommandOutbox::Entry>& commands,
                      const std::vector<Annotation>& annotations, const StationFacts& facts, const std::string& station,
                      int64_t now) {
  return Dump({{"station", station},
               {"now", now},
               {"data_utime", snapshot.data_utime},
               {"task",
                {{"revision", snapshot.task_revision},
                 {"name", snapshot.task_name},
                 {"choice", snapshot.task_choice},
                 {"problem", snapshot.task_problem}}},
               {"tasks", facts.tasks},
               {"languages", facts.languages},
               {"lesson", LessonJson(snapshot, now)},
               {"seat", PoseJson(facts.X_TR)},
               {"robot", RobotJson(snapshot, now)},
               {"acts", Mapped(snapshot.acts, ActJson)},
               {"services", Mapped(snapshot.services, [&](const auto& s) { return ServiceJson(s, now); })},
               {"events", Mapped(snapshot.events, EventJson)},
               {"commands", Mapped(commands, CommandJson)},
               {"annotations", Mapped(annotations, AnnotationJson)}});
}

std::string ViewJson(const LiveView& view) {
  Json parts = Json::array(), foreign = Json::array();
  for (size_t k = 0; k < view.poses.parts.size(); ++k) {
    const PartEstimate& part = view.poses.parts[k];
    parts.push_back({{"pose", PoseJson(part.X_TP)},
                     {"status", static_cast<int>(part.status)},
                     {"visible", Rounded(part.visible_fraction, 100)},
                     {"confidence", Rounded(part.confidence, 100)},
                     {"ambiguous_with", part.ambiguous_with},
                     {"outlines", k < view.outlines.size() ? PolygonsJson(view.outlines[k]) : Json::array()}});
  }
  for (const auto& blob : view.poses.foreign) {
    foreign.push_back({Rounded(blob.centre.x(), 1e4), Rounded(blob.centre.y(), 1e4), Rounded(blob.centre.z(), 1e4),
                       Rounded(blob.radius, 1e4)});
  }
  return Dump({{"number", view.number},
               {"utime", view.poses.utime},
               {"width", view.picture ? view.picture->camera.width : 0},
               {"height", view.picture ? view.picture->camera.height : 0},
               {"table_found", view.poses.table_found},
               {"camera", PoseJson(view.poses.X_TC)},
               {"parts", std::move(parts)},
               {"foreign", std::move(foreign)}});
}

std::string PrometheusText(const std::vector<ServiceReport>& services, const std::string& station, int64_t now) {
  struct Figure {
    const char* name;
    const char* type;
    const char* help;
    double (*value)(const ServiceReport&);
  };
  static constexpr std::array<Figure, 10> kFigures{{
      {"state", "gauge", "0 starting, 1 ok, 2 degraded, 3 failed",
       [](const ServiceReport& s) { return static_cast<double>(s.state); }},
      {"rate_hz", "gauge", "answered inputs a second", [](const ServiceReport& s) { return s.rate; }},
      {"latency_p50_seconds", "gauge", "capture to publication, median",
       [](const ServiceReport& s) { return s.latency_p50_ms / 1000; }},
      {"latency_p99_seconds", "gauge", "capture to publication, 99th percentile",
       [](const ServiceReport& s) { return s.latency_p99_ms / 1000; }},
      {"received_total", "counter", "inputs", [](const ServiceReport& s) { return static_cast<double>(s.received); }},
      {"answered_total", "counter", "inputs that led to an output",
       [](const ServiceReport& s) { return static_cast<double>(s.answered); }},
      {"dropped_total", "counter", "inputs superseded by newer ones",
       [](const ServiceReport& s) { return static_cast<double>(s.dropped); }},
      {"socket_drops_total", "counter", "datagrams that the kernel threw away",
       [](const ServiceReport& s) { return static_cast<double>(s.socket_drops); }},
      {"decode_errors_total", "counter", "messages that could not be decoded",
       [](const ServiceReport& s) { return static_cast<double>(s.decode_errors); }},
      {"resident_bytes", "gauge", "memory",
       [](const ServiceReport& s) { return static_cast<double>(s.resident_bytes); }},
  }};
  const auto quoted = [](const std::string& text) {
    std::string out;
    for (const char c : text) {
      if (c == '"' || c == '\\') out += '\\';
      out += c == '\n' ? ' ' : c;
    }
    return out;
  };
  std::string text = "# HELP coach_up 1 if the service gave a sign of life lately\n# TYPE coach_up gauge\n";
  const auto line = [&](const std::string& name, const ServiceReport& s, double value) {
    char number[32];
    std::snprintf(number, sizeof number, "%.10g", value);
    text += "coach_" + name + "{station=\"" + quoted(station) + "\",service=\"" + quoted(s.service) + "\"} " + number +
            "\n";
  };
  for (const auto& s : services) line("up", s, now - s.seen < kSilentAfter ? 1 : 0);
  for (const auto& figure : kFigures) {
    text += std::string("# HELP coach_") + figure.name + " " + figure.help + "\n# TYPE coach_" + figure.name + " " +
            figure.type + "\n";
    for (const auto& s : services) line(figure.name, s, figure.value(s));
  }
  return text;
}

}  // namespace coach
