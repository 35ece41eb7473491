#include "tools/task/mesh_pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/support/test_meshes.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class MeshPiecesTest : public testing::Test {
 protected:
  MeshPiecesTest() { fs::create_directories(folder_); }
  ~MeshPiecesTest() override { fs::remove_all(folder_); }

  fs::path Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::string Refusal(const fs::path& file) const {
    try {
      ReadPieces(file, 0.001);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }

  /// A GLB with one mesh (the box, float positions, 16 bit indices) and two nodes: one moved, its child turned.
  static std::string Glb(const TriangleMesh& mesh) {
    std::string binary;
    for (const auto& v : mesh.vertices) {
      for (int k = 0; k < 3; ++k) {
        const auto x = static_cast<float>(v[k]);
        binary.append(reinterpret_cast<const char*>(&x), 4);
      }
    }
    const size_t positions = binary.size();
    for (const auto& t : mesh.triangles) {
      for (const int k : t) {
        const auto x = static_cast<uint16_t>(k);
        binary.append(reinterpret_cast<const char*>(&x), 2);
      }
    }
    const nlohmann::json json{
        {"asset", {{"version", "2.0"}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes",
         {{{"name", "first"}, {"mesh", 0}, {"translation", {0.5, 0, 0}}, {"children", {1}}},
          {{"name", "second"},
           {"mesh", 0},
           {"translation", {0, 1, 0}},
           {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}}}},
        {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
        {"accessors",
         {{{"bufferView", 0}, {"componentType", 5126}, {"count", mesh.vertices.size()}, {"type", "VEC3"}},
          {{"bufferView", 1}, {"componentType", 5123}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}}}},
        {"bufferViews",
         {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", positions}},
          {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", binary.size() - positions}}}},
        {"buffers", {{{"byteLength", binary.size()}}}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    std::string glb = "glTF";
    const auto number = [&](size_t n) {
      const auto x = static_cast<uint32_t>(n);
      glb.append(reinterpret_cast<const char*>(&x), 4);
    };
    number(2);
    number(12 + 8 + text.size() + 8 + binary.size());
    number(text.size());
    glb += "JSON" + text;
    number(binary.size());
    glb += std::string("BIN\0", 4) + binary;
    return glb;
  }

  const fs::path folder_ = fs::temp_directory_path() / ("coach_pieces_" + std::to_string(getpid()));
};

constexpr const char* kTwoTriangles =
    "o first piece\nv 0 0 0\nv 10 0 0\nv 0 10 0\nf 1/1 2/2 3/3\no second\nv 0 0 5\nv 10 0 5\nv 0 10 5\nv 10 10 5\nf -4 "
    "-3 "
    "-1 -2\n";

TEST_F(MeshPiecesTest, AnObjsObjectsArePieces) {
  const auto pieces = ReadPieces(Write("a.obj", kTwoTriangles), 0.001);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].name, "first piece");
  EXPECT_EQ(pieces[1].mesh.triangles.size(), 2u) << "a square";
  EXPECT_EQ(pieces[1].mesh.vertices.size(), 4u);
  EXPECT_NEAR(pieces[1].mesh.vertices[0].z(), 0.005, 1e-12);
}

TEST_F(MeshPiecesTest, StlOfBothKinds) {
  std::string binary(84, '\0');
  const TriangleMesh box = BoxMesh({0.1, 0.05, 0.03});
  const auto count = static_cast<uint32_t>(box.triangles.size());
  std::memcpy(binary.data() + 80, &count, 4);
  std::string ascii = "solid box\n";
  for (const auto& t : box.triangles) {
    binary.append(12, '\0');
    ascii += "facet normal 0 0 0\nouter loop\n";
    for (const int k : t) {
      ascii += "vertex";
      for (int axis = 0; axis < 3; ++axis) {
        const auto x = static_cast<float>(box.vertices[static_cast<size_t>(k)][axis] * 1000);
        binary.append(reinterpret_cast<const char*>(&x), 4);
        ascii.append(" ").append(std::to_string(x));
      }
      ascii += "\n";
    }
    binary.append(2, '\0');
    ascii += "endloop\nendfacet\n";
  }
  for (const auto& file : {Write("b.stl", binary), Write("a.STL", ascii + "endsolid\n")}) {
    const auto pieces = ReadPieces(file, 0.001);
    ASSERT_EQ(pieces.size(), 1u);
    EXPECT_EQ(pieces[0].mesh.vertices.size(), 8u) << "equal vertices are merged";
    EXPECT_NEAR(SignedVolume(pieces[0].mesh), 0.1 * 0.05 * 0.03, 1e-9);
  }
}

TEST_F(MeshPiecesTest, AGlbsNodesStandWhereTheirTransformsPutThem) {
  const auto pieces = ReadPieces(Write("a.glb", Glb(BoxMesh({0.1, 0.05, 0.03}))), 0.001);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].name, "first");
  EXPECT_NEAR((Extent(pieces[0].mesh).centre - Vector3(0.5, 0, 0)).norm(), 0, 1e-6);
  const MeshExtent second = Extent(pieces[1].mesh);
  EXPECT_NEAR((second.centre - Vector3(0.5, 1, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((second.high - second.low).y(), 0.1, 1e-6) << "turned by a quarter";
  EXPECT_NEAR(SignedVolume(pieces[1].mesh), 0.1 * 0.05 * 0.03, 1e-8);
}

TEST_F(MeshPiecesTest, DamagedFilesAreOneClearError) {
  EXPECT_THAT(Refusal(Write("a.obj", "v 0 0 0\nf 1 2 9\n")), HasSubstr("a.obj: a face names"));
  EXPECT_THAT(Refusal(Write("b.obj", "v 0 0 zero\n")), HasSubstr("three numbers"));
  EXPECT_THAT(Refusal(Write("c.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), testing::Not(""));
  EXPECT_THAT(Refusal(Write("d.stl", "")), HasSubstr("no triangle"));
  EXPECT_THAT(Refusal(Write("e.doc", "x")), HasSubstr("no OBJ"));
  EXPECT_THAT(Refusal(folder_ / "none.obj"), HasSubstr("can't be read"));
  const std::string glb = Glb(BoxMesh({0.1, 0.05, 0.03}));
  std::mt19937 random(3);
  for (int k = 0; k < 800; ++k) {  // damaged in one to four places, or cut: read or refused, nothing else
    std::string bad = glb;
    for (int n = 1 + k % 4; n > 0; --n) bad[random() % bad.size()] = static_cast<char>(random());
    if (k % 5 == 0) bad.resize(random() % bad.size());
    Refusal(Write("f.glb", bad));
  }
}

TEST_F(MeshPiecesTest, AMillionTrianglesAreReadAndTooManyRefused) {
  std::string text = "o sheet\n";
  constexpr int kSide = 710;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x)
      text.append("v ").append(std::to_string(x)).append(" ").append(std::to_string(y)).append(" 0\n");
  }
  for (int y = 0; y + 1 < kSide; ++y) {
    for (int x = 1; x < kSide; ++x) {
      const int a = y * kSide + x, b = a + kSide;
      text.append("f ")
          .append(std::to_string(a))
          .append(" ")
          .append(std::to_string(a + 1))
          .append(" ")
          .append(std::to_string(b + 1))
          .append(" ")
          .append(std::to_string(b))
          .append("\n");
    }
  }
  const auto pieces = ReadPieces(Write("million.obj", text), 0.001);
  EXPECT_GT(pieces.at(0).mesh.triangles.size(), 1'000'000u);
}

TEST_F(MeshPiecesTest, PiecesThatNoTriangleJoinsComeApart) {
  TriangleMesh two = BoxMesh({0.1, 0.05, 0.03});
  const TriangleMesh other = two;
  for (const auto& v : other.vertices) two.vertices.push_back(v + Vector3(1, 0, 0));
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  const auto pieces = Connected({"brick", two});
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].name, "brick_1");
  EXPECT_EQ(pieces[1].mesh.vertices.size(), 8u);
}

}  // namespace
}  // namespace coach
