#include "tools/task/picture_book.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "tools/operator/assembly_plan.h"

namespace coach {
namespace {

constexpr int kFiner = 2;                            // drawn so many times finer, then averaged
constexpr double kElevation = 0.75, kAzimuth = 0.5;  // rad, of the eye
constexpr int kPageWidth = 1000, kPageHeight = 700;  // SVG units
const cv::Vec3b kRim(0xb8, 0x5f, 0x1c);              // blue, green, red

cv::Vec3d ColourOf(const PartType& type) {
  static const std::map<std::string, cv::Vec3d> words{
      {"blue", {224, 127, 63}},   {"green", {101, 167, 58}},  {"red", {59, 72, 217}},    {"yellow", {47, 191, 232}},
      {"orange", {47, 132, 232}}, {"purple", {201, 92, 138}}, {"pink", {158, 131, 229}}, {"brown", {63, 98, 141}},
      {"white", {235, 240, 240}}, {"black", {70, 66, 62}}};
  const auto known = words.find(type.colour);
  return known == words.end() ? cv::Vec3d(160, 160, 160) : known->second;
}

/// Turns a structure so that it lies flat: the axis in which it is shortest becomes z.
Matrix3 LaidFlat(const Task& task, const std::vector<DrawnPart>& parts) {
  Vector3 low = Vector3::Constant(1e9), high = -low;
  for (const auto& part : parts) {
    for (const auto& v : task.types[static_cast<size_t>(part.type)].mesh.vertices) {
      low = low.cwiseMin(part.X_FP * v);
      high = high.cwiseMax(part.X_FP * v);
    }
  }
  Eigen::Index shortest = 2;
  const Vector3 size = high - low;
  size.minCoeff(&shortest);
  if (size[shortest] > 0.8 * size.z()) shortest = 2;
  return shortest == 2   ? Matrix3::Identity()
         : shortest == 1 ? ExpRotation(Vector3(M_PI / 2, 0, 0))
                         : ExpRotation(Vector3(0, -M_PI / 2, 0));
}

/// A picture in the making: nearest surface of each pixel.
struct Canvas {
  cv::Mat depth, part, normal;  // CV_32F (m, towards the eye), CV_16S (-1: none), CV_32FC3
  explicit Canvas(const cv::Size& size)
      : depth(size, CV_32F, cv::Scalar(-1e9)),
        part(size, CV_16S, cv::Scalar(-1)),
        normal(size, CV_32FC3, cv::Scalar(0)) {}

  /// Corners: x, y px; z m towards the eye.
  void Fill(const std::array<Vector3, 3>& c, const Vector3& n, int16_t index) {
    const double area = (c[1] - c[0]).head<2>().x() * (c[2] - c[0]).y() - (c[1] - c[0]).y() * (c[2] - c[0]).x();
    if (std::abs(area) < 1e-9) return;
    const auto bound = [&](int axis, bool upper, int limit) {
      const auto [low, high] = std::minmax({c[0][axis], c[1][axis], c[2][axis]});
      return std::clamp(static_cast<int>(upper ? std::floor(high) : std::ceil(low)), 0, limit - 1);
    };
    for (int y = bound(1, false, depth.rows); y <= bound(1, true, depth.rows); ++y) {
      for (int x = bound(0, false, depth.cols); x <= bound(0, true, depth.cols); ++x) {
        const auto weight = [&](size_t i, size_t j) {
          return ((c[j].x() - c[i].x()) * (y - c[i].y()) - (c[j].y() - c[i].y()) * (x - c[i].x())) / area;
        };
        const double u = weight(1, 2), v = weight(2, 0), w = weight(0, 1);
        if (u < 0 || v < 0 || w < 0) continue;
        const auto z = static_cast<float>(u * c[0].z() + v * c[1].z() + w * c[2].z());
        if (z <= depth.at<float>(y, x)) continue;
        depth.at<float>(y, x) = z;
        part.at<int16_t>(y, x) = index;
        normal.at<cv::Vec3f>(y, x) =
            cv::Vec3f(static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z()));
      }
    }
  }

