#include "tools/task/glb_file.h"

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace coach {
namespace {

using Json = nlohmann::json;
using Transform = Eigen::Affine3d;

constexpr int kFloat = 5126, kByte = 5121, kShort = 5123, kInt = 5125;  // component types
constexpr int kTriangles = 4;
constexpr int kDeepest = 64;  // levels of nodes
constexpr size_t kMostNodes = 10'000;

class Glb {
 public:
  Glb(const std::string& bytes, std::string fallback) : fallback_(std::move(fallback)) {
    if (bytes.size() < 20 || bytes.compare(0, 4, "glTF") != 0) throw std::runtime_error("is no GLB file");
    for (size_t at = 12; at + 8 <= bytes.size();) {
      uint32_t size = 0;
      std::memcpy(&size, bytes.data() + at, 4);
      if (size > bytes.size() - at - 8) throw std::runtime_error("ends too early");
      const std::string kind = bytes.substr(at + 4, 4);
      if (kind == "JSON") json_ = Json::parse(bytes.substr(at + 8, size));
      if (kind == std::string("BIN\0", 4)) binary_ = bytes.substr(at + 8, size);
      at += 8 + size;
    }
    if (!json_.is_object()) throw std::runtime_error("has no JSON");
  }

  std::vector<MeshPiece> Read() {
    const Json& scene = json_.at("scenes").at(json_.value("scene", size_t{0}));
    for (const auto& node : scene.at("nodes")) AddNode(node.get<size_t>(), Transform::Identity(), 0);
    return std::move(pieces_);
  }

 private:
  static Transform TransformOf(const Json& node) {
    Transform X = Transform::Identity();
    if (node.contains("matrix")) {
      const auto m = node.at("matrix").get<std::array<double, 16>>();
      X.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
      return X;
    }
    const auto t = node.value("translation", std::array<double, 3>{0, 0, 0});
    const auto q = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
    const auto s = node.value("scale", std::array<double, 3>{1, 1, 1});
    X.translate(Vector3(t[0], t[1], t[2]));
    X.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized());
    X.scale(Vector3(s[0], s[1], s[2]));
    return X;
  }

  void AddNode(size_t index, const Transform& X_parent, int depth) {
    if (depth > kDeepest || ++nodes_ > kMostNodes) throw std::runtime_error("has nodes that go round in circles");
    const Json& node = json_.at("nodes").at(index);
    const Transform X = X_parent * TransformOf(node);
    if (node.contains("mesh")) {
      const Json& mesh = json_.at("meshes").at(node.at("mesh").get<size_t>());
      MeshPiece piece{node.value("name", mesh.value("name", fallback_)), {}};
      for (const auto& primitive : mesh.at("primitives")) AddPrimitive(primitive, X, piece.mesh);
      pieces_.push_back(std::move(piece));
    }
    for (const auto& child : node.value("children", Json::array())) AddNode(child.get<size_t>(), X, depth + 1);
  }

  void AddPrimitive(const Json& primitive, const Transform& X, TriangleMesh& mesh) const {
    if (primitive.value("mode", kTriangles) != kTriangles) return;
    const int first = static_cast<int>(mesh.vertices.size());
    const Accessor points = Open(primitive.at("attributes").at("POSITION").get<size_t>(), 3);
    if (points.component != kFloat) throw std::runtime_error("has positions that are no floats");
    for (size_t k = 0; k < points.count; ++k) {
      std::array<float, 3> p;
      std::memcpy(p.data(), points.data + k * points.stride, 12);
      mesh.vertices.push_back(X * Vector3(p[0], p[1], p[2]));
    }
    const auto add = [&](size_t a, size_t b, size_t c) {
      if (std::max({a, b, c}) >= points.count) throw std::runtime_error("has a triangle without vertices");
      mesh.triangles.push_back({first + static_cast<int>(a), first + static_cast<int>(b), first + static_cast<int>(c)});
    };
    if (!primitive.contains("indices")) {
      for (size_t k = 0; k + 2 < points.count; k += 3) add(k, k + 1, k + 2);
      return;
    }
    const Accessor indices = Open(primitive.at("indices").get<size_t>(), 1);
    for (size_t k = 0; k + 2 < indices.count; k += 3) add(indices.Index(k), indices.Index(k + 1), indices.Index(k + 2));
  }

  struct Accessor {
    const char* data = nullptr;
    size_t count = 0, stride = 0;
    int component = 0;
    size_t Index(size_t k) const {
      uint32_t index = 0;  // little endian
      std::memcpy(&index, data + k * stride, component == kInt ? 4 : component == kShort ? 2 : 1);
      return index;
    }
  };

  Accessor Open(size_t index, size_t components) const {
    const Json& accessor = json_.at("accessors").at(index);
    if (accessor.contains("sparse") || !accessor.contains("bufferView"))
      throw std::runtime_error("is compressed: export it without compression");
    const Json& view = json_.at("bufferViews").at(accessor.at("bufferView").get<size_t>());
    if (view.at("buffer").get<size_t>() != 0) throw std::runtime_error("keeps its geometry in another file");
    Accessor open;
    open.component = accessor.at("componentType").get<int>();
    const size_t size = open.component == kByte ? 1 : open.component == kShort ? 2 : 4;
    if (open.component != kByte && open.component != kShort && open.component != kInt && open.component != kFloat)
      throw std::runtime_error("has numbers of an unknown kind");
    open.count = accessor.at("count").get<size_t>();
    open.stride = std::max(view.value("byteStride", size_t{0}), size * components);
    const size_t from = view.value("byteOffset", size_t{0}), more = accessor.value("byteOffset", size_t{0});
    if (from > binary_.size() || more > binary_.size() - from || open.count > binary_.size() || open.stride > 4096 ||
        (open.count > 0 && (open.count - 1) * open.stride + size * components > binary_.size() - from - more))
      throw std::runtime_error("ends too early");
    open.data = binary_.data() + from + more;
    return open;
  }

  std::string fallback_;
  Json json_;
  std::string binary_;
  std::vector<MeshPiece> pieces_;
  size_t nodes_ = 0;
};

}  // namespace

std::vector<MeshPiece> ReadGlb(const std::string& bytes, const std::string& fallback) {
  return Glb(bytes, fallback).Read();
}

}  // namespace coach
