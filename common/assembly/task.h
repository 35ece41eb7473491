// What is to be built: part types, their instances, slots, connections, known mistakes, steps. See docs/formats.md.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/geometry/pose.h"
#include "common/geometry/symmetry.h"

namespace coach {

/// OpenCV's 8-bit HSV: hue 0..179, saturation and value 0..255. A low hue above the high one wraps through red.
struct HsvRange {
  std::array<int, 3> low{0, 0, 0};
  std::array<int, 3> high{179, 255, 255};
  bool operator==(const HsvRange&) const = default;
};

/// A kind of part; equal parts are interchangeable.
struct PartType {
  std::string name;
  int count = 1;                    ///< instances
  std::filesystem::path mesh_file;  ///< absolute
  TriangleMesh mesh;                ///< m
  int bop_id = 0;                   ///< object id in BOP files
  std::string colour;               ///< word for speech, looked up in the phrase files
  HsvRange hsv;
  SymmetryGroup symmetries;
};

/// One physical part. Its index in Task::parts is its index in every message.
struct Part {
  std::string name;  ///< type_1, type_2, ...
  int type = 0;      ///< index into Task::types
};

/// A place in the finished structure; takes any part of its type.
struct Slot {
  std::string name;
  int type = 0;
};

/// What a joint leaves free. Rigid: nothing. The others: motion along or about `axis` (frame of the first slot's part)
/// through `point`, from `low` to `high` (m or rad) measured from the task's relative pose.
struct JointFreedom {
  enum class Kind { kRotation, kTranslation };
  Kind kind = Kind::kRotation;
  Vector3 axis = Vector3::UnitZ();
  Vector3 point = Vector3::Zero();
  double low = 0, high = 0;
};

/// A required relative pose X_AB of the part in slot_b in the frame of the part in slot_a.
struct Connection {
  std::string name;
  int slot_a = 0, slot_b = 0;
  Pose X_AB = Pose::Identity();
  bool closes_by_itself = false;      ///< hint for the steps: not asked for
  std::vector<JointFreedom> freedom;  ///< empty: rigid
};

/// A known wrong connection between two part types.
struct Mistake {
  std::string name;
  int type_a = 0, type_b = 0;
  Pose X_AB = Pose::Identity();
};

struct Task {
  std::string name;
  std::filesystem::path file;  ///< empty if not from a file
  std::string sha256;          ///< of the file, hex
  std::vector<PartType> types;
  std::vector<Part> parts;  ///< instances, in the order of the file
  std::vector<Slot> slots;
  std::vector<Connection> connections;
  std::vector<Mistake> mistakes;
  std::vector<int> steps;  ///< indices of connections, default order of asking
  /// Accepted sets of connections: the task's own first, then the file's `variants`. Empty if there are no connections.
  std::vector<std::vector<int>> variants;

  const PartType& TypeOf(int part) const { return types[static_cast<size_t>(parts[static_cast<size_t>(part)].type)]; }
  /// Colour class of a type: types with equal HSV ranges share one. Classes are numbered in the order of first use.
  int ColourClass(int type) const;
  int NumColourClasses() const;
};

}  // namespace coach
