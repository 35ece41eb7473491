#include "common/geometry/mesh.h"

#include <gtest/gtest.h>

#include <fstream>

namespace coach {
namespace {

TriangleMesh Box(const Vector3& h) {
  TriangleMesh m;
  for (int i = 0; i < 8; ++i)
    m.vertices.emplace_back(i & 1 ? h.x() : -h.x(), i & 2 ? h.y() : -h.y(), i & 4 ? h.z() : -h.z());
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

std::filesystem::path Temp(const std::string& name) { return std::filesystem::path(testing::TempDir()) / name; }

TEST(MeshTest, VolumeAndExtentOfABox) {
  const TriangleMesh m = Box({0.1, 0.2, 0.3});
  EXPECT_NEAR(SignedVolume(m), 8 * 0.006, 1e-12);
  EXPECT_NEAR(Extent(m).diameter, 2 * Vector3(0.1, 0.2, 0.3).norm(), 1e-12);
  for (size_t t = 0; t < m.triangles.size(); ++t) EXPECT_GT(m.Normal(t).dot(m.vertices[m.triangles[t][0]]), 0);
}

TEST(MeshTest, SamplesLieOnTheSurfaceInProportionToArea) {
  const TriangleMesh m = Box({0.1, 0.1, 0.2});
  int top = 0;
  const auto points = SampleSurface(m, 2000);
  for (const SurfacePoint& s : points) {
    EXPECT_NEAR((s.p.cwiseAbs().array() / Eigen::Array3d(0.1, 0.1, 0.2)).maxCoeff(), 1, 1e-9);
    top += s.n.z() > 0.99;
  }
  EXPECT_NEAR(top, 2000.0 * 1 / 10, 3);  // top: 0.04 of 0.4 m^2
}

TEST(MeshTest, RoundTripThroughPlyAndInsideOutIsTurned) {
  TriangleMesh m = Box({0.1, 0.2, 0.3});
  for (auto& t : m.triangles) std::swap(t[0], t[1]);
  WritePly(Temp("box.ply"), m, 1000);
  const TriangleMesh read = ReadMesh(Temp("box.ply"), 0.001);
  EXPECT_EQ(read.vertices.size(), 8u);
  EXPECT_NEAR(SignedVolume(read), 0.048, 1e-9);
}

TEST(MeshTest, BadFilesAreNamed) {
  const auto error = [](const std::string& name, const std::string& content) {
    std::ofstream(Temp(name)) << content;
    try {
      ReadMesh(Temp(name), 0.001);
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error("empty.ply", "").find("empty.ply"), std::string::npos);
  EXPECT_NE(error("garbage.ply", "ply\nformat ascii 1.0\nelement vertex 9\nend_header\n1 2\n").find("garbage.ply"),
            std::string::npos);
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
      "1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_NE(error("zero.ply", head + "0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n"), "");
  EXPECT_NE(error("nan.ply", head + "0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n"), "");
  EXPECT_NE(error("index.ply", head + "0 0 0\n10 0 0\n0 10 0\n3 0 1 7\n"), "");
  EXPECT_THROW(ReadMesh(Temp("nothing_here.ply"), 1), std::runtime_error);
}

}  // namespace
}  // namespace coach
