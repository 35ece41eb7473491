#include "tools/report/annotation_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "tools/report/csv.h"
#include "tools/report/numbers.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr const char* kOurs = "coach ";  // beginning of the tiers that Coach writes of itself
constexpr double kLatest = 1e7;          // s; later times are a mistake
constexpr int64_t kShown = 500000;       // us a moment lasts on a tier
constexpr std::array<const char*, 4> kWritten{"connect", "wrong", "disconnect", "say"};

/// Empty if the word is no kind.
std::string KindOf(const std::string& word) {
  static const std::map<std::string, std::string> kinds{
      {"connect", "connect"},       {"connection", "connect"},
      {"connected", "connect"},     {"made", "connect"},
      {"wrong", "wrong"},           {"wrong_connect", "wrong"},
      {"mistake", "wrong"},         {"wrong connection", "wrong"},
      {"disconnect", "disconnect"}, {"disconnected", "disconnect"},
      {"undone", "disconnect"},     {"note", "note"},
      {"comment", "note"},          {"questionnaire", "questionnaire"}};
  const auto found = kinds.find(Lowered(Trimmed(word)));
  return found == kinds.end() ? "" : found->second;
}

Annotation Understood(const std::string& label, const std::string& text) {
  Annotation a;
  a.kind = KindOf(label);
  if (a.kind == "note") {
    a.value = text;
  } else if (a.kind == "questionnaire") {
    const size_t blank = text.find(' ');
    a.subject = text.substr(0, blank);
    if (blank != std::string::npos) a.value = Trimmed(text.substr(blank));
  } else if (!a.kind.empty()) {
    a.subject = text;
  } else {
    const size_t blank = text.find(' ');
    a.kind = KindOf(text.substr(0, blank));
    if (a.kind == "connect" || a.kind == "wrong" || a.kind == "disconnect") {
      if (blank != std::string::npos) a.subject = Trimmed(text.substr(blank));
    } else {
      a.kind = "note";
      a.value = Trimmed(label + ": " + text);
    }
  }
  if ((a.kind == "wrong" || a.kind == "disconnect") && a.subject.empty()) a.subject = "unknown";
  return a;
}

/// hh:mm:ss.mmm, mm:ss.mmm, seconds with a point, or whole milliseconds; s.
std::optional<double> Seconds(const std::string& text, bool whole_is_milliseconds) {
  const std::string trimmed = Trimmed(text);
  double seconds = 0;
  size_t begin = 0;
  int fields = 0;
  while (true) {
    const size_t colon = trimmed.find(':', begin);
    const auto field =
        ParseNumber(std::string_view(trimmed).substr(begin, colon == std::string::npos ? colon : colon - begin));
    if (!field || *field < 0 || ++fields > 3) return std::nullopt;
    seconds = seconds * 60 + *field;
    if (colon == std::string::npos) break;
    begin = colon + 1;
  }
  if (fields == 1 && whole_is_milliseconds && trimmed.find('.') == std::string::npos) seconds /= 1000;
  if (seconds > kLatest) return std::nullopt;
  return seconds;
}

int64_t At(double seconds, int64_t origin) { return origin + std::llround(seconds * 1e6); }

void Finish(ImportedAnnotations& imported) {
  std::stable_sort(imported.annotations.begin(), imported.annotations.end(),
                   [](const Annotation& a, const Annotation& b) { return a.utime < b.utime; });
  int64_t id = 0;
  for (Annotation& a : imported.annotations) a.id = ++id;
}

struct ElanColumns {
  size_t tier = 0, begin = 2;
  std::optional<size_t> participant = 1, text;  // text: the last one
};

