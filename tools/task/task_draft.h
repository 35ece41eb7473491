// A task in the making: parts, and where each of them is in the finished structure.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"
#include "tools/task/mesh_pieces.h"
#include "tools/task/remark.h"

namespace coach {

struct DraftType {
  std::string name;
  int count = 1;
  std::string colour;  ///< a word of ColourWords()
  TriangleMesh mesh;   ///< m; MiddleOf(mesh) is the origin
  SymmetryGroup symmetries;
  HsvRange hsv;  ///< by which the camera finds it until the set-up says better
};

struct PlacedPart {
  std::string slot;
  int type = 0;                  ///< index into TaskDraft::types
  Pose X_FP = Pose::Identity();  ///< in the finished structure
};

struct TaskDraft {
  std::string name;
  std::vector<DraftType> types;
  std::vector<PlacedPart> parts;  ///< empty: a task that is only tracked
};

struct DraftOptions {
  size_t most_triangles = 20'000;  ///< finer meshes are simplified
  double touching = 0.0015;        ///< m; parts this near are connected
};

/// Words that the robot can say for colours, each with the range that finds it in common light.
const std::map<std::string, HsvRange>& ColourWords();

/// A part type from a mesh file's content: moved to its middle, simplified, its symmetries found.
DraftType MakeType(const std::string& name, const std::string& colour, const TriangleMesh& mesh,
                   const DraftOptions& options = {});

/// A draft from a finished model: pieces where they are in the end. Pieces that lie on a type of `known` are that type;
/// the rest are grouped by shape into new types, named after the pieces. Colours of new types are words in turn.
/// @throws std::runtime_error if a piece is on no type and `known` is not empty.
TaskDraft DraftOfModel(const std::string& name, const std::vector<MeshPiece>& pieces,
                       const std::vector<DraftType>& known, const DraftOptions& options = {});

/// Pairs of placed parts that touch (indices into TaskDraft::parts), in an order in which each joins what is there
/// already; `closing` are those that need not be asked for because they close a ring.
struct Contacts {
  std::vector<std::pair<int, int>> joining, closing;
};
Contacts FindContacts(const TaskDraft& draft, const DraftOptions& options = {});

/// What a person should look at: parts that overlap, that touch nothing, that are too small to see ...
std::vector<Remark> Doubts(const TaskDraft& draft, const DraftOptions& options = {});

/// The task file's text; meshes are in `mesh_folder` beside it as TYPE.ply, mm.
std::string TaskFileText(const TaskDraft& draft, const Contacts& contacts, const std::string& mesh_folder);

/// Writes NAME.yaml and NAME/TYPE.ply into a folder (NAME: the draft's name, what is no letter, digit, - or _ made _)
/// and reads them back with the loader's own checks; nothing is left if they fail. @return the file
/// @throws ConfigurationError or std::runtime_error saying what is wrong; also if a task of this name is there and
/// `replace` is false.
std::filesystem::path SaveTask(const TaskDraft& draft, const std::filesystem::path& folder, bool replace = false,
                               const DraftOptions& options = {});

}  // namespace coach
