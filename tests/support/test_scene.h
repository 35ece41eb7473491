// Pictures of parts on a table, for tests: depth and colour of a pinhole camera that looks down at an angle.
#pragma once

#include <cmath>
#include <opencv2/core/mat.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/task.h"
#include "services/pose_filter/depth_renderer.h"
#include "services/pose_filter/pose_filter.h"
#include "tests/support/test_meshes.h"

namespace coach {

/// Blue and green in OpenCV's order, and the ranges that hold them.
inline const cv::Vec3b kTestBlue{150, 60, 30}, kTestGreen{40, 120, 30}, kTestTable{120, 140, 150};

inline PartType TestType(std::string name, const TriangleMesh& mesh, bool blue, int count) {
  PartType type;
  type.name = std::move(name);
  type.count = count;
  type.mesh = mesh;
  type.hsv = blue ? HsvRange{{104, 120, 40}, {124, 255, 255}} : HsvRange{{45, 80, 40}, {75, 255, 255}};
  return type;
}

/// An L of 120 x 60 x 30 mm: concave, without symmetry.
inline TriangleMesh LMesh() {
  TriangleMesh mesh = BoxMesh({0.12, 0.03, 0.03});
  TriangleMesh arm = BoxMesh({0.03, 0.03, 0.03});
  for (const auto& t : arm.triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  for (const Vector3& v : arm.vertices) mesh.vertices.push_back(v + Vector3(-0.045, 0.03, 0));
  return mesh;
}

inline Task TestTask(const std::vector<PartType>& types) {
  Task task;
  task.types = types;
  for (size_t t = 0; t < types.size(); ++t) {
    for (int i = 0; i < types[t].count; ++i) {
      task.parts.push_back({types[t].name + "_" + std::to_string(i + 1), static_cast<int>(t)});
    }
  }
  return task;
}

struct TestPicture {
  CameraModel camera;
  cv::Mat depth;   ///< CV_16UC1, mm
  cv::Mat colour;  ///< CV_8UC3
};

inline CameraModel TestCamera() {
  CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 570;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

/// Table frame: the camera looks at its origin from 0.8 m, 50 degrees above the table.
inline Pose TestTable() {
  Pose X_CT = Pose::Identity();
  const double angle = 50 * std::numbers::pi / 180;
  X_CT.linear().col(0) = Vector3::UnitX();
  X_CT.linear().col(2) = Vector3(0, -std::cos(angle), -std::sin(angle));
  X_CT.linear().col(1) = X_CT.linear().col(2).cross(X_CT.linear().col(0));
  X_CT.translation() << 0, 0, 0.8;
  return X_CT;
}

/// Draws the table and the parts with the sensor noise of tracking.md times `noise`.
/// @param occluder m, a wall at this depth over the columns [left, right); left == right: none
/// @param table X_CT, where the camera sees the table
inline TestPicture DrawScene(const Task& task, const std::vector<Pose>& X_CP, uint64_t seed, double noise = 1,
                             int left = 0, int right = 0, double occluder = 0.4, const Pose& table = TestTable()) {
  TestPicture picture{TestCamera(), cv::Mat(480, 640, CV_16UC1, cv::Scalar(0)), cv::Mat(480, 640, CV_8UC3)};
  const PixelGrid grid = SampledGrid(picture.camera, 1);
  RenderedDepth scene, tile;
  scene.Reset({0, 0, 640, 480});
  cv::Mat owner(480, 640, CV_32SC1, cv::Scalar(-1));
  Pose X_CT = table;
  X_CT.translation() -= 0.01 * X_CT.linear().col(2);
  RenderDepth(RenderMesh(BoxMesh({1.2, 0.8, 0.02})), grid, X_CT, tile);
  MergeNearer(tile, scene);
  for (size_t p = 0; p < X_CP.size(); ++p) {
    RenderDepth(RenderMesh(task.TypeOf(static_cast<int>(p)).mesh), grid, X_CP[p], tile);
    for (int j = 0; j < tile.area.height; ++j) {
      for (int i = 0; i < tile.area.width; ++i) {
        if (tile.row(j)[i] < scene.row(tile.area.y + j)[tile.area.x + i]) {
          owner.at<int>(tile.area.y + j, tile.area.x + i) = static_cast<int>(p);
        }
      }
    }
    MergeNearer(tile, scene);
  }
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const bool hidden = x >= left && x < right;
      const double z = hidden ? occluder : scene.row(y)[x];
      const int p = hidden ? -1 : owner.at<int>(y, x);
      if (std::isfinite(z)) {
        const double measured = z + noise * (0.001 + 1.4247e-3 * z * z) * normal(generator);
        picture.depth.at<uint16_t>(y, x) = static_cast<uint16_t>(std::lround(1000 * measured));
      }
      const bool blue = p >= 0 && task.TypeOf(p).hsv.low[0] > 100;
      picture.colour.at<cv::Vec3b>(y, x) = p < 0 ? kTestTable : blue ? kTestBlue : kTestGreen;
    }
  }
  return picture;
}

/// Pose of a part that lies on the table at (x, y) m of the table frame, turned by `angle` about the vertical.
inline Pose OnTable(double x, double y, double angle, double half_height = 0.015) {
  return TestTable() * MakePose(ExpRotation({0, 0, angle}), {x, y, half_height});
}

}  // namespace coach
