#include "tools/study/report_text.h"

#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "tools/evaluate/evaluation.h"
#include "tools/study/study.h"

namespace coach {

std::string Number(double x, int digits) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(digits) << x;
  return out.str();
}

std::string Share(int k, int n) {
  const Interval i = WilsonInterval(k, n);
  return n == 0 ? "-"
                : Number(100.0 * k / n, 1) + " % (" + std::to_string(k) + "/" + std::to_string(n) + ", " +
                      Number(i.low, 0) + " to " + Number(i.high, 0) + ")";
}

std::string Median(const std::vector<double>& values, int digits) {
  if (values.empty()) return "-";
  const Interval i = MedianInterval(values);
  return Number(Quantile(values, 0.5), digits) + " (" + Number(i.low, digits) + " to " + Number(i.high, digits) + ")";
}

void WriteText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": can't be written");
}

}  // namespace coach