  /// Where a line belongs: another part, a step or a bend.
  bool Edge(int y, int x) const {
    if (y + 1 >= depth.rows || x + 1 >= depth.cols) return false;
    for (const auto& [v, u] : {std::pair(y + 1, x), std::pair(y, x + 1)}) {
      if (part.at<int16_t>(y, x) != part.at<int16_t>(v, u)) return true;
      if (part.at<int16_t>(y, x) < 0) continue;
      if (normal.at<cv::Vec3f>(y, x).dot(normal.at<cv::Vec3f>(v, u)) < 0.8F) return true;
      if (std::abs(depth.at<float>(y, x) - depth.at<float>(v, u)) > 0.004F) return true;
    }
    return false;
  }
};

cv::Mat Shaded(const Canvas& canvas, const Task& task, const std::vector<DrawnPart>& parts) {
  const bool some_new = std::any_of(parts.begin(), parts.end(), [](const auto& p) { return p.is_new; });
  cv::Mat picture(canvas.depth.size(), CV_8UC3, cv::Scalar::all(255));
  cv::Mat fresh(canvas.depth.size(), CV_8UC1, cv::Scalar(0)), edges(canvas.depth.size(), CV_8UC1, cv::Scalar(0));
  const cv::Vec3f light = cv::normalize(cv::Vec3f(-0.3F, 0.5F, 0.8F));
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      edges.at<uint8_t>(y, x) = canvas.Edge(y, x) ? 255 : 0;
      const int16_t index = canvas.part.at<int16_t>(y, x);
      if (index < 0) continue;
      const auto& part = parts[static_cast<size_t>(index)];
      const double shade = 0.62 + 0.38 * std::max(0.0F, canvas.normal.at<cv::Vec3f>(y, x).dot(light));
      cv::Vec3d colour = ColourOf(task.types[static_cast<size_t>(part.type)]) * shade;
      if (some_new && !part.is_new) colour = 0.45 * colour + cv::Vec3d::all(0.55 * 255);
      for (int k = 0; k < 3; ++k) picture.at<cv::Vec3b>(y, x)[k] = cv::saturate_cast<uint8_t>(colour[k]);
      if (part.is_new) fresh.at<uint8_t>(y, x) = 255;
    }
  }
  cv::dilate(edges, edges, cv::Mat());
  picture.setTo(cv::Scalar(70, 62, 52), edges);
  if (some_new) {
    cv::Mat rim;
    cv::dilate(fresh, rim, cv::getStructuringElement(cv::MORPH_ELLIPSE, {15, 15}));
    picture.setTo(kRim, rim & ~fresh);
  }
  return picture;
}

std::string Base64(const std::vector<uint8_t>& bytes) {
  static constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t k = 0; k < bytes.size(); k += 3) {
    uint32_t three = 0;
    for (size_t j = 0; j < 3; ++j) three = three << 8 | (k + j < bytes.size() ? bytes[k + j] : 0);
    for (size_t j = 0; j < 4; ++j) text += k + j > bytes.size() ? '=' : kDigits[three >> (18 - 6 * j) & 63];
  }
  return text;
}

/// The picture fitted into a box of the page.
std::string Image(const cv::Mat& picture, double x, double y, double width, double height) {
  std::vector<uint8_t> png;
  cv::imencode(".png", picture, png);
  char place[160];
  std::snprintf(place, sizeof place,
                "<image x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\" href=\"data:image/png;base64,", x, y,
                width, height);
  return place + Base64(png) + "\"/>\n";
}

std::string Text(double x, double y, double size, const std::string& text) {
  char place[200];
  std::snprintf(place, sizeof place,
                "<text x=\"%.0f\" y=\"%.0f\" font-size=\"%.0f\" font-family=\"sans-serif\" font-weight=\"700\" "
                "fill=\"#1d2a2a\" text-anchor=\"middle\">",
                x, y, size);
  return place + text + "</text>\n";
}

std::string Svg(const std::string& content) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + std::to_string(kPageWidth) + " " +
         std::to_string(kPageHeight) + "\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" + content +
         "</svg>\n";
}

/// A row of parts with their numbers: "2 x".
std::string PartRow(const Task& task, const std::map<int, int>& counts, double y, double height) {
  std::string row;
  const double room = static_cast<double>(kPageWidth) / static_cast<double>(counts.size() + 1);
  double x = room;
  for (const auto& [type, count] : counts) {
    const double width = std::min(0.8 * room, 1.6 * height);
    row += Image(DrawParts(task, {{type, Pose::Identity(), false}}, 500), x - width / 2, y, width, height);
    row += Text(x, y + height + 34, 30, std::to_string(count) + " ×");
    x += room;
  }
  return row;
}

std::string Readable(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

}  // namespace

