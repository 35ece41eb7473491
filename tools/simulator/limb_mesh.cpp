#include "tools/simulator/limb_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coach {
namespace {

// A segment's vertices: a pole, three rings round each end, a pole.
constexpr int kSides = 12, kRingsAnEnd = 3, kRings = 2 * kRingsAnEnd;
static_assert(kLimbVertices == kRings * kSides + 2 && kLimbTriangles == 2 * kRings * kSides);

constexpr unsigned kFirstPole = kRings * kSides, kLastPole = kFirstPole + 1;

std::vector<std::array<unsigned, 3>> MakeTriangles() {
  std::vector<std::array<unsigned, 3>> triangles;
  for (unsigned i = 0; i < kSides; ++i) {
    const unsigned j = (i + 1) % kSides;
    triangles.push_back({kFirstPole, j, i});
    for (unsigned ring = 0; ring + 1 < kRings; ++ring) {
      const unsigned low = ring * kSides, high = low + kSides;
      triangles.push_back({low + i, low + j, high + j});
      triangles.push_back({low + i, high + j, high + i});
    }
    triangles.push_back({kLastPole, (kRings - 1) * kSides + i, (kRings - 1) * kSides + j});
  }
  return triangles;
}

struct Circle {
  std::array<double, kSides> cosine, sine;
};

const Circle& UnitCircle() {
  static const Circle circle = [] {
    Circle c;
    for (size_t i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kSides;
      c.cosine[i] = std::cos(angle);
      c.sine[i] = std::sin(angle);
    }
    return c;
  }();
  return circle;
}

}  // namespace

const std::vector<std::array<unsigned, 3>>& LimbTriangles() {
  static const auto triangles = MakeTriangles();
  return triangles;
}

void WriteLimbVertices(const RoundSegment& segment, float* xyz) {
  // Corners stand out as far as the middles of the sides lie in.
  static const double kWiden = 1 / std::sqrt(std::cos(std::numbers::pi / kSides));
  const Vector3 way = segment.b - segment.a;
  const double length = std::max(way.norm(), 1e-9);
  const Vector3 axis = way / length;
  const Vector3 x = axis.unitOrthogonal(), y = axis.cross(x);
  // Latitude at which the cone touches both spheres.
  const double tangent = std::asin(std::clamp((segment.radius_a - segment.radius_b) / length, -0.95, 0.95));
  const auto write = [&](const Vector3& p) {
    for (int k = 0; k < 3; ++k) *xyz++ = static_cast<float>(p[k]);
  };
  constexpr double kRight = std::numbers::pi / 2;
  for (int ring = 0; ring < kRings; ++ring) {
    const bool first = ring < kRingsAnEnd;
    const double step = static_cast<double>(first ? ring + 1 : ring - kRingsAnEnd) / kRingsAnEnd;
    const double latitude = first ? -kRight + step * (tangent + kRight) : tangent + step * (kRight - tangent);
    const double radius = kWiden * (first ? segment.radius_a : segment.radius_b);
    const Vector3 centre = (first ? segment.a : segment.b) + radius * std::sin(latitude) * axis;
    const double out = radius * std::cos(latitude);
    for (size_t i = 0; i < kSides; ++i) write(centre + out * (UnitCircle().cosine[i] * x + UnitCircle().sine[i] * y));
  }
  write(segment.a - segment.radius_a * axis);
  write(segment.b + segment.radius_b * axis);
}

Eigen::Vector3f LimbNormal(const RoundSegment& segment, const Eigen::Vector3f& p) {
  const Eigen::Vector3f a = segment.a.cast<float>();
  const Eigen::Vector3f way = segment.b.cast<float>() - a;
  const float t = std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), 1e-12f), 0.0f, 1.0f);
  return (p - a - t * way).normalized();
}

}  // namespace coach
