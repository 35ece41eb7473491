#include "services/pose_filter/depth_renderer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "services/pose_filter/depth_renderer.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

// Homogeneous rasterisation [Olano and Greer 1997]: with the camera's intrinsics and the tile's origin folded into the
// transformation, p = (x, y, z) is seen at (x / z, y / z) of the tile, and a ray (u, v, 1) is inside the triangle a b c
// if (a x b), (b x c) and (c x a) have the same sign with it as det[a b c]. No division, and no clipping at the near
// plane: 1 / z = N . (u, v, 1) / det with N = (b - a) x (c - a) is just compared.
HWY_BEFORE_NAMESPACE();
namespace coach {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, RenderedDepth::kPadding>;
using V = hn::Vec<D>;

/// Part frame to tile coordinates: row-major 3 x 4.
using Projection = std::array<float, 12>;

constexpr float kInside = 1e-3F;  ///< grid spacings

struct Vector {
  V x, y, z;
};

HWY_INLINE Vector Corner(D d, const RenderMesh& mesh, int corner, size_t first, const Projection& m) {
  const V x = hn::LoadU(d, mesh.coordinates(corner, 0) + first);
  const V y = hn::LoadU(d, mesh.coordinates(corner, 1) + first);
  const V z = hn::LoadU(d, mesh.coordinates(corner, 2) + first);
  const auto row = [&](size_t r) HWY_ATTR {
    return hn::MulAdd(
        hn::Set(d, m[4 * r]), x,
        hn::MulAdd(hn::Set(d, m[4 * r + 1]), y, hn::MulAdd(hn::Set(d, m[4 * r + 2]), z, hn::Set(d, m[4 * r + 3]))));
  };
  return {row(0), row(1), row(2)};
}

HWY_INLINE Vector Cross(const Vector& a, const Vector& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

HWY_INLINE Vector Minus(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

/// Planes over the tile, value = x u + y v + z: three edges (inside: not negative) and 1 / z with its bounds; one lane
/// a triangle.
struct Setup {
  static constexpr size_t kLanes = RenderedDepth::kPadding;
  HWY_ALIGN float edge[3][3][kLanes];
  HWY_ALIGN float inverse[3][kLanes];
  HWY_ALIGN float farthest[kLanes], nearest[kLanes];  // bounds of 1 / z
  HWY_ALIGN float left[kLanes], right[kLanes], top[kLanes], bottom[kLanes];
  HWY_ALIGN float drawn[kLanes];  // not 0: to be drawn
};

HWY_INLINE void StoreEdge(D d, const Vector& a, const Vector& b, V sign, float (*edge)[Setup::kLanes]) {
  // a x (b - a) rather than a x b: small triangles keep their precision.
  const Vector e = Cross(a, Minus(b, a));
  const V x = hn::Mul(e.x, sign), y = hn::Mul(e.y, sign), z = hn::Mul(e.z, sign);
  hn::Store(x, d, edge[0]);
  hn::Store(y, d, edge[1]);
  hn::Store(hn::MulAdd(hn::Set(d, kInside), hn::Add(hn::Abs(x), hn::Abs(y)), z), d, edge[2]);
}

HWY_INLINE V Min3(V a, V b, V c) { return hn::Min(a, hn::Min(b, c)); }
HWY_INLINE V Max3(V a, V b, V c) { return hn::Max(a, hn::Max(b, c)); }

/// @returns whether any of the triangles is to be drawn.
HWY_INLINE bool SetUp(D d, const RenderMesh& mesh, size_t first, const Projection& m, bool cull,
                      const GridRectangle& area, Setup& s) {
  const Vector a = Corner(d, mesh, 0, first, m), b = Corner(d, mesh, 1, first, m), c = Corner(d, mesh, 2, first, m);
  const V zero = hn::Zero(d), near = hn::Set(d, static_cast<float>(kNearPlane));
  const V width = hn::Set(d, static_cast<float>(area.width)), height = hn::Set(d, static_cast<float>(area.height));
  const Vector n = Cross(Minus(b, a), Minus(c, a));
  const V det = hn::MulAdd(n.x, a.x, hn::MulAdd(n.y, a.y, hn::Mul(n.z, a.z)));

  // Box. A triangle that crosses the near plane may be anywhere.
  const V one = hn::Set(d, 1.0F), border = hn::Set(d, kInside);
  const auto in_front = hn::Ge(Min3(a.z, b.z, c.z), near);
  const V za = hn::Div(one, a.z), zb = hn::Div(one, b.z), zc = hn::Div(one, c.z);
  const V ua = hn::Mul(a.x, za), ub = hn::Mul(b.x, zb), uc = hn::Mul(c.x, zc);
  const V va = hn::Mul(a.y, za), vb = hn::Mul(b.y, zb), vc = hn::Mul(c.y, zc);
  const V left = hn::IfThenElse(in_front, hn::Ceil(hn::Sub(Min3(ua, ub, uc), border)), zero);
  const V right = hn::IfThenElse(in_front, hn::Add(hn::Floor(hn::Add(Max3(ua, ub, uc), border)), one), width);
  const V top = hn::IfThenElse(in_front, hn::Ceil(hn::Sub(Min3(va, vb, vc), border)), zero);
  const V bottom = hn::IfThenElse(in_front, hn::Add(hn::Floor(hn::Add(Max3(va, vb, vc), border)), one), height);
  const V l = hn::Max(left, zero), r = hn::Min(right, width), t = hn::Max(top, zero), o = hn::Min(bottom, height);

  const auto facing = cull ? hn::Lt(det, zero) : hn::Ne(det, zero);
  const auto drawn = hn::And(hn::And(facing, hn::Gt(Max3(a.z, b.z, c.z), near)), hn::And(hn::Lt(l, r), hn::Lt(t, o)));
  if (hn::AllFalse(d, drawn)) return false;
  hn::Store(l, d, s.left);
  hn::Store(r, d, s.right);
  hn::Store(t, d, s.top);
  hn::Store(o, d, s.bottom);
  hn::Store(hn::IfThenElseZero(drawn, one), d, s.drawn);

  const V sign = hn::IfThenElse(hn::Lt(det, zero), hn::Neg(one), one);
  StoreEdge(d, a, b, sign, s.edge[0]);
  StoreEdge(d, b, c, sign, s.edge[1]);
  StoreEdge(d, c, a, sign, s.edge[2]);
  const V scale = hn::Div(one, det);
  hn::Store(hn::Mul(n.x, scale), d, s.inverse[0]);
  hn::Store(hn::Mul(n.y, scale), d, s.inverse[1]);
  hn::Store(hn::Mul(n.z, scale), d, s.inverse[2]);
  // The plane of a triangle seen from its edge is steep: its own corners bound it.
  hn::Store(hn::IfThenElse(in_front, Min3(za, zb, zc), hn::Set(d, 1e-6F)), d, s.farthest);
  hn::Store(hn::IfThenElse(in_front, Max3(za, zb, zc), hn::Set(d, 1e30F)), d, s.nearest);
  return true;
}

/// Draws 1 / z of triangle `i` of the setup, keeping the larger.
HWY_INLINE void Draw(D d, const Setup& s, size_t i, RenderedDepth& tile) {
  const size_t lanes = hn::Lanes(d);
  const auto left = static_cast<size_t>(s.left[i]) / lanes * lanes, right = static_cast<size_t>(s.right[i]);
  const V limit = hn::Set(d, static_cast<float>(1 / kNearPlane));
  const V x0 = hn::Set(d, s.edge[0][0][i]), x1 = hn::Set(d, s.edge[1][0][i]), x2 = hn::Set(d, s.edge[2][0][i]);
  const V xi = hn::Set(d, s.inverse[0][i]);
  const V farthest = hn::Set(d, s.farthest[i]), nearest = hn::Set(d, s.nearest[i]);
  for (int j = static_cast<int>(s.top[i]); j < static_cast<int>(s.bottom[i]); ++j) {
    const auto v = static_cast<float>(j);
    const V c0 = hn::Set(d, s.edge[0][1][i] * v + s.edge[0][2][i]);
    const V c1 = hn::Set(d, s.edge[1][1][i] * v + s.edge[1][2][i]);
    const V c2 = hn::Set(d, s.edge[2][1][i] * v + s.edge[2][2][i]);
    const V ci = hn::Set(d, s.inverse[1][i] * v + s.inverse[2][i]);
    float* row = tile.row(j);
    for (size_t x = left; x < right; x += lanes) {
      const V u = hn::Iota(d, static_cast<float>(x));
      const V outside = Min3(hn::MulAdd(x0, u, c0), hn::MulAdd(x1, u, c1), hn::MulAdd(x2, u, c2));
      const V raw = hn::MulAdd(xi, u, ci);
      const V inverse = hn::Min(hn::Max(raw, farthest), nearest);
      const auto inside = hn::And(hn::Ge(outside, hn::Zero(d)), hn::Le(inverse, limit));
      hn::StoreU(hn::Max(hn::IfThenElseZero(inside, inverse), hn::LoadU(d, row + x)), d, row + x);
    }
  }
}

void Render(const RenderMesh& mesh, const Projection& m, bool cull, RenderedDepth& tile) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  Setup setup;
  for (size_t first = 0; first < static_cast<size_t>(mesh.num_triangles()); first += lanes) {
    if (!SetUp(d, mesh, first, m, cull, tile.area, setup)) continue;
    for (size_t i = 0; i < lanes; ++i) {
      if (setup.drawn[i] != 0) Draw(d, setup, i, tile);
    }
  }
  // The last vectors of a row may have drawn into the padding.
  const V one = hn::Set(d, 1.0F), width = hn::Set(d, static_cast<float>(tile.area.width));
  for (int j = 0; j < tile.area.height; ++j) {
    float* row = tile.row(j);
    for (size_t x = 0; x < static_cast<size_t>(tile.stride); x += lanes) {
      const auto valid = hn::Lt(hn::Iota(d, static_cast<float>(x)), width);
      hn::StoreU(hn::Div(one, hn::IfThenElseZero(valid, hn::LoadU(d, row + x))), d, row + x);
    }
  }
}

void Nearer(const float* from, size_t n, float* into) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= n; i += lanes) hn::StoreU(hn::Min(hn::LoadU(d, from + i), hn::LoadU(d, into + i)), d, into + i);
  for (; i < n; ++i) into[i] = std::min(into[i], from[i]);
}

}  // namespace HWY_NAMESPACE
}  // namespace coach
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace coach {

HWY_EXPORT(Render);
HWY_EXPORT(Nearer);

namespace {

/// Every edge is shared by two triangles that run along it in opposite directions, and the outside is outside.
bool IsClosed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (size_t i = 0; i < 3; ++i) {
      const int a = t[i], b = t[(i + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; }) &&
         SignedVolume(mesh) > 0;
}

/// Depth of the corner of the mesh's box that is nearest to the camera.
double NearestCorner(const RenderMesh& mesh, const Pose& X_CP) {
  const Vector3 axis = X_CP.linear().row(2);
  return X_CP.translation().z() + axis.cwiseProduct(mesh.low()).cwiseMin(axis.cwiseProduct(mesh.high())).sum();
}

}  // namespace

PixelGrid SampledGrid(const CameraModel& camera, int step) {
  return {(camera.width + step - 1) / step,
          (camera.height + step - 1) / step,
          step,
          camera.fx / step,
          camera.fy / step,
          camera.cx / step,
          camera.cy / step};
}

void RenderedDepth::Reset(const GridRectangle& new_area, float value) {
  area = new_area;
  stride = (area.width + kPadding - 1) / kPadding * kPadding;
  const size_t size = static_cast<size_t>(stride) * static_cast<size_t>(area.height);
  if (depth.size() < size) depth.resize(size);
  for (int j = 0; j < area.height; ++j) {
    std::fill_n(row(j), area.width, value);
    std::fill(row(j) + area.width, row(j) + stride, kEmpty);
  }
}

RenderMesh::RenderMesh(const TriangleMesh& mesh)
    : num_triangles_(static_cast<int>(mesh.triangles.size())), closed_(IsClosed(mesh)) {
  const size_t padded =
      (mesh.triangles.size() + RenderedDepth::kPadding - 1) / RenderedDepth::kPadding * RenderedDepth::kPadding;
  for (auto& list : coordinates_) list.assign(padded, 0.0F);
  if (!mesh.vertices.empty()) low_ = high_ = mesh.vertices[0];
  for (const Vector3& v : mesh.vertices) {
    low_ = low_.cwiseMin(v);
    high_ = high_.cwiseMax(v);
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (size_t corner = 0; corner < 3; ++corner) {
      const Vector3& v = mesh.vertices[static_cast<size_t>(mesh.triangles[t][corner])];
      for (size_t axis = 0; axis < 3; ++axis) {
        coordinates_[3 * corner + axis][t] = static_cast<float>(v[static_cast<Eigen::Index>(axis)]);
      }
    }
  }
}

GridRectangle SilhouetteBounds(const RenderMesh& mesh, const PixelGrid& grid, const Pose& X_CP) {
  const double infinity = std::numeric_limits<double>::infinity();
  double left = infinity, right = -infinity, top = infinity, bottom = -infinity;
  bool any_in_front = false, all_in_front = true;
  for (int i = 0; i < 8; ++i) {
    const Vector3 corner(i & 1 ? mesh.high().x() : mesh.low().x(), i & 2 ? mesh.high().y() : mesh.low().y(),
                         i & 4 ? mesh.high().z() : mesh.low().z());
    const Vector3 p = X_CP * corner;
    if (!(p.z() > kNearPlane)) {
      all_in_front = false;
      continue;
    }
    any_in_front = true;
    const double u = grid.fx * p.x() / p.z() + grid.cx, v = grid.fy * p.y() / p.z() + grid.cy;
    left = std::min(left, u);
    right = std::max(right, u);
    top = std::min(top, v);
    bottom = std::max(bottom, v);
  }
  if (!any_in_front) return {};
  if (!all_in_front) return {0, 0, grid.width, grid.height};
  const auto clamp = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, double(size))); };
  const double border = 2e-3;
  const int x0 = clamp(std::ceil(left - border), grid.width), x1 = clamp(std::floor(right + border) + 1, grid.width);
  const int y0 = clamp(std::ceil(top - border), grid.height), y1 = clamp(std::floor(bottom + border) + 1, grid.height);
  if (x0 >= x1 || y0 >= y1) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

