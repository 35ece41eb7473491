#include "tools/report/session_files.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "tools/report/annotation_files.h"
#include "tools/report/event_log_session.h"
#include "tools/report/log_session.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> Recordings(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".lcm") files.push_back(entry.path());
  }
  // By the time of their first message: names carry local time, which may be set back.
  const auto first = [](const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    char header[20]{};
    in.read(header, sizeof header);
    uint64_t utime = 0;
    for (int i = 12; i < 20; ++i) utime = utime << 8 | static_cast<uint8_t>(header[i]);
    return utime;
  };
  std::sort(files.begin(), files.end(), [&](const fs::path& a, const fs::path& b) {
    const auto at_a = first(a), at_b = first(b);
    return at_a != at_b ? at_a < at_b : a < b;
  });
  return files;
}

ImportedAnnotations Import(const fs::path& file, int64_t origin) {
  const std::string extension = file.extension().string(), text = ReadFile(file);
  if (extension == ".txt" || extension == ".tsv") return ParseElan(text, origin);
  if (extension == ".csv") return ParseBoris(text, origin);
  if (extension == ".json") return ParseSceneEvents(text, origin);
  if (extension == ".jsonl") {
    const AnnotationBook book(file);
    return {book.Current(SIZE_MAX), static_cast<int>(book.unreadable_lines())};
  }
  throw std::invalid_argument("found the extension '" + extension + "', expected .txt, .tsv, .csv, .jsonl or .json");
}

void AddAnnotations(Session& session, const fs::path& file, double offset) {
  try {
    const int64_t first = session.frames.empty() ? session.begin : session.frames.front().utime;
    const auto imported = Import(file, first + std::llround(offset * 1e6));
    const std::string name = file.filename().string();
    if (imported.unreadable > 0)
      session.problems.push_back(name + ": " + std::to_string(imported.unreadable) + " lines can't be read");
    if (imported.annotations.empty()) session.problems.push_back(name + ": holds no annotation");
    session.annotations.insert(session.annotations.end(), imported.annotations.begin(), imported.annotations.end());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

std::vector<fs::path> AnnotationsBeside(const fs::path& path) {
  std::vector<fs::path> found;
  for (const char* extension : {".txt", ".csv", ".jsonl", ".json"}) {
    fs::path file = path;
    file = fs::is_directory(path) ? path / "annotations" : file.replace_extension(".annotations");
    file += extension;
    if (fs::exists(file)) found.push_back(file);
  }
  return found;
}

/// Two people's notes of one event are not two events.
void KeepOneAnnotator(Session& session, std::string annotator) {
  const auto is_event = [](const Annotation& a) {
    return a.kind == "connect" || a.kind == "wrong" || a.kind == "disconnect";
  };
  std::map<std::string, int> counts;
  for (const Annotation& a : session.annotations) {
    if (is_event(a)) ++counts[a.annotator];
  }
  if (counts.empty() || (counts.size() == 1 && annotator.empty())) return;
  if (annotator.empty())
    annotator = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                  return a.second < b.second;
                })->first;
  for (const auto& [name, count] : counts) {
    if (name != annotator)
      session.problems.push_back(std::to_string(count) + " events noted by '" + name + "' are left out, those of '" +
                                 annotator + "' are the truth");
  }
  std::erase_if(session.annotations, [&](const Annotation& a) { return is_event(a) && a.annotator != annotator; });
}

bool IsRecording(const std::string& head) { return head.starts_with("\xED\xA1\xDA\x01"); }

}  // namespace

std::string ReadFile(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  if (!in || fs::is_directory(file) || (in.peek() != EOF && !(text << in.rdbuf())))
    throw std::runtime_error(file.string() + ": can't be read");
  return text.str();
}

Session ReadSession(const fs::path& given, const SessionOptions& options) {
  const fs::path path = given.has_filename() ? given : given.parent_path();
  Session session;
  if (fs::is_directory(path)) {
    const auto files = Recordings(path);
    if (files.empty()) throw std::runtime_error(path.string() + ": holds no recording (*.lcm)");
    session = ReadLogSession(files, options.station);
  } else {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error(path.string() + ": can't be read");
    std::string head(4, '\0');
    in.read(head.data(), 4);
    const bool empty = in.gcount() == 0;
    if (IsRecording(head) || (empty && path.extension() != ".jsonl")) {
      session = ReadLogSession({path}, options.station);
    } else if (empty || head[0] == '{') {
      session = ParseEventLog(ReadFile(path));
    } else {
      throw std::runtime_error(path.string() + ": is neither a recording of the bus nor an event log");
    }
  }
  session.name = fs::is_directory(path) ? path.filename().string() : path.stem().string();
  for (const auto& file : AnnotationsBeside(path)) AddAnnotations(session, file, options.annotation_offset);
  for (const auto& file : options.annotations) AddAnnotations(session, file, options.annotation_offset);
  std::stable_sort(session.annotations.begin(), session.annotations.end(),
                   [](const Annotation& a, const Annotation& b) { return a.utime < b.utime; });
  KeepOneAnnotator(session, options.annotator);
  return session;
}

}  // namespace coach
