#include "tools/simulator/ray_tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace coach {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kTile = 4, kLanes = kTile * kTile;  // px: rays go in square packets
constexpr float kSurfaceOffset = 1e-4f;           // m: a shadow ray starts this far off the surface it leaves

struct Body {
  RTCGeometry geometry = nullptr;
  Eigen::Matrix3f R_WB = Eigen::Matrix3f::Identity();
  bool moves = false;                    // its normals are in its own frame
  std::vector<RoundSegment> segments{};  // of a limb
};

RTCIntersectContext Context(bool coherent) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

RTCRayHit MakeRay(const Vector3& origin, const Vector3& direction) {
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = 0;
  ray.ray.tfar = kInfinity;
  ray.ray.mask = 0xFFFFFFFFu;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

/// Direction in W of the ray through a pixel, scaled so that its length along the optical axis is 1.
struct PixelRays {
  PixelRays(const CameraModel& camera, const Pose& X_WC)
      : origin(X_WC.translation().cast<float>()),
        dx((X_WC.linear().col(0) / camera.fx).cast<float>()),
        dy((X_WC.linear().col(1) / camera.fy).cast<float>()),
        corner((X_WC.linear() * Vector3(-camera.cx / camera.fx, -camera.cy / camera.fy, 1)).cast<float>()) {}
  Eigen::Vector3f Direction(int x, int y) const {
    return corner + static_cast<float>(x) * dx + static_cast<float>(y) * dy;
  }
  Eigen::Vector3f origin, dx, dy, corner;
};

}  // namespace

void Hits::Resize(int w, int h) {
  width = w;
  height = h;
  const size_t n = static_cast<size_t>(w * h);
  body.resize(n);
  z.resize(n);
  normal_x.resize(n);
  normal_y.resize(n);
  normal_z.resize(n);
}

struct RayTracer::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<RTCScene> meshes;
  std::vector<Body> bodies;
  std::vector<int> body_of_geometry;  // by Embree's ids

  RTCGeometry NewMesh(const TriangleMesh& mesh, const Pose& X) const;
  int Add(const Body& body);
  /// The unit normal (world) towards where the ray comes from. @param p where it hits. @param n Embree's, of any
  /// length.
  Eigen::Vector3f Normal(int body, unsigned primitive, const Eigen::Vector3f& p, Eigen::Vector3f n,
                         const Eigen::Vector3f& direction) const {
    const Body& b = bodies[static_cast<size_t>(body)];
    if (!b.segments.empty()) {
      n = LimbNormal(b.segments[primitive / kLimbTriangles], p);
    } else {
      if (b.moves) n = b.R_WB * n;
      n.normalize();
    }
    return n.dot(direction) > 0 ? -n : n;
  }
  int BodyOf(unsigned geometry, unsigned instance) const {
    return body_of_geometry[instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance];
  }
};

RTCGeometry RayTracer::State::NewMesh(const TriangleMesh& mesh, const Pose& X) const {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  for (const Vector3& v : mesh.vertices) {
    const Vector3 p = X * v;
    for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(p[i]);
  }
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int i : t) *indices++ = static_cast<unsigned>(i);
  }
  rtcCommitGeometry(geometry);
  return geometry;
}

int RayTracer::State::Add(const Body& body) {
  bodies.push_back(body);
  const int index = static_cast<int>(bodies.size()) - 1;
  if (body.geometry) {
    const unsigned id = rtcAttachGeometry(scene, body.geometry);
    body_of_geometry.resize(std::max<size_t>(body_of_geometry.size(), id + 1), -1);
    body_of_geometry[id] = index;
  }
  return index;
}

RayTracer::RayTracer() : state_(std::make_unique<State>()) {
  state_->device = rtcNewDevice("threads=1,set_affinity=0");
  if (!state_->device)
    throw std::runtime_error("Embree: no device, error " + std::to_string(rtcGetDeviceError(nullptr)));
  state_->scene = rtcNewScene(state_->device);
  rtcSetSceneFlags(state_->scene, RTC_SCENE_FLAG_DYNAMIC);
  rtcSetSceneBuildQuality(state_->scene, RTC_BUILD_QUALITY_LOW);
}

