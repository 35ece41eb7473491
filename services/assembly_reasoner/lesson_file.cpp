#include "services/assembly_reasoner/lesson_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace coach {
namespace {

using nlohmann::json;

constexpr int kVersion = 2;

}  // namespace

std::string ToJson(const LessonMemory& m) {
  json joints = json::array(), pinned = json::array(), corrections = json::array();
  for (const BelievedJoint& j : m.assembly.joints)
    joints.push_back({j.part_a, j.part_b, j.label, j.connection, j.mistake, j.since, j.decided});
  for (const auto& [pair, label] : m.assembly.pinned) pinned.push_back({pair.first, pair.second, label});
  for (const auto& [joint, times] : m.policy.corrections) corrections.push_back({joint[0], joint[1], joint[2], times});
  return json{{"version", kVersion},
              {"session", m.session},
              {"task", m.task},
              {"language", m.language},
              {"begun", m.begun},
              {"greeted", m.greeted},
              {"joints", joints},
              {"pinned", pinned},
              {"variant", m.assembly.variant},
              {"phase", static_cast<int>(m.policy.phase)},
              {"step", m.policy.step},
              {"made_before", m.policy.made_before},
              {"introduced", m.policy.introduced},
              {"announced", m.policy.announced},
              {"celebrated", m.policy.celebrated},
              {"idle_level", m.policy.idle_level},
              {"corrections", corrections},
              {"repairs", m.policy.repairs},
              {"skipped", m.skipped},
              {"last_event", m.last_event},
              {"last_command", m.last_command}}
      .dump();
}

LessonMemory LessonMemoryFromJson(const std::string& text) {
  LessonMemory m;
  try {
    const json j = json::parse(text);
    if (j.at("version").get<int>() != kVersion) throw std::invalid_argument("another version's state");
    m.session = j.at("session");
    m.task = j.at("task");
    m.language = j.at("language");
    m.begun = j.at("begun");
    m.greeted = j.at("greeted");
    m.assembly.variant = j.at("variant");
    for (const json& entry : j.at("joints")) {
      const auto v = entry.get<std::array<int64_t, 7>>();
      const auto index = [&](size_t i) { return static_cast<int>(v[i]); };
      m.assembly.joints.push_back({index(0), index(1), index(2), index(3), index(4), v[5], v[6], true});
    }
    for (const json& entry : j.at("pinned")) {
      const auto v = entry.get<std::array<int, 3>>();
      m.assembly.pinned[{v[0], v[1]}] = v[2];
    }
    const int phase = j.at("phase");
    if (phase < 0 || phase > static_cast<int>(Phase::kComplete)) throw std::invalid_argument("an unknown phase");
    m.policy.phase = static_cast<Phase>(phase);
    m.policy.step = j.at("step");
    m.policy.made_before = j.at("made_before");
    m.policy.introduced = j.at("introduced");
    m.policy.announced = j.at("announced");
    m.policy.celebrated = j.at("celebrated");
    m.policy.idle_level = j.at("idle_level");
    if (m.policy.idle_level < 0 || m.policy.idle_level > 4) throw std::invalid_argument("an unknown hint");
    m.policy.repairs = j.at("repairs");
    for (const json& entry : j.at("corrections")) {
      const auto v = entry.get<std::array<int, 4>>();
      m.policy.corrections[{v[0], v[1], v[2]}] = v[3];
    }
    m.skipped = j.at("skipped").get<std::vector<int>>();
    m.last_event = j.at("last_event");
    m.last_command = j.at("last_command");
  } catch (const json::exception& e) {
    throw std::invalid_argument(e.what());
  }
  return m;
}

std::string ToJsonLine(const GuidanceEvent& e) {
  return json{{"id", e.id},           {"utime", e.utime},   {"since", e.since},   {"kind", e.kind},
              {"subject", e.subject}, {"part_a", e.part_a}, {"part_b", e.part_b}, {"probability", e.probability},
              {"reason", e.reason}}
      .dump(-1, ' ', false, json::error_handler_t::replace);
}

void WriteAtomically(const std::filesystem::path& file, const std::string& text) {
  const std::string part = file.string() + ".part";
  const auto fail = [&](const char* what) {
    throw std::runtime_error(part + ": " + what + ": " + std::strerror(errno));
  };
  const int fd = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0640);
  if (fd < 0) fail("can't be opened");
  size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      close(fd);
      fail("can't be written");
    }
    done += static_cast<size_t>(n);
  }
  const bool flushed = fsync(fd) == 0;
  close(fd);
  if (!flushed) fail("can't be flushed");
  std::filesystem::rename(part, file);
}

std::optional<std::string> ReadText(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace coach