/// ELAN quotes nothing.
std::vector<CsvRow> TabbedLines(std::string_view text) {
  std::vector<CsvRow> rows;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (Trimmed(line).empty()) continue;
    CsvRow row(1);
    for (const char c : line) {
      if (c == '\t') {
        row.emplace_back();
      } else if (c != '\r') {
        row.back() += c;
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<ElanColumns> ElanHeader(const CsvRow& row) {
  ElanColumns columns;
  const int tier = FindColumn(row, {"Tier"});
  std::optional<size_t> begin;
  for (size_t i = 0; i < row.size() && !begin; ++i) {
    if (Lowered(row[i]).starts_with("begin time")) begin = i;
  }
  if (tier < 0 || !begin) return std::nullopt;
  columns.tier = static_cast<size_t>(tier);
  columns.begin = *begin;
  const int participant = FindColumn(row, {"Participant", "Annotator"}), text = FindColumn(row, {"Annotation"});
  columns.participant = participant < 0 ? std::nullopt : std::optional<size_t>(participant);
  if (text >= 0) columns.text = static_cast<size_t>(text);
  return columns;
}

ElanColumns GuessedElanColumns(const CsvRow& row) {
  ElanColumns columns;
  for (size_t i = 1; i + 1 < row.size(); ++i) {
    if (!Seconds(row[i], true)) continue;
    columns.begin = i;
    columns.participant = i >= 2 ? std::optional<size_t>(i - 1) : std::nullopt;
    return columns;
  }
  return columns;
}

std::string Text(const Annotation& a) {
  std::string text = a.subject;
  if (!a.value.empty()) text += (text.empty() ? "" : " ") + a.value;
  return text;
}

struct Row {
  double seconds = 0;
  std::string label, annotator, text;
};

std::vector<Row> Rows(const std::vector<Annotation>& annotations, const std::vector<GuidanceEvent>& events,
                      int64_t origin) {
  std::vector<Row> rows;
  for (const Annotation& a : annotations)
    rows.push_back({static_cast<double>(a.utime - origin) / 1e6, a.kind, a.annotator, Text(a)});
  for (const GuidanceEvent& e : events) {
    if (std::find(kWritten.begin(), kWritten.end(), e.kind) == kWritten.end()) continue;
    rows.push_back({static_cast<double>((e.kind == "say" ? e.utime : e.since) - origin) / 1e6, "Coach " + e.kind,
                    "Coach", e.kind == "say" ? e.reason : e.subject});
  }
  std::erase_if(rows, [](const Row& r) { return r.seconds < 0; });
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.seconds < b.seconds; });
  return rows;
}

std::string ElanTime(double seconds) {
  const auto ms = std::llround(seconds * 1000);
  char text[64];
  std::snprintf(text, sizeof text, "%02lld:%02lld:%02lld.%03lld", ms / 3600000, ms / 60000 % 60, ms / 1000 % 60,
                ms % 1000);
  return text;
}

std::string OneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  return text;
}

}  // namespace

ImportedAnnotations ParseElan(std::string_view text, int64_t origin) {
  ImportedAnnotations out;
  std::optional<ElanColumns> header;
  for (const CsvRow& row : TabbedLines(text)) {
    if (row[0].starts_with("#") || row[0].starts_with("\"#")) continue;
    if (!header && (header = ElanHeader(row))) continue;
    const ElanColumns columns = header ? *header : GuessedElanColumns(row);
    const auto field = [&](size_t i) { return i < row.size() ? Trimmed(row[i]) : std::string(); };
    const std::string tier = field(columns.tier);
    const auto begin = Seconds(field(columns.begin), true);
    if (!begin) {
      ++out.unreadable;
      continue;
    }
    if (Lowered(tier).starts_with(kOurs)) continue;
    Annotation a = Understood(tier, field(columns.text.value_or(row.size() - 1)));
    if (columns.participant) a.annotator = field(*columns.participant);
    a.utime = At(*begin, origin);
    out.annotations.push_back(std::move(a));
  }
  Finish(out);
  return out;
}