RayTracer::~RayTracer() {
  for (Body& body : state_->bodies) {
    if (body.geometry) rtcReleaseGeometry(body.geometry);
  }
  rtcReleaseScene(state_->scene);
  for (RTCScene mesh : state_->meshes) rtcReleaseScene(mesh);
  rtcReleaseDevice(state_->device);
}

int RayTracer::AddMesh(const TriangleMesh& mesh) {
  RTCGeometry geometry = state_->NewMesh(mesh, Pose::Identity());
  RTCScene scene = rtcNewScene(state_->device);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  state_->meshes.push_back(scene);
  return static_cast<int>(state_->meshes.size()) - 1;
}

int RayTracer::AddBody(int mesh) {
  Body body;
  body.moves = true;
  body.geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(body.geometry, state_->meshes.at(static_cast<size_t>(mesh)));
  const int index = state_->Add(body);
  SetPose(index, Pose::Identity());
  return index;
}

int RayTracer::AddLimb() {
  Body body;
  body.geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const int index = state_->Add(body);
  SetSegments(index, {});
  return index;
}

int RayTracer::AddFixture(const TriangleMesh& mesh, const Pose& X_WB) {
  return state_->Add({.geometry = state_->NewMesh(mesh, X_WB)});
}

int RayTracer::num_bodies() const { return static_cast<int>(state_->bodies.size()); }

void RayTracer::SetPose(int body, const Pose& X_WB) {
  Body& b = state_->bodies.at(static_cast<size_t>(body));
  b.R_WB = X_WB.linear().cast<float>();
  float matrix[12];
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) matrix[3 * column + row] = static_cast<float>(X_WB(row, column));
  }
  rtcSetGeometryTransform(b.geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
  rtcCommitGeometry(b.geometry);
}

void RayTracer::SetSegments(int limb, const std::vector<RoundSegment>& segments) {
  Body& body = state_->bodies.at(static_cast<size_t>(limb));
  // Embree wants at least one triangle: a point far under the floor stands for none.
  static const std::vector<RoundSegment> kNone{{Vector3(0, 0, -50), Vector3(0, 0, -50.001), 1e-4, 1e-4}};
  const auto& list = segments.empty() ? kNone : segments;
  const bool same_shape = body.segments.size() == list.size();
  body.segments = list;
  float* vertices = nullptr;
  if (same_shape) {
    vertices = static_cast<float*>(rtcGetGeometryBufferData(body.geometry, RTC_BUFFER_TYPE_VERTEX, 0));
    rtcUpdateGeometryBuffer(body.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcSetGeometryBuildQuality(body.geometry, RTC_BUILD_QUALITY_REFIT);
  } else {
    rtcSetGeometryBuildQuality(body.geometry, RTC_BUILD_QUALITY_MEDIUM);
    vertices = static_cast<float*>(rtcSetNewGeometryBuffer(body.geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                           3 * sizeof(float), kLimbVertices * list.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        body.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), kLimbTriangles * list.size()));
    for (unsigned s = 0; s < list.size(); ++s) {
      for (const auto& t : LimbTriangles()) {
        for (const unsigned i : t) *indices++ = s * kLimbVertices + i;
      }
    }
  }
  for (size_t s = 0; s < list.size(); ++s) WriteLimbVertices(list[s], vertices + 3 * kLimbVertices * s);
  rtcCommitGeometry(body.geometry);
}

void RayTracer::Commit() { rtcCommitScene(state_->scene); }

