#include "tools/simulator/shading.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

using Vector3f = Eigen::Vector3f;

struct Lights {
  explicit Lights(const Lighting& l)
      : lamp(l.lamp.cast<float>()),
        lamp_colour(l.lamp_colour.cast<float>()),
        window(l.window.normalized().cast<float>()),
        window_colour(l.window_colour.cast<float>()),
        ambient(l.ambient.cast<float>()),
        ground(l.ground.cast<float>()) {}
  Vector3f lamp, lamp_colour, window, window_colour, ambient, ground;
};

/// A look with its frame inverted, in single precision.
struct Paint {
  explicit Paint(const Look& look)
      : R_BW(look.X_WB.linear().transpose().cast<float>()),
        p_WB(look.X_WB.translation().cast<float>()),
        first(look.material.colour.cast<float>()),
        second(look.material.second_colour.cast<float>()),
        tiles(static_cast<float>(1 / look.material.tile)),
        gloss(static_cast<float>(look.material.gloss)),
        pattern(look.material.pattern) {}
  Eigen::Matrix3f R_BW;
  Vector3f p_WB, first, second;
  float tiles, gloss;
  int pattern;
};

/// The pattern on the side of the body that the normal names (its own frame).
Vector3f Albedo(const Paint& paint, const std::vector<Pattern>& patterns, const Vector3f& p_W, const Vector3f& n_W) {
  const Vector3f p = paint.R_BW * (p_W - paint.p_WB) * paint.tiles;
  const Vector3f n = (paint.R_BW * n_W).cwiseAbs();
  const bool z_side = n.z() >= n.x() && n.z() >= n.y();
  const bool y_side = !z_side && n.y() >= n.x();
  const float u = z_side || y_side ? p.x() : p.y();
  const float v = z_side ? p.y() : p.z();
  const float t = patterns[static_cast<size_t>(paint.pattern)].At(u, v);
  return paint.first + t * (paint.second - paint.first);
}

/// A highlight's strength: the 24th power of the cosine between the normal and the middle of both directions (Blinn).
float Highlight(const Vector3f& n, const Vector3f& to_lamp, const Vector3f& ray) {
  const Vector3f half = to_lamp - ray / ray.norm();
  const float cosine = n.dot(half), square = cosine * cosine, length = half.squaredNorm();
  if (cosine <= 0 || square < 0.6f * length) return 0;  // under 0.2 %
  const float s2 = square / length, s4 = s2 * s2, s8 = s4 * s4;
  return s8 * s8 * s8;
}

/// Soft shadows: the 4 x 4 pattern of light samples averaged over its own size.
void Soften(int width, int height, const std::vector<float>& lit, std::vector<float>* soft) {
  std::vector<float> rows(lit.size());
  for (int y = 0; y < height; ++y) {
    const float* in = &lit[static_cast<size_t>(y * width)];
    float* out = &rows[static_cast<size_t>(y * width)];
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int i = -2; i < 2; ++i) sum += in[std::clamp(x + i, 0, width - 1)];
      out[x] = sum;
    }
  }
  soft->resize(lit.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      for (int i = -2; i < 2; ++i) sum += rows[static_cast<size_t>(std::clamp(y + i, 0, height - 1) * width + x)];
      (*soft)[static_cast<size_t>(y * width + x)] = sum / 16;
    }
  }
}

}  // namespace

void Shade(const CameraModel& camera, const Pose& X_WC, const Hits& hits, const std::vector<float>& lit,
           const Lighting& lighting, const std::vector<Look>& looks, const std::vector<Pattern>& patterns,
           cv::Mat* linear) {
  linear->create(hits.height, hits.width, CV_32FC3);
  static thread_local std::vector<float> soft;
  Soften(hits.width, hits.height, lit, &soft);
  const Lights lights(lighting);
  std::vector<Paint> paints(looks.begin(), looks.end());
  const Eigen::Matrix3f R_WC = X_WC.linear().cast<float>();
  const Vector3f origin = X_WC.translation().cast<float>();
  const float ifx = static_cast<float>(1 / camera.fx), ify = static_cast<float>(1 / camera.fy);
  const Vector3f dx = R_WC.col(0) * ifx;
  for (int y = 0; y < hits.height; ++y) {
    float* out = linear->ptr<float>(y);
    const Vector3f row = R_WC * Vector3f(-static_cast<float>(camera.cx) * ifx,
                                         (static_cast<float>(y) - static_cast<float>(camera.cy)) * ify, 1);
    for (int x = 0; x < hits.width; ++x, out += 3) {
      const size_t k = static_cast<size_t>(y * hits.width + x);
      if (hits.body[k] < 0) {
        out[0] = out[1] = out[2] = 0.5f;
        continue;
      }
      const Vector3f ray = row + static_cast<float>(x) * dx;
      const Vector3f p = origin + hits.z[k] * ray;
      const Vector3f n(hits.normal_x[k], hits.normal_y[k], hits.normal_z[k]);
      const Paint& paint = paints[static_cast<size_t>(hits.body[k])];
      const Vector3f to_lamp = lights.lamp - p;
      const float near = 1 / to_lamp.squaredNorm();
      const Vector3f l = to_lamp * std::sqrt(near);
      const float shadow = soft[k] * 4 * near;
      const float up = 0.5f + 0.5f * n.z();
      const Vector3f light = lights.ground + up * (lights.ambient - lights.ground) +
                             std::max(0.0f, n.dot(l)) * shadow * lights.lamp_colour +
                             std::max(0.0f, n.dot(lights.window)) * lights.window_colour;
      const Vector3f colour = Albedo(paint, patterns, p, n).cwiseProduct(light) +
                              paint.gloss * shadow * Highlight(n, l, ray) * lights.lamp_colour;
      out[0] = colour.z();
      out[1] = colour.y();
      out[2] = colour.x();
    }
  }
}

}  // namespace coach
