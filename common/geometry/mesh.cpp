#include "common/geometry/mesh.h"

#include <open3d/geometry/TriangleMesh.h>
#include <open3d/io/TriangleMeshIO.h>
#include <open3d/utility/Logging.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "common/geometry/ply_file.h"

namespace coach {

Vector3 TriangleMesh::Normal(size_t triangle) const {
  const auto& t = triangles[triangle];
  return (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]).normalized();
}

double TriangleMesh::Area(size_t triangle) const {
  const auto& t = triangles[triangle];
  return 0.5 * (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]).norm();
}

MeshExtent Extent(const TriangleMesh& mesh) {
  MeshExtent e{mesh.vertices.at(0), mesh.vertices.at(0), Vector3::Zero(), 0};
  for (const Vector3& v : mesh.vertices) {
    e.low = e.low.cwiseMin(v);
    e.high = e.high.cwiseMax(v);
  }
  e.centre = (e.low + e.high) / 2;
  if (mesh.vertices.size() <= 500) {
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      for (size_t j = 0; j < i; ++j) e.diameter = std::max(e.diameter, (mesh.vertices[i] - mesh.vertices[j]).norm());
    }
    return e;
  }
  // Extreme vertices along directions 11 degrees apart: off by at most 1 - cos(11 / 2 degrees).
  constexpr int kDirections = 400;
  for (int k = 0; k < kDirections; ++k) {
    const double z = (k + 0.5) / kDirections, phi = k * 2.399963229728653;
    const Vector3 d(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
    double low = 1e300, high = -1e300;
    for (const Vector3& v : mesh.vertices) {
      low = std::min(low, d.dot(v));
      high = std::max(high, d.dot(v));
    }
    e.diameter = std::max(e.diameter, high - low);
  }
  return e;
}

std::vector<SurfacePoint> SampleSurface(const TriangleMesh& mesh, int n) {
  std::vector<double> cumulative;
  double total = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) cumulative.push_back(total += mesh.Area(t));
  std::vector<SurfacePoint> out;
  out.reserve(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    const double at = (i + 0.5) / n * total;
    const size_t t =
        static_cast<size_t>(std::lower_bound(cumulative.begin(), cumulative.end(), at) - cumulative.begin());
    // The R2 sequence within the triangle (M. Roberts, "The unreasonable effectiveness of quasirandom sequences",
    // 2018).
    const double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    const double r = std::sqrt(u);
    const auto& c = mesh.triangles[std::min(t, mesh.triangles.size() - 1)];
    out.push_back({(1 - r) * mesh.vertices[c[0]] + r * (1 - v) * mesh.vertices[c[1]] + r * v * mesh.vertices[c[2]],
                   mesh.Normal(std::min(t, mesh.triangles.size() - 1))});
  }
  return out;
}

double SignedVolume(const TriangleMesh& mesh) {
  double v = 0;
  const Vector3 o = mesh.vertices.empty() ? Vector3::Zero() : mesh.vertices[0];
  for (const auto& t : mesh.triangles)
    v += (mesh.vertices[t[0]] - o).dot((mesh.vertices[t[1]] - o).cross(mesh.vertices[t[2]] - o)) / 6;
  return v;
}

/// Open3D's own PLY reader trusts what the file says of itself, so that a damaged one can end the process.
static open3d::geometry::TriangleMesh ReadFile(const std::filesystem::path& file) {
  open3d::geometry::TriangleMesh read;
  if (file.extension() != ".ply" && file.extension() != ".PLY") {
    open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
    if (!open3d::io::ReadTriangleMesh(file.string(), read)) read.Clear();
    return read;
  }
  const TriangleMesh mesh = ReadPly(file);
  read.vertices_ = mesh.vertices;
  for (const auto& t : mesh.triangles) read.triangles_.emplace_back(t[0], t[1], t[2]);
  return read;
}

TriangleMesh ReadMesh(const std::filesystem::path& file, double metres_per_unit) {
  const auto fail = [&](const std::string& what) { throw std::runtime_error("mesh " + file.string() + ": " + what); };
  if (!std::filesystem::exists(file)) fail("no such file");
  open3d::geometry::TriangleMesh read;
  try {
    read = ReadFile(file);
  } catch (const std::exception& e) {
    fail(e.what());
  }
  if (read.vertices_.empty()) fail("can't be read as PLY, OBJ or STL");
  const int named = static_cast<int>(read.vertices_.size());
  for (const Eigen::Vector3i& t : read.triangles_) {
    if (t.minCoeff() < 0 || t.maxCoeff() >= named) fail("a triangle names a vertex that does not exist");
  }
  read.RemoveDuplicatedVertices();
  TriangleMesh mesh;
  for (const Eigen::Vector3d& v : read.vertices_) {
    if (!v.allFinite()) fail("a vertex is not finite");
    mesh.vertices.push_back(v * metres_per_unit);
  }
  for (const Eigen::Vector3i& t : read.triangles_) {
    mesh.triangles.push_back({t[0], t[1], t[2]});
    if (!(mesh.Area(mesh.triangles.size() - 1) > 1e-14)) mesh.triangles.pop_back();
  }
  if (mesh.triangles.empty()) fail("no triangle with an area");
  if (!(Extent(mesh).diameter > 1e-4)) fail("smaller than 0.1 mm: are the units right?");
  if (SignedVolume(mesh) < 0) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

void WritePly(const std::filesystem::path& file, const TriangleMesh& mesh, double units_per_metre) {
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  out.precision(9);
  for (const Vector3& v : mesh.vertices)
    out << v.x() * units_per_metre << ' ' << v.y() * units_per_metre << ' ' << v.z() * units_per_metre << '\n';
  for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  out.flush();
  if (!out) throw std::runtime_error("mesh " + file.string() + ": can't be written");
}

}  // namespace coach