void RayTracer::Trace(const CameraModel& camera, const Pose& X_WC, Hits* hits) const {
  hits->Resize(camera.width, camera.height);
  const PixelRays rays(camera, X_WC);
  RTCIntersectContext context = Context(true);
  alignas(64) int valid[kLanes];
  alignas(64) RTCRayHit16 packet;
  for (int i = 0; i < kLanes; ++i) {
    packet.ray.org_x[i] = rays.origin.x();
    packet.ray.org_y[i] = rays.origin.y();
    packet.ray.org_z[i] = rays.origin.z();
    packet.ray.tnear[i] = packet.ray.time[i] = 0;
    packet.ray.mask[i] = 0xFFFFFFFFu;
    packet.ray.id[i] = packet.ray.flags[i] = 0;
  }
  for (int y0 = 0; y0 < camera.height; y0 += kTile) {
    for (int x0 = 0; x0 < camera.width; x0 += kTile) {
      for (int i = 0; i < kLanes; ++i) {
        const int x = x0 + i % kTile, y = y0 + i / kTile;
        const Eigen::Vector3f d = rays.Direction(x, y);
        valid[i] = x < camera.width && y < camera.height ? -1 : 0;
        packet.ray.dir_x[i] = d.x();
        packet.ray.dir_y[i] = d.y();
        packet.ray.dir_z[i] = d.z();
        packet.ray.tfar[i] = kInfinity;
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(valid, state_->scene, &context, &packet);
      for (int i = 0; i < kLanes; ++i) {
        if (!valid[i]) continue;
        const size_t k = static_cast<size_t>((y0 + i / kTile) * camera.width + x0 + i % kTile);
        const unsigned geometry = packet.hit.geomID[i], instance = packet.hit.instID[0][i];
        if (geometry == RTC_INVALID_GEOMETRY_ID) {
          hits->body[k] = -1;
          hits->z[k] = 0;
          continue;
        }
        const int index = state_->BodyOf(geometry, instance);
        const Eigen::Vector3f d(packet.ray.dir_x[i], packet.ray.dir_y[i], packet.ray.dir_z[i]);
        const Eigen::Vector3f n =
            state_->Normal(index, packet.hit.primID[i], rays.origin + packet.ray.tfar[i] * d,
                           Eigen::Vector3f(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]), d);
        hits->body[k] = index;
        hits->z[k] = packet.ray.tfar[i];
        hits->normal_x[k] = n.x();
        hits->normal_y[k] = n.y();
        hits->normal_z[k] = n.z();
      }
    }
  }
}

RayTracer::RayHit RayTracer::Cast(const Vector3& origin, const Vector3& direction) const {
  RTCRayHit ray = MakeRay(origin, direction);
  RTCIntersectContext context = Context(false);
  rtcIntersect1(state_->scene, &context, &ray);
  RayHit hit;
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.body = state_->BodyOf(ray.hit.geomID, ray.hit.instID[0]);
  hit.distance = ray.ray.tfar;
  hit.normal = state_
                   ->Normal(hit.body, ray.hit.primID, (origin + hit.distance * direction).cast<float>(),
                            Eigen::Vector3f(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z), direction.cast<float>())
                   .cast<double>();
  return hit;
}

void RayTracer::Light(const CameraModel& camera, const Pose& X_WC, const Hits& hits, const Vector3& light,
                      double softness, std::vector<float>* free) const {
  free->assign(hits.size(), 0.0f);
  const PixelRays rays(camera, X_WC);
  RTCIntersectContext context = Context(true);
  alignas(64) int valid[kLanes];
  alignas(64) RTCRay16 packet;
  // The points of the light that a tile's pixels look at, ordered so that neighbours look at far ones.
  static constexpr int kOrder[kLanes] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
  std::array<Eigen::Vector3f, kLanes> targets;
  for (size_t i = 0; i < kLanes; ++i) {
    const auto side = [&](int c) { return softness * (c - 1.5) / 1.5; };
    targets[i] = (light + Vector3(side(kOrder[i] & 3), side(kOrder[i] >> 2), 0)).cast<float>();
  }
  for (int y0 = 0; y0 < hits.height; y0 += kTile) {
    for (int x0 = 0; x0 < hits.width; x0 += kTile) {
      bool any = false;
      for (int i = 0; i < kLanes; ++i) {
        const int x = x0 + i % kTile, y = y0 + i / kTile;
        valid[i] = 0;
        if (x >= hits.width || y >= hits.height) continue;
        const size_t k = static_cast<size_t>(y * hits.width + x);
        if (hits.body[k] < 0) continue;
        const Eigen::Vector3f n(hits.normal_x[k], hits.normal_y[k], hits.normal_z[k]);
        const Eigen::Vector3f p = rays.origin + hits.z[k] * rays.Direction(x, y) + kSurfaceOffset * n;
        const Eigen::Vector3f way = targets[static_cast<size_t>(i)] - p;
        if (way.dot(n) <= 0) continue;
        valid[i] = -1;
        any = true;
        packet.org_x[i] = p.x();
        packet.org_y[i] = p.y();
        packet.org_z[i] = p.z();
        packet.dir_x[i] = way.x();
        packet.dir_y[i] = way.y();
        packet.dir_z[i] = way.z();
        packet.tnear[i] = 0;
        packet.tfar[i] = 1;
        packet.time[i] = 0;
        packet.mask[i] = 0xFFFFFFFFu;
        packet.id[i] = 0;
        packet.flags[i] = 0;
      }
      if (!any) continue;
      rtcOccluded16(valid, state_->scene, &context, &packet);
      for (int i = 0; i < kLanes; ++i) {
        if (valid[i] && packet.tfar[i] >= 0)
          (*free)[static_cast<size_t>((y0 + i / kTile) * hits.width + x0 + i % kTile)] = 1;
      }
    }
  }
}

