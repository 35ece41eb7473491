#include "tools/task/mesh_pieces.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <unordered_map>

#include "tools/task/glb_file.h"

namespace coach {
namespace {

constexpr size_t kMostTriangles = 5'000'000;
constexpr double kSameVertex = 1e-6;  // m
constexpr double kLeastArea = 1e-14;  // m^2

std::string Bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("can't be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The next word of a line, which is cut from it; empty at its end.
std::string_view NextWord(std::string_view& line) {
  const size_t first = std::min(line.find_first_not_of(" \t\r"), line.size());
  const size_t end = std::min(line.find_first_of(" \t\r", first), line.size());
  const std::string_view word = line.substr(first, end - first);
  line.remove_prefix(end);
  return word;
}

double NumberOf(std::string_view word) {
  double number = 0;
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  if (std::from_chars(word.data(), word.data() + word.size(), number).ec != std::errc())
    throw std::runtime_error("a vertex has no three numbers");
  return number;
}

/// Index of an OBJ's vertex: counted from 1, or from the end if negative; texture and normal are left away.
int ObjVertex(std::string_view word, size_t vertices) {
  int index = 0;
  std::from_chars(word.data(), word.data() + word.size(), index);
  const int64_t found = index > 0 ? index - 1 : static_cast<int64_t>(vertices) + index;
  if (index == 0 || found < 0 || found >= static_cast<int64_t>(vertices))
    throw std::runtime_error("a face names a vertex that does not exist");
  return static_cast<int>(found);
}

std::vector<MeshPiece> ReadObj(const std::string& bytes, const std::string& stem) {
  std::vector<Vector3> vertices;
  std::vector<MeshPiece> pieces{{stem, {}}};
  std::vector<int> corners;
  for (size_t at = 0; at < bytes.size();) {
    const size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view line(bytes.data() + at, end - at);
    at = end + 1;
    const std::string_view word = NextWord(line);
    if (word == "v") {
      const double x = NumberOf(NextWord(line)), y = NumberOf(NextWord(line)), z = NumberOf(NextWord(line));
      vertices.emplace_back(x, y, z);
    } else if (word == "o" || word == "g") {
      if (!pieces.back().mesh.triangles.empty()) pieces.emplace_back();
      const size_t first = line.find_first_not_of(" \t"), last = line.find_last_not_of(" \t\r");
      pieces.back().name = first == std::string_view::npos ? stem : std::string(line.substr(first, last + 1 - first));
    } else if (word == "f") {
      corners.clear();
      for (auto corner = NextWord(line); !corner.empty(); corner = NextWord(line))
        corners.push_back(ObjVertex(corner, vertices.size()));
      for (size_t k = 2; k < corners.size(); ++k)
        pieces.back().mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  for (auto& piece : pieces) piece.mesh.vertices = vertices;
  return pieces;
}

TriangleMesh ReadStl(const std::string& bytes) {
  TriangleMesh mesh;
  const auto add = [&](const std::array<Vector3, 3>& corners) {
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() >= 84 && bytes.size() == 84 + 50 * static_cast<uint64_t>(count)) {
    for (uint32_t k = 0; k < count; ++k) {
      std::array<float, 9> numbers;
      std::memcpy(numbers.data(), bytes.data() + 84 + 50 * static_cast<size_t>(k) + 12, 36);
      add({Vector3(numbers[0], numbers[1], numbers[2]), Vector3(numbers[3], numbers[4], numbers[5]),
           Vector3(numbers[6], numbers[7], numbers[8])});
    }
    return mesh;
  }
  std::istringstream in(bytes);
  std::string word;
  std::array<Vector3, 3> corners;
  for (int corner = 0; in >> word;) {
    if (word != "vertex") continue;
    Vector3& v = corners[static_cast<size_t>(corner)];
    if (!(in >> v.x() >> v.y() >> v.z())) throw std::runtime_error("a vertex has no three numbers");
    corner = (corner + 1) % 3;
    if (corner == 0) add(corners);
  }
  return mesh;
}

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::vector<MeshPiece> ReadAny(const std::filesystem::path& file) {
  const std::string ending = Lower(file.extension().string()), stem = file.stem().string();
  if (ending == ".obj") return ReadObj(Bytes(file), stem);
  if (ending == ".stl") return {{stem, ReadStl(Bytes(file))}};
  if (ending == ".glb") return ReadGlb(Bytes(file), stem);
  if (ending == ".ply") return {{stem, ReadMesh(file, 1)}};
  throw std::runtime_error("is no OBJ, STL, PLY or GLB file");
}

int Root(std::vector<int>& parent, int k) {
  while (parent[static_cast<size_t>(k)] != k)
    k = parent[static_cast<size_t>(k)] = parent[static_cast<size_t>(parent[static_cast<size_t>(k)])];
  return k;
}

}  // namespace

TriangleMesh Cleaned(const TriangleMesh& mesh) {
  TriangleMesh out;
  std::unordered_map<std::string, int> known;
  std::vector<int> moved(mesh.vertices.size(), -1);
  const auto vertex = [&](int k) {
    int& target = moved[static_cast<size_t>(k)];
    if (target >= 0) return target;
    const Vector3& v = mesh.vertices[static_cast<size_t>(k)];
    if (!v.allFinite() || v.cwiseAbs().maxCoeff() > 1e3)
      throw std::runtime_error("a vertex is not finite or a kilometre away");
    std::array<int64_t, 3> cell;
    for (int axis = 0; axis < 3; ++axis) cell[static_cast<size_t>(axis)] = std::llround(v[axis] / kSameVertex);
    std::string key(sizeof cell, '\0');
    std::memcpy(key.data(), cell.data(), sizeof cell);
    const auto [entry, is_new] = known.try_emplace(key, static_cast<int>(out.vertices.size()));
    if (is_new) out.vertices.push_back(v);
    return target = entry->second;
  };
  for (const auto& t : mesh.triangles) {
    out.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
    if (!(out.Area(out.triangles.size() - 1) > kLeastArea)) out.triangles.pop_back();
  }
  if (SignedVolume(out) < 0) {
    for (auto& t : out.triangles) std::swap(t[1], t[2]);
  }
  return out;
}

std::vector<MeshPiece> ReadPieces(const std::filesystem::path& file, double metres_per_unit) {
  try {
    std::vector<MeshPiece> pieces = ReadAny(file), out;
    const double scale = Lower(file.extension().string()) == ".glb" ? 1 : metres_per_unit;
    size_t triangles = 0;
    for (auto& piece : pieces) {
      if ((triangles += piece.mesh.triangles.size()) > kMostTriangles)
        throw std::runtime_error("has over 5 million triangles");
      for (auto& v : piece.mesh.vertices) v *= scale;
      piece.mesh = Cleaned(piece.mesh);
      if (!piece.mesh.triangles.empty()) out.push_back(std::move(piece));
    }
    if (out.empty()) throw std::runtime_error("has no triangle with an area");
    return out;
  } catch (const std::exception& e) {
    throw std::runtime_error(file.filename().string() + ": " + e.what());
  }
}

std::vector<MeshPiece> Connected(const MeshPiece& piece) {
  std::vector<int> parent(piece.mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const auto& t : piece.mesh.triangles) {
    parent[static_cast<size_t>(Root(parent, t[1]))] = Root(parent, t[0]);
    parent[static_cast<size_t>(Root(parent, t[2]))] = Root(parent, t[0]);
  }
  std::vector<MeshPiece> pieces;
  std::unordered_map<int, size_t> piece_of;
  for (const auto& t : piece.mesh.triangles) {
    const auto [entry, is_new] = piece_of.try_emplace(Root(parent, t[0]), pieces.size());
    if (is_new) pieces.push_back({piece.name, {piece.mesh.vertices, {}}});
    pieces[entry->second].mesh.triangles.push_back(t);
  }
  for (auto& one : pieces) one.mesh = Cleaned(one.mesh);
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const auto& a, const auto& b) { return a.mesh.triangles.size() > b.mesh.triangles.size(); });
  for (size_t k = 0; pieces.size() > 1 && k < pieces.size(); ++k)
    pieces[k].name.append("_").append(std::to_string(k + 1));
  return pieces;
}

TriangleMesh ReadWhole(const std::filesystem::path& file, double metres_per_unit) {
  TriangleMesh all;
  for (const auto& piece : ReadPieces(file, metres_per_unit)) {
    const int first = static_cast<int>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), piece.mesh.vertices.begin(), piece.mesh.vertices.end());
    for (const auto& t : piece.mesh.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

}  // namespace coach
