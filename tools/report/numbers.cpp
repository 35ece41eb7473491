#include "tools/report/numbers.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace coach {
namespace {

constexpr int64_t kFirstDate = 978307200;  // s since 1970: the year 2001

}  // namespace

std::string Fixed(double value, int digits) {
  if (!std::isfinite(value)) return "";
  char text[400];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, digits);
  if (error != std::errc()) return "";
  std::string out(text, end);
  if (out.find_first_not_of("-0.") == std::string::npos && out[0] == '-') out.erase(0, 1);
  return out;
}

std::optional<double> ParseNumber(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::string Clock(double seconds, bool tenths) {
  if (!std::isfinite(seconds)) return "";
  const auto t = static_cast<long long>(std::llround(std::abs(seconds) * (tenths ? 10 : 1)));
  const long long whole = tenths ? t / 10 : t;
  char text[64];
  const int length = std::snprintf(text, sizeof text, "%s%lld:%02lld", seconds < 0 ? "-" : "", whole / 60, whole % 60);
  if (tenths) std::snprintf(text + length, sizeof text - static_cast<size_t>(length), ".%lld", t % 10);
  return text;
}

std::string Date(int64_t utime) {
  const std::time_t seconds = utime / 1000000;
  if (seconds < kFirstDate) return "";
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &utc);
  return text;
}

}  // namespace coach
