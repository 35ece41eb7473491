// What people say happened: true events, notes, answers to the questionnaire. Kept as one JSON object a line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

namespace coach {

/// See lcmtypes/annotation_t.lcm.
struct Annotation {
  int64_t utime = 0;
  int64_t id = 0;
  std::string annotator;
  std::string kind;  ///< connect, wrong, disconnect, note, questionnaire, removed
  std::string subject;
  std::string value;
  int64_t replaces_id = 0;  ///< 0 none
};

/// Empty if it can be kept, else what is wrong: a kind that is not on the list, or a text of over 2000 bytes.
std::string ProblemOf(const Annotation& annotation);

/// Those that are not replaced by another one and are not 'removed', in the same order.
std::vector<Annotation> InForce(const std::vector<Annotation>& annotations);

/// Thread safe.
class AnnotationBook {
 public:
  /// Goes on with what the file holds; lines that can't be read are left alone and counted. An empty name: memory only.
  explicit AnnotationBook(std::filesystem::path file);

  /// Gives it an id, keeps it, appends it to the file.
  /// @throws std::runtime_error naming the file if it can't be written; the annotation is not kept then.
  Annotation Add(Annotation annotation, int64_t now);

  /// In force: not replaced by a later one, newest last, at most `limit`.
  std::vector<Annotation> Current(size_t limit) const;
  size_t unreadable_lines() const { return unreadable_; }

 private:
  const std::filesystem::path file_;
  mutable std::mutex mutex_;
  std::vector<Annotation> all_;
  int64_t last_id_ = 0;
  size_t unreadable_ = 0;
};

}  // namespace coach
