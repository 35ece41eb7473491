#include "common/geometry/ply_file.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace coach {
namespace {

using testing::HasSubstr;

class PlyFile : public testing::Test {
 protected:
  ~PlyFile() override { std::filesystem::remove(file_); }
  TriangleMesh Read(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary) << bytes;
    return ReadPly(file_);
  }
  std::string Refusal(const std::string& bytes) const {
    try {
      Read(bytes);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "accepted";
  }

  std::filesystem::path file_ = std::filesystem::temp_directory_path() / ("coach_ply_" + std::to_string(getpid()));
};

std::string Header(const std::string& format, const std::string& vertices = "4", const std::string& faces = "2") {
  return "ply\r\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " + vertices +
         "\nproperty uchar red\nproperty float x\nproperty double y\nproperty short z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nproperty list ushort float texcoord\nend_header\n";
}

template <class T>
void Put(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// A square of side 2 as one quadrangle, and a triangle.
std::string Binary(bool big_endian) {
  std::string bytes = Header(big_endian ? "binary_big_endian" : "binary_little_endian");
  const double corners[4][3] = {{0, 0, -3}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0.}};
  for (const auto& c : corners) {
    Put<uint8_t>(bytes, 200, big_endian);
    Put<float>(bytes, static_cast<float>(c[0]), big_endian);
    Put<double>(bytes, c[1], big_endian);
    Put<int16_t>(bytes, static_cast<int16_t>(c[2]), big_endian);
  }
  for (const auto& face : {std::vector<int>{0, 1, 2, 3}, std::vector<int>{3, 2, 1}}) {
    Put<uint8_t>(bytes, static_cast<uint8_t>(face.size()), big_endian);
    for (const int i : face) Put<int32_t>(bytes, i, big_endian);
    Put<uint16_t>(bytes, 2, big_endian);
    for (int i = 0; i < 2; ++i) Put<float>(bytes, 0.5f, big_endian);
  }
  return bytes;
}

constexpr char kAsciiBody[] =
    "200 0 0 -3\n200 2 +0.0 0\n 200 2e0 2 0\n200 0 2 0\n4 0 1 2 3 2 .5 .5\n3 3 2 1 2 0.5 0.5\n";

TEST_F(PlyFile, TheThreeFormatsAreTheSame) {
  for (const auto& bytes : {Header("ascii") + kAsciiBody, Binary(false), Binary(true)}) {
    const TriangleMesh mesh = Read(bytes);
    ASSERT_EQ(mesh.vertices.size(), 4U);
    EXPECT_EQ(mesh.vertices[0], Vector3(0, 0, -3));
    EXPECT_EQ(mesh.vertices[2], Vector3(2, 2, 0));
    using Triangles = std::vector<std::array<int, 3>>;
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {3, 2, 1}}));
  }
}

TEST_F(PlyFile, EveryShorterFileIsRefused) {
  for (const auto& bytes :
       {Binary(false), Header("ascii") + "200 0 0 -3\n200 2 0 0\n200 2 2 0\n200 0 2 0\n3 0 1 2 0\n3 3 2 1"}) {
    for (size_t size = 0; size + 1 < bytes.size(); ++size)
      EXPECT_NE(Refusal(bytes.substr(0, size)), "accepted") << size;
  }
}

TEST_F(PlyFile, NothingIsBelievedBeforeItWasChecked) {
  EXPECT_THAT(Refusal("solid stl\n"), HasSubstr("no PLY"));
  EXPECT_THAT(Refusal(Header("ascii", "3000000000") + kAsciiBody), HasSubstr("more elements 'vertex'"));
  EXPECT_THAT(Refusal(Header("ascii", "-1") + kAsciiBody), HasSubstr("more elements 'vertex'"));
  EXPECT_THAT(Refusal(Header("ternary") + kAsciiBody), HasSubstr("'ternary'"));
  const std::string three = "0 0 0 0\n0 2 0 0\n0 2 2 0\n";
  EXPECT_THAT(Refusal(Header("ascii", "3", "1") + three + "3 0 1 3 0\n"), HasSubstr("does not exist"));
  EXPECT_THAT(Refusal(Header("ascii", "3", "1") + three + "3 0 1 -1 0\n"), HasSubstr("does not exist"));
  EXPECT_THAT(Refusal(Header("ascii", "3", "1") + three + "3 0 1 0.5 0\n"), HasSubstr("does not exist"));
  EXPECT_THAT(Refusal(Header("ascii", "3", "1") + three + "999999 0 1 2 0\n"), HasSubstr("longer than the file"));
  EXPECT_THAT(Refusal(Header("ascii", "3", "1") + three + "3 0 x 2 0\n"), HasSubstr("'x' is no number"));
  EXPECT_THAT(Refusal("ply\nformat ascii 1.0\nelement nothing 9\nend_header\n"), HasSubstr("without properties"));
  EXPECT_THAT(Refusal("ply\nproperty float x\nend_header\n"), HasSubstr("without element"));
}

}  // namespace
}  // namespace coach
