#include "tools/task/task_workshop.h"

#include <unistd.h>

#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/assembly/task_file.h"
#include "tools/operator/json_text.h"
#include "tools/task/picture_book.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A folder of its own that goes with its maker.
class TrialFolder {
 public:
  TrialFolder() {
    static std::atomic<int> count{0};
    path_ = fs::temp_directory_path() / ("coach-task-" + std::to_string(getpid()) + "-" + std::to_string(++count));
    fs::create_directories(path_);
  }
  ~TrialFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Json RemarksJson(const std::vector<Remark>& remarks) {
  Json list = Json::array();
  for (const Remark& remark : remarks)
    list.push_back(
        {{"kind", remark.kind}, {"part", remark.part}, {"other", remark.other}, {"millimetres", remark.millimetres}});
  return list;
}

Json SizeJson(const TriangleMesh& mesh) {
  const MeshExtent extent = Extent(mesh);
  Json size = Json::array();
  for (int k = 0; k < 3; ++k) size.push_back(Rounded((extent.high - extent.low)[k] * 1000, 100));
  return size;
}

}  // namespace

void TaskWorkshop::OnPoses(const PartPoses& poses) {
  const std::lock_guard lock(mutex_);
  learned_.Add(poses);
}

std::string TaskWorkshop::AddMesh(const std::string& name, const std::string& bytes) {
  const fs::path plain = fs::path(name).filename();
  if (plain.empty() || plain != name || name.size() > 120) throw std::invalid_argument("this is no file name");
  const TrialFolder trial;
  const fs::path file = trial.path() / ("mesh" + plain.extension().string());
  std::ofstream(file, std::ios::binary) << bytes;
  std::vector<MeshPiece> pieces;
  try {
    pieces = ReadPieces(file, 0.001);
  } catch (const std::exception& e) {
    throw std::invalid_argument(name + ": " + std::string(e.what()).substr(file.filename().string().size() + 2));
  }
  Json json{{"name", name}, {"pieces", Json::array()}};
  for (auto& piece : pieces) {
    if (piece.name == "mesh") piece.name = plain.stem();
    json["pieces"].push_back(
        {{"name", piece.name}, {"triangles", piece.mesh.triangles.size()}, {"size_mm", SizeJson(piece.mesh)}});
  }
  const std::lock_guard lock(mutex_);
  if (!files_.contains(name) && files_.size() >= kMostFiles) throw std::invalid_argument("too many files");
  files_[name] = std::move(pieces);
  return Dump(json);
}

std::vector<MeshPiece> TaskWorkshop::Pieces(const std::string& file, double scale) const {
  std::vector<MeshPiece> pieces;
  {
    const std::lock_guard lock(mutex_);
    const auto known = files_.find(file);
    if (known == files_.end()) throw std::invalid_argument("the file '" + file + "' was not sent");
    pieces = known->second;
  }
  for (auto& piece : pieces) {
    for (auto& v : piece.mesh.vertices) v *= scale;
  }
  return pieces;
}

LearnedPoses::Result TaskWorkshop::OnTable(const Task* task) const {
  if (!task) throw std::invalid_argument("there is no task whose parts could be on the table");
  const std::lock_guard lock(mutex_);
  return learned_.Mean(*task);
}

TaskDraft TaskWorkshop::DraftOfFiles(const std::string& request, const DraftOptions& options) const {
  const Json asked = Json::parse(request);
  const std::string name = asked.at("name");
  const double scale = asked.value("units", "mm") == "m" ? 1000 : 1;
  std::vector<DraftType> types;
  for (const auto& part : asked.value("parts", Json::array())) {
    TriangleMesh whole;
    for (const auto& piece : Pieces(part.at("file"), scale)) {
      const int first = static_cast<int>(whole.vertices.size());
      whole.vertices.insert(whole.vertices.end(), piece.mesh.vertices.begin(), piece.mesh.vertices.end());
      for (const auto& t : piece.mesh.triangles) whole.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    types.push_back(MakeType(part.at("name"), part.at("colour"), whole, options));
    types.back().count = part.value("count", 1);
  }
  const std::string model = asked.value("model", "");
  if (model.empty()) return {name, types, {}};
  std::vector<MeshPiece> pieces = Pieces(model, scale);
  if (pieces.size() == 1) pieces = Connected(pieces[0]);
  TaskDraft draft = DraftOfModel(name, pieces, types, options);
  const Json colours = asked.value("colours", Json::object());
  for (const auto& [type, colour] : colours.items()) {
    for (auto& one : draft.types) {
      if (one.name == type) one = MakeType(one.name, colour, one.mesh, options), one.count = 0;
    }
  }
  for (auto& type : draft.types) type.count = 0;
  for (const auto& part : draft.parts) ++draft.types[static_cast<size_t>(part.type)].count;
  return draft;
}

std::string TaskWorkshop::Make(const std::string& request, const std::shared_ptr<const Task>& learned) {
  const Json asked = Json::parse(request);
  DraftOptions options;
  try {
    TaskDraft draft;
    if (asked.value("table", false)) {
      const auto mean = OnTable(learned.get());
      if (!mean.problems.empty()) return Dump({{"doubts", RemarksJson(mean.problems)}});
      options.touching = learned_.options().touching;
      draft = DraftOfTable(asked.at("name"), *learned, mean.X_TP);
    } else {
      draft = DraftOfFiles(request, options);
    }
    const TrialFolder trial;
    const Task task = LoadTask(SaveTask(draft, trial.path(), false, options));
    Json json{{"doubts", RemarksJson(Doubts(draft, options))},
              {"parts", Json::array()},
              {"joints", task.connections.size()},
              {"file", ""}};
    for (const auto& type : task.types)
      json["parts"].push_back({{"name", type.name},
                               {"colour", type.colour},
                               {"count", type.count},
                               {"symmetric", !type.symmetries.trivial()}});
    json["picture"] = CoverOf(task);
    if (asked.value("save", false)) {
      const fs::path folder = folder_();
      if (folder.empty()) throw std::invalid_argument("the station has no state folder: set up the table first");
      json["file"] = SaveTask(draft, folder, asked.value("replace", false), options).stem().string();
    }
    return Dump(json);
  } catch (const fs::filesystem_error&) {
    throw;
  } catch (const std::runtime_error& e) {
    throw std::invalid_argument(e.what());
  }
}

std::string BookOf(const fs::path& task_file) {
  const Task task = LoadTask(task_file);
  return BookHtml(task, PictureBook(task));
}

}  // namespace coach
