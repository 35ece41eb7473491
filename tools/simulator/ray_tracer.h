// Casts a camera's rays into a scene of rigid bodies and round limbs (Embree).
#pragma once

#include <memory>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/mesh.h"
#include "tools/simulator/limb_mesh.h"

namespace coach {

/// What each pixel of a camera sees, row by row. body -1: nothing.
struct Hits {
  int width = 0, height = 0;
  std::vector<int> body;
  std::vector<float> z;                             ///< m along the optical axis
  std::vector<float> normal_x, normal_y, normal_z;  ///< unit, world frame, towards the camera

  void Resize(int w, int h);
  size_t size() const { return body.size(); }
};

/// Single-threaded. Bodies are numbered in the order in which they are added.
class RayTracer {
 public:
  RayTracer();
  ~RayTracer();
  RayTracer(const RayTracer&) = delete;
  RayTracer& operator=(const RayTracer&) = delete;

  int AddMesh(const TriangleMesh& mesh);  ///< a shape that bodies share
  int AddBody(int mesh);                  ///< at the origin until SetPose
  int AddLimb();                          ///< empty until SetSegments
  /// A body that never moves (faster). All must be added before the first Commit.
  int AddFixture(const TriangleMesh& mesh, const Pose& X_WB);
  int num_bodies() const;

  void SetPose(int body, const Pose& X_WB);
  void SetSegments(int limb, const std::vector<RoundSegment>& segments);
  /// Must follow changes, before rays are cast.
  void Commit();

  /// First hits of the rays through all pixel centres (no lens distortion).
  void Trace(const CameraModel& camera, const Pose& X_WC, Hits* hits) const;

  /// First hits of single rays of unit direction: the body or -1, the distance (m) and the unit normal.
  struct RayHit {
    int body = -1;
    double distance = 0;
    Vector3 normal = Vector3::Zero();
  };
  RayHit Cast(const Vector3& origin, const Vector3& direction) const;

  /// For every hit of `hits`: 1 where the way to the light is free, else 0. The light is a square of half side
  /// `softness` (m) facing down; each pixel looks at another point of it, in a fixed 4 x 4 pattern.
  void Light(const CameraModel& camera, const Pose& X_WC, const Hits& hits, const Vector3& light, double softness,
             std::vector<float>* free) const;

  /// Pixels the mesh covers when seen alone, counted also outside the image (up to one image size on each side).
  struct Silhouette {
    int pixels = 0;
    int pixels_in_image = 0;
    int left = -1, top = -1, right = -1, bottom = -1;  ///< inclusive; -1 if empty
  };
  Silhouette Outline(int mesh, const CameraModel& camera, const Pose& X_CB) const;

  /// True if the point (mesh frame, m) is inside the closed mesh.
  bool Inside(int mesh, const Vector3& p) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace coach
