#include "tools/operator/annotations.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr size_t kLongest = 2000;  // bytes of any text
constexpr std::array<const char*, 6> kKinds{"connect", "wrong", "disconnect", "note", "questionnaire", "removed"};

Json ToJson(const Annotation& a) {
  return {{"utime", a.utime},     {"id", a.id},       {"annotator", a.annotator},    {"kind", a.kind},
          {"subject", a.subject}, {"value", a.value}, {"replaces_id", a.replaces_id}};
}

Annotation FromJson(const Json& json) {
  return {json.at("utime"),   json.at("id"),    json.at("annotator"),  json.at("kind"),
          json.at("subject"), json.at("value"), json.at("replaces_id")};
}

}  // namespace

std::string ProblemOf(const Annotation& annotation) {
  if (std::find(kKinds.begin(), kKinds.end(), annotation.kind) == kKinds.end()) return "unknown kind of annotation";
  for (const auto* text : {&annotation.annotator, &annotation.subject, &annotation.value}) {
    if (text->size() > kLongest) return "a text is longer than " + std::to_string(kLongest) + " bytes";
  }
  return "";
}

std::vector<Annotation> InForce(const std::vector<Annotation>& annotations) {
  std::set<int64_t> replaced;
  for (const auto& a : annotations) {
    if (a.replaces_id != 0) replaced.insert(a.replaces_id);
  }
  std::vector<Annotation> current;
  std::copy_if(annotations.begin(), annotations.end(), std::back_inserter(current),
               [&](const auto& a) { return !replaced.contains(a.id) && a.kind != "removed"; });
  return current;
}

AnnotationBook::AnnotationBook(std::filesystem::path file) : file_(std::move(file)) {
  std::ifstream in(file_);
  for (std::string line; std::getline(in, line);) {
    const Json json = Json::parse(line, nullptr, false);
    try {
      all_.push_back(FromJson(json));
      last_id_ = std::max(last_id_, all_.back().id);
    } catch (const Json::exception&) {
      ++unreadable_;
    }
  }
}

Annotation AnnotationBook::Add(Annotation annotation, int64_t now) {
  const std::lock_guard lock(mutex_);
  annotation.id = std::max(now, last_id_ + 1);
  if (!file_.empty()) {
    std::ofstream out(file_, std::ios::app);
    out << ToJson(annotation).dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!out) throw std::runtime_error(file_.string() + ": can't be written");
  }
  last_id_ = annotation.id;
  all_.push_back(annotation);
  return annotation;
}

std::vector<Annotation> AnnotationBook::Current(size_t limit) const {
  const std::lock_guard lock(mutex_);
  std::vector<Annotation> current = InForce(all_);
  if (current.size() > limit) current.erase(current.begin(), current.end() - static_cast<std::ptrdiff_t>(limit));
  return current;
}

}  // namespace coach