RayTracer::Silhouette RayTracer::Outline(int mesh, const CameraModel& camera, const Pose& X_CB) const {
  Silhouette outline;
  RTCScene scene = state_->meshes.at(static_cast<size_t>(mesh));
  RTCBounds bounds;
  rtcGetSceneBounds(scene, &bounds);
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 p_C =
        X_CB * Vector3(corner & 1 ? bounds.upper_x : bounds.lower_x, corner & 2 ? bounds.upper_y : bounds.lower_y,
                       corner & 4 ? bounds.upper_z : bounds.lower_z);
    if (p_C.z() < 0.05) return outline;
    const double u = camera.fx * p_C.x() / p_C.z() + camera.cx, v = camera.fy * p_C.y() / p_C.z() + camera.cy;
    low_x = std::min(low_x, u), high_x = std::max(high_x, u);
    low_y = std::min(low_y, v), high_y = std::max(high_y, v);
  }
  const Pose X_BC = X_CB.inverse();
  const PixelRays rays(camera, X_BC);
  RTCIntersectContext context = Context(true);
  const int x_begin = std::max(-camera.width, static_cast<int>(std::floor(low_x)));
  const int x_end = std::min(2 * camera.width, static_cast<int>(std::ceil(high_x)) + 1);
  const int y_begin = std::max(-camera.height, static_cast<int>(std::floor(low_y)));
  const int y_end = std::min(2 * camera.height, static_cast<int>(std::ceil(high_y)) + 1);
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = x_begin; x < x_end; ++x) {
      RTCRayHit ray = MakeRay(X_BC.translation(), rays.Direction(x, y).cast<double>());
      rtcIntersect1(scene, &context, &ray);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      ++outline.pixels;
      if (x >= 0 && y >= 0 && x < camera.width && y < camera.height) ++outline.pixels_in_image;
      outline.left = outline.pixels == 1 ? x : std::min(outline.left, x);
      outline.right = outline.pixels == 1 ? x : std::max(outline.right, x);
      outline.top = outline.pixels == 1 ? y : std::min(outline.top, y);
      outline.bottom = outline.pixels == 1 ? y : std::max(outline.bottom, y);
    }
  }
  return outline;
}

bool RayTracer::Inside(int mesh, const Vector3& p) const {
  RTCScene scene = state_->meshes.at(static_cast<size_t>(mesh));
  const auto odd_crossings = [&](const Vector3& direction) {
    RTCIntersectContext context = Context(false);
    RTCRayHit ray = MakeRay(p, direction.normalized());
    int crossings = 0;
    while (crossings < 1000) {
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &ray);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
      ++crossings;
      ray.ray.tnear = ray.ray.tfar + 1e-6f;
      ray.ray.tfar = kInfinity;
    }
    return crossings % 2 == 1;
  };
  // A ray that grazes an edge counts wrong; two don't graze at once.
  return odd_crossings({0.5377, 0.2139, 0.8156}) && odd_crossings({-0.3318, 0.6812, 0.6526});
}

}  // namespace coach