ImportedAnnotations ParseBoris(std::string_view text, int64_t origin) {
  const std::string_view first = text.substr(0, text.find("\nObservation id"));
  const char separator =
      std::count(first.begin(), first.end(), '\t') > std::count(first.begin(), first.end(), ',') ? '\t' : ',';
  const auto rows = ParseCsv(text, separator);
  const auto header = std::find_if(rows.begin(), rows.end(), [](const CsvRow& row) {
    return FindColumn(row, {"Behavior"}) >= 0 && FindColumn(row, {"Time", "Start (s)"}) >= 0;
  });
  if (header == rows.end()) throw std::invalid_argument("no line names the columns Time and Behavior");
  const int time = FindColumn(*header, {"Time", "Start (s)"}), behaviour = FindColumn(*header, {"Behavior"});
  const int modifier = FindColumn(*header, {"Modifier #1", "Modifiers", "Modifier 1"});
  const int subject = FindColumn(*header, {"Subject"}), status = FindColumn(*header, {"Behavior type", "Status"});
  const int comment = FindColumn(*header, {"Comment", "Comment start"});
  ImportedAnnotations out;
  for (auto row = header + 1; row != rows.end(); ++row) {
    const auto field = [&](int i) {
      return i >= 0 && static_cast<size_t>(i) < row->size() ? Trimmed((*row)[static_cast<size_t>(i)]) : std::string();
    };
    if (Lowered(field(behaviour)).starts_with(kOurs) || Lowered(field(status)) == "stop") continue;
    const auto seconds = Seconds(field(time), false);
    if (!seconds) {
      ++out.unreadable;
      continue;
    }
    const std::string name = field(modifier), said = field(comment);
    Annotation a = Understood(field(behaviour), name.empty() ? said : name);
    if (!name.empty() && a.kind != "note") a.value = said;
    if (Lowered(field(subject)) != "no focal subject") a.annotator = field(subject);
    a.utime = At(*seconds, origin);
    out.annotations.push_back(std::move(a));
  }
  Finish(out);
  return out;
}

ImportedAnnotations ParseSceneEvents(std::string_view text, int64_t origin) {
  ImportedAnnotations out;
  try {
    const Json scene = Json::parse(text);
    for (const Json& e : scene.at("events")) {
      Annotation a;
      a.kind = KindOf(e.at("type").get<std::string>());
      if (a.kind != "connect" && a.kind != "wrong" && a.kind != "disconnect") continue;
      a.subject = e.at("connection");
      a.utime = At(e.at("time"), origin);
      a.annotator = "scene";
      out.annotations.push_back(std::move(a));
    }
  } catch (const Json::exception& error) {
    throw std::invalid_argument(error.what());
  }
  Finish(out);
  return out;
}

std::string ElanText(const std::vector<Annotation>& annotations, const std::vector<GuidanceEvent>& events,
                     int64_t origin) {
  std::string out =
      "Tier\tParticipant\tBegin Time - hh:mm:ss.ms\tEnd Time - hh:mm:ss.ms\tDuration - ss.msec\tAnnotation\n";
  for (const Row& r : Rows(annotations, events, origin)) {
    out += OneLine(r.label) + '\t' + OneLine(r.annotator) + '\t' + ElanTime(r.seconds) + '\t' +
           ElanTime(r.seconds + kShown / 1e6) + '\t' + Fixed(kShown / 1e6, 3) + '\t' + OneLine(r.text) + '\n';
  }
  return out;
}

std::string BorisCsv(const std::vector<Annotation>& annotations, const std::vector<GuidanceEvent>& events,
                     int64_t origin, const std::string& observation) {
  std::string out = CsvLine({"Observation id", "Subject", "Behavior", "Behavioral category", "Modifier #1",
                             "Behavior type", "Time", "Comment"});
  for (const Row& r : Rows(annotations, events, origin)) {
    const bool spoken = r.label == "note" || r.label == "Coach say";
    out += CsvLine({observation, r.annotator.empty() ? "No focal subject" : r.annotator, r.label,
                    r.annotator == "Coach" ? "Coach" : "observed", spoken ? "" : r.text, "POINT", Fixed(r.seconds, 3),
                    spoken ? r.text : ""});
  }
  return out;
}

}  // namespace coach
