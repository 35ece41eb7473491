#include "tools/report/svg.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tools/report/numbers.h"

namespace coach::svg {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";  // U+FFFD

std::string N(double value) { return Fixed(value, 1); }
std::string Class(const std::string& style) { return style.empty() ? "" : " class=\"" + style + "\""; }

std::string Closed(const std::string& tag, const std::string& attributes, const std::string& style,
                   const std::string& title) {
  const std::string begin = "<" + tag + Class(style) + attributes;
  if (title.empty()) return begin + "/>";
  return begin + "><title>" + Escaped(title) + "</title></" + tag + ">";
}

/// Bytes of the UTF-8 character at i; 0 if it is broken, overlong, a surrogate or too large.
size_t CharacterLength(std::string_view text, size_t i) {
  const auto byte = [&](size_t k) { return static_cast<uint8_t>(text[k]); };
  const uint8_t lead = byte(i);
  const size_t length = lead < 0x80                   ? 1
                        : lead >= 0xC2 && lead < 0xE0 ? 2
                        : lead >= 0xE0 && lead < 0xF0 ? 3
                        : lead >= 0xF0 && lead < 0xF5 ? 4
                                                      : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xC0) != 0x80) return 0;
  }
  if ((lead == 0xE0 && byte(i + 1) < 0xA0) || (lead == 0xED && byte(i + 1) >= 0xA0) ||
      (lead == 0xF0 && byte(i + 1) < 0x90) || (lead == 0xF4 && byte(i + 1) >= 0x90))
    return 0;
  return length;
}

}  // namespace

std::string Escaped(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size();) {
    const size_t length = CharacterLength(text, i);
    if (length == 0) {
      out += kReplacement;
      ++i;
      continue;
    }
    const char c = text[i];
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else if (length == 1 && (static_cast<uint8_t>(c) < 0x20 || c == 0x7F) && c != '\n' && c != '\t') {
      out += kReplacement;
    } else {
      out += text.substr(i, length);
    }
    i += length;
  }
  return out;
}

std::string Shortened(std::string_view text, size_t characters) {
  size_t cut = 0, last = 0, count = 0;
  for (size_t i = 0; i < text.size(); ++count) {
    if (count < characters) last = cut;
    i += std::max<size_t>(1, CharacterLength(text, i));
    if (count < characters) cut = i;
  }
  if (count <= characters) return std::string(text);
  return std::string(text.substr(0, last)) + "…";
}

std::string Rect(double x, double y, double width, double height, const std::string& style, const std::string& title) {
  return Closed("rect",
                " x=\"" + N(x) + "\" y=\"" + N(y) + "\" width=\"" + N(width) + "\" height=\"" + N(height) + "\"", style,
                title);
}

std::string Line(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line" + Class(style) + " x1=\"" + N(x1) + "\" y1=\"" + N(y1) + "\" x2=\"" + N(x2) + "\" y2=\"" + N(y2) +
         "\"/>";
}

std::string Circle(double x, double y, double radius, const std::string& style, const std::string& title) {
  return Closed("circle", " cx=\"" + N(x) + "\" cy=\"" + N(y) + "\" r=\"" + N(radius) + "\"", style, title);
}

std::string Path(const std::vector<std::pair<double, double>>& points, bool closed, const std::string& style,
                 const std::string& title) {
  if (points.empty()) return "";
  std::string d;
  for (const auto& [x, y] : points) {
    d += d.empty() ? 'M' : 'L';
    d += N(x) + ',' + N(y);
  }
  if (closed) d += 'Z';
  return Closed("path", " d=\"" + d + "\"", style, title);
}

std::string Text(double x, double y, std::string_view text, const std::string& style) {
  return "<text" + Class(style) + " x=\"" + N(x) + "\" y=\"" + N(y) + "\">" + Escaped(text) + "</text>";
}

std::string Picture(double width, double height, const std::string& label, const std::string& content) {
  return "<svg viewBox=\"0 0 " + N(width) + " " + N(height) + "\" role=\"img\" aria-label=\"" + Escaped(label) +
         "\">\n" + content + "</svg>\n";
}

double RoundStep(double range, int most) {
  if (!(range > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(range / most)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (range / (factor * power) <= most) return factor * power;
  }
  return 10 * power;
}

double RoundTimeStep(double range, int most) {
  for (const double step : {1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600}) {
    if (range / step <= most) return step;
  }
  return 3600 * RoundStep(range / 3600, most);
}

}  // namespace coach::svg