cv::Mat DrawParts(const Task& task, const std::vector<DrawnPart>& parts, int width) {
  Matrix3 R_EF;  // eye: x right, y up, z towards the eye
  R_EF << 1, 0, 0, 0, std::sin(kElevation), std::cos(kElevation), 0, -std::cos(kElevation), std::sin(kElevation);
  R_EF = R_EF * ExpRotation(Vector3(0, 0, kAzimuth)) * LaidFlat(task, parts);
  Vector3 low = Vector3::Constant(1e9), high = -low;
  const auto each = [&](const auto& f) {
    for (size_t k = 0; k < parts.size(); ++k) {
      const auto& mesh = task.types[static_cast<size_t>(parts[k].type)].mesh;
      const Pose X_EP = Pose(R_EF) * parts[k].X_FP;
      for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<Vector3, 3> corners;
        for (size_t j = 0; j < 3; ++j) corners[j] = X_EP * mesh.vertices[static_cast<size_t>(mesh.triangles[t][j])];
        f(corners, static_cast<int16_t>(k));
      }
    }
  };
  each([&](const std::array<Vector3, 3>& corners, int16_t) {
    for (const auto& c : corners) {
      low = low.cwiseMin(c);
      high = high.cwiseMax(c);
    }
  });
  const double margin = 12 * kFiner, scale = (width * kFiner - 2 * margin) / std::max(1e-6, high.x() - low.x());
  const int rows = std::clamp(static_cast<int>((high.y() - low.y()) * scale + 2 * margin), 16, 4 * width * kFiner);
  Canvas canvas({width * kFiner, rows});
  each([&](std::array<Vector3, 3> corners, int16_t index) {
    const Vector3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    if (n.z() <= 0) return;  // seen from behind
    for (auto& c : corners) c = Vector3((c.x() - low.x()) * scale + margin, (high.y() - c.y()) * scale + margin, c.z());
    canvas.Fill(corners, n, index);
  });
  cv::Mat picture;
  cv::resize(Shaded(canvas, task, parts), picture, {}, 1.0 / kFiner, 1.0 / kFiner, cv::INTER_AREA);
  return picture;
}

namespace {

/// Every slot's part where it is in the end.
std::vector<DrawnPart> WholeOf(const Task& task) {
  std::vector<DrawnPart> whole;
  if (task.variants.empty()) return whole;
  const auto poses = SlotPoses(task, task.variants[0]);
  for (size_t s = 0; s < task.slots.size(); ++s) whole.push_back({task.slots[s].type, poses[s], false});
  return whole;
}

}  // namespace

std::string CoverOf(const Task& task) {
  std::map<int, int> all;
  for (size_t t = 0; t < task.types.size(); ++t) all[static_cast<int>(t)] = task.types[t].count;
  const std::string title = Text(kPageWidth / 2.0, 90, 54, Readable(task.name));
  const auto whole = WholeOf(task);
  if (whole.empty()) return Svg(title + PartRow(task, all, 200, 260));
  return Svg(title + Image(DrawParts(task, whole, 1000), 250, 120, 500, 320) + PartRow(task, all, 480, 120));
}

std::vector<BookPage> PictureBook(const Task& task) {
  std::vector<BookPage> pages{{"cover", CoverOf(task)}};
  const auto whole = WholeOf(task);
  if (whole.empty()) return pages;
  std::vector<DrawnPart> built;
  std::set<int> there;
  for (const int step : task.steps) {
    const Connection& c = task.connections[static_cast<size_t>(step)];
    for (auto& part : built) part.is_new = false;
    std::map<int, int> needed;
    for (const int slot : {c.slot_a, c.slot_b}) {
      if (!there.insert(slot).second) continue;
      built.push_back(whole[static_cast<size_t>(slot)]);
      built.back().is_new = true;
      ++needed[task.slots[static_cast<size_t>(slot)].type];
    }
    const std::string number = std::to_string(pages.size());
    pages.push_back(
        {"step_" + number, Svg(Text(80, 110, 90, number) + Image(DrawParts(task, built, 1100), 150, 40, 700, 470) +
                               (needed.empty() ? "" : PartRow(task, needed, 530, 100)))});
  }
  pages.push_back({"whole", Svg(Text(80, 110, 90, "✓") + Image(DrawParts(task, whole, 1100), 100, 80, 800, 560))});
  return pages;
}

std::string BookHtml(const Task& task, const std::vector<BookPage>& pages) {
  std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + Readable(task.name) +
                     "</title>\n<style>@page{size:A4 landscape;margin:8mm}body{margin:0}svg{display:block;width:100%;"
                     "max-height:96vh;break-after:page}</style></head><body>\n";
  for (const auto& page : pages) html += page.svg;
  return html + "</body></html>\n";
}

}  // namespace coach
