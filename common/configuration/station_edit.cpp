#include "common/configuration/station_edit.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include "common/configuration/yaml_reader.h"

namespace coach {
namespace {

using Lines = std::vector<std::string>;

Lines Split(const std::string& text) {
  Lines lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string Joined(const Lines& lines) {
  std::string text;
  for (const auto& line : lines) text += line + "\n";
  return text;
}

size_t Indent(const std::string& line) { return std::min(line.find_first_not_of(' '), line.size()); }

/// Blank or nothing but a comment.
bool Bare(const std::string& line) {
  const size_t first = Indent(line);
  return first == line.size() || line[first] == '#';
}

/// Where a comment begins after a value, with the blanks before it; the line's end if there is none.
size_t CommentOf(const std::string& line) {
  char quote = 0;
  for (size_t i = 0; i < line.size(); ++i) {
    if (quote) {
      if (line[i] == quote) quote = 0;
    } else if (line[i] == '"' || line[i] == '\'') {
      quote = line[i];
    } else if (line[i] == '#' && i > 0 && line[i - 1] == ' ') {
      return line.find_last_not_of(' ', i - 1) + 1;
    }
  }
  return line.size();
}

/// Lines [first, end) of a key and its value.
struct Block {
  size_t first, end;
};

/// A key of a map whose lines are [begin, end) and whose keys are indented by `indent`.
std::optional<Block> Find(const Lines& lines, size_t begin, size_t end, size_t indent, const std::string& key) {
  for (size_t i = begin; i < end; ++i) {
    if (Bare(lines[i]) || Indent(lines[i]) != indent || lines[i].compare(indent, key.size() + 1, key + ":") != 0)
      continue;
    size_t stop = i + 1;
    while (stop < end && (Bare(lines[stop]) || Indent(lines[stop]) > indent)) ++stop;
    while (stop > i + 1 && Bare(lines[stop - 1])) --stop;  // comments before the next key are that key's
    return Block{i, stop};
  }
  return std::nullopt;
}

size_t LastWritten(const Lines& lines) {
  size_t end = lines.size();
  while (end > 0 && lines[end - 1].empty()) --end;
  return end;
}

void Write(Lines& lines, size_t begin, size_t end, size_t indent, const std::string& key, const std::string& value) {
  const std::string text = std::string(indent, ' ') + key + ": " + value;
  if (const auto block = Find(lines, begin, end, indent, key)) {
    const std::string& old = lines[block->first];
    const std::string comment = block->end == block->first + 1 ? old.substr(CommentOf(old)) : "";
    lines[block->first] = text + comment;
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(block->first + 1),
                lines.begin() + static_cast<std::ptrdiff_t>(block->end));
  } else {
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(end), text);
  }
}

std::string Changed(const std::string& text, const Setting& setting) {
  Lines lines = Split(text);
  if (setting.path.size() == 1) {
    Write(lines, 0, LastWritten(lines), 0, setting.path[0], setting.value);
    return Joined(lines);
  }
  const auto section = Find(lines, 0, lines.size(), 0, setting.path[0]);
  if (!section) {
    const size_t end = LastWritten(lines);
    lines.resize(end);
    if (end > 0) lines.emplace_back();
    lines.push_back(setting.path[0] + ":");
    lines.push_back("  " + setting.path[1] + ": " + setting.value);
    return Joined(lines);
  }
  size_t indent = 2;
  for (size_t i = section->first + 1; i < section->end; ++i) {
    if (Bare(lines[i])) continue;
    indent = Indent(lines[i]);
    break;
  }
  Write(lines, section->first + 1, section->end, indent, setting.path[1], setting.value);
  return Joined(lines);
}

bool Same(const YAML::Node& a, const YAML::Node& b) {
  if (a.Type() != b.Type() || a.size() != b.size()) return false;
  if (a.IsScalar()) return a.Scalar() == b.Scalar();
  for (size_t i = 0; a.IsSequence() && i < a.size(); ++i) {
    if (!Same(a[i], b[i])) return false;
  }
  for (auto entry = a.begin(); a.IsMap() && entry != a.end(); ++entry) {
    const YAML::Node other = b[entry->first.Scalar()];
    if (!other || !Same(entry->second, other)) return false;
  }
  return true;
}

/// The document with the settings, as data.
YAML::Node Wanted(const std::string& text, const std::vector<Setting>& settings) {
  YAML::Node root = YAML::Load(text);
  if (root.IsNull()) root = YAML::Node(YAML::NodeType::Map);
  for (const auto& setting : settings) {
    const YAML::Node value = YAML::Load(setting.value);
    if (setting.path.size() == 1) {
      root[setting.path[0]] = value;
    } else {
      if (!root[setting.path[0]].IsMap()) root[setting.path[0]] = YAML::Node(YAML::NodeType::Map);
      root[setting.path[0]][setting.path[1]] = value;
    }
  }
  return root;
}

[[noreturn]] void Refuse(const std::filesystem::path& file, const char* what) {
  throw std::runtime_error(file.string() + ": can't be " + what + ": " + std::strerror(errno));
}

void WriteDurably(const std::filesystem::path& file, const std::string& text, mode_t mode) {
  const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, mode);
  if (out < 0) Refuse(file, "written");
  size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = write(out, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    written += static_cast<size_t>(n);
  }
  const bool good = written == text.size() && fchmod(out, mode) == 0 && fsync(out) == 0;
  const int error = errno;
  close(out);
  if (good) return;
  unlink(file.c_str());
  errno = error;
  Refuse(file, "written");
}

}  // namespace

std::string WithSettings(const std::string& text, const std::vector<Setting>& settings) {
  try {
    const YAML::Node wanted = Wanted(text, settings);
    std::string changed = text;
    for (const auto& setting : settings) changed = Changed(changed, setting);
    try {
      if (Same(YAML::Load(changed), wanted)) return changed;
    } catch (const YAML::Exception&) {  // written anew below
    }
    YAML::Emitter out;
    out << wanted;
    return std::string(out.c_str()) + "\n";
  } catch (const YAML::Exception& e) {
    throw ConfigurationError(std::string("the settings can't be changed: ") + e.what());
  }
}

void ReplaceFile(const std::filesystem::path& file, const std::string& text) {
  namespace fs = std::filesystem;
  struct stat facts {};
  const bool there = stat(file.c_str(), &facts) == 0;
  if (there) {
    std::ifstream in(file, std::ios::binary);
    const std::string old{std::istreambuf_iterator<char>(in), {}};
    if (!in.bad() && old == text) return;
  }
  const fs::path next = file.string() + ".new";
  WriteDurably(next, text, there ? facts.st_mode & 07777 : 0640);
  std::error_code error;
  const auto kept = [&](int k) { return fs::path(file.string() + "." + std::to_string(k)); };
  if (there) {
    for (int k = kKeptVersions - 1; k >= 1; --k) fs::rename(kept(k), kept(k + 1), error);
    fs::remove(kept(1), error);
    // A second name for the present file, so that the file itself is never missing.
    if (link(file.c_str(), kept(1).c_str()) != 0) Refuse(kept(1), "written");
  }
  if (rename(next.c_str(), file.c_str()) != 0) Refuse(file, "replaced");
}

}  // namespace coach
