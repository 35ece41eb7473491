// New tasks through the page: takes mesh files, makes a draft, shows it, saves it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "tools/task/learned_poses.h"
#include "tools/task/task_draft.h"

namespace coach {

/// Thread safe. JSON in, JSON out; the other side is tools/operator/page/new_task.js.
class TaskWorkshop {
 public:
  static constexpr size_t kLargestFile = 64 * 1024 * 1024;  ///< bytes
  static constexpr size_t kMostFiles = 40;

  /// @param folder where new tasks go; called at each use
  explicit TaskWorkshop(std::function<std::filesystem::path()> folder) : folder_(std::move(folder)) {}

  /// What the tracker sees, for tasks that are learned from the table.
  void OnPoses(const PartPoses& poses);

  /// Keeps a mesh file for the next draft. @param name file name with its ending; @param unit mm or m
  /// -> {name, pieces: [{name, triangles, size_mm: [x, y, z]}]}
  /// @throws std::invalid_argument or std::runtime_error saying what is wrong with it
  std::string AddMesh(const std::string& name, const std::string& bytes);

  /// {name, units, parts: [{file, name, colour, count}], model: file or "", table: bool, save: bool, replace: bool}
  /// -> {doubts: [{kind, part, other, millimetres}], parts: [{name, colour, count, symmetric}], joints, picture: SVG of
  /// the whole, file: "" unless saved}; {doubts} alone if the parts on the table can't be learned
  /// @param learned the lesson's task, whose parts are on the table; may be null
  /// @throws as AddMesh does
  std::string Make(const std::string& request, const std::shared_ptr<const Task>& learned);

 private:
  LearnedPoses::Result OnTable(const Task* task) const;
  TaskDraft DraftOfFiles(const std::string& request, const DraftOptions& options) const;
  std::vector<MeshPiece> Pieces(const std::string& file, double metres_per_unit) const;

  const std::function<std::filesystem::path()> folder_;
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<MeshPiece>> files_;  // as if in metres
  LearnedPoses learned_;
};

/// The picture book of a task file as one HTML page. @throws ConfigurationError
std::string BookOf(const std::filesystem::path& task_file);

}  // namespace coach