void RenderDepth(const RenderMesh& mesh, const PixelGrid& grid, const Pose& X_CP, const GridRectangle& area,
                 RenderedDepth& tile) {
  if (!X_CP.matrix().allFinite()) {
    tile.Reset(area);
    return;
  }
  Matrix3 K;
  K << grid.fx, 0, grid.cx - area.x, 0, grid.fy, grid.cy - area.y, 0, 0, 1;
  const Eigen::Matrix<float, 3, 4, Eigen::RowMajor> m = (K * X_CP.matrix().topRows<3>()).template cast<float>();
  std::array<float, 12> projection;
  std::copy_n(m.data(), 12, projection.begin());
  // A camera that may be inside the part's box could look at faces from behind.
  const bool cull = mesh.closed() && NearestCorner(mesh, X_CP) > kNearPlane;
  tile.Reset(area, 0.0F);
  HWY_DYNAMIC_DISPATCH(Render)(mesh, projection, cull, tile);
}

void RenderDepth(const RenderMesh& mesh, const PixelGrid& grid, const Pose& X_CP, RenderedDepth& tile) {
  RenderDepth(mesh, grid, X_CP, SilhouetteBounds(mesh, grid, X_CP), tile);
}

void MergeNearer(const RenderedDepth& from, RenderedDepth& into) {
  const int left = std::max(from.area.x, into.area.x);
  const int right = std::min(from.area.x + from.area.width, into.area.x + into.area.width);
  const int top = std::max(from.area.y, into.area.y);
  const int bottom = std::min(from.area.y + from.area.height, into.area.y + into.area.height);
  if (left >= right) return;
  for (int y = top; y < bottom; ++y) {
    HWY_DYNAMIC_DISPATCH(Nearer)
    (from.row(y - from.area.y) + (left - from.area.x), static_cast<size_t>(right - left),
     into.row(y - into.area.y) + (left - into.area.x));
  }
}

}  // namespace coach
#endif  // HWY_ONCE
