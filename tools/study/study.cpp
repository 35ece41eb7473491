#include "tools/study/study.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <mutex>
#include <random>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace coach {
namespace {

std::filesystem::path UnitFile(const std::filesystem::path& folder, const std::string& unit) {
  return folder / "units" / (unit + ".json");
}

void WriteWhole(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream out(part, std::ios::binary);
  out << text << "\n";
  out.close();
  if (!out) throw std::runtime_error(part.string() + ": can't be written");
  std::filesystem::rename(part, file);
}

}  // namespace

Shard ParseShard(const std::string& text) {
  Shard shard;
  char slash = 0, rest = 0;
  std::istringstream in(text);
  if (!(in >> shard.index >> slash >> shard.count) || slash != '/' || (in >> rest) || shard.index < 1 ||
      shard.index > shard.count) {
    throw std::invalid_argument("shard: found " + text + ", expected i/n with 1 <= i <= n");
  }
  --shard.index;
  return shard;
}

int RunUnits(const StudyRun& run, const std::vector<std::string>& units,
             const std::function<std::string(const std::string&)>& unit, std::ostream& log) {
  std::filesystem::create_directories(run.folder / "units");
  std::vector<std::string> open;
  for (size_t i = 0; i < units.size(); ++i) {
    const bool mine = static_cast<int>(i) % run.shard.count == run.shard.index;
    if (mine && !std::filesystem::exists(UnitFile(run.folder, units[i]))) open.push_back(units[i]);
  }
  std::mutex mutex;
  size_t next = 0, done = 0;
  int failed = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto work = [&] {
    for (;;) {
      std::unique_lock lock(mutex);
      if (next == open.size()) return;
      const std::string name = open[next++];
      lock.unlock();
      std::string problem;
      try {
        WriteWhole(UnitFile(run.folder, name), unit(name));
      } catch (const std::exception& e) {
        problem = e.what();
      }
      lock.lock();
      ++done;
      failed += !problem.empty();
      const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const double left = spent / static_cast<double>(done) * static_cast<double>(open.size() - done);
      log << done << "/" << open.size() << " " << name << (problem.empty() ? "" : ": FAILED: " + problem) << ", "
          << std::lround(left) << " s left" << std::endl;
    }
  };
  std::vector<std::thread> threads;
  for (int j = 1; j < run.jobs; ++j) threads.emplace_back(work);
  work();
  for (std::thread& t : threads) t.join();
  return failed;
}

std::vector<std::string> ReadUnits(const std::filesystem::path& folder, const std::vector<std::string>& units,
                                   std::vector<std::string>* missing) {
  std::vector<std::string> results;
  for (const std::string& unit : units) {
    std::ifstream in(UnitFile(folder, unit));
    if (!in) {
      missing->push_back(unit);
      continue;
    }
    results.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return results;
}

Interval WilsonInterval(int k, int n) {
  if (n == 0) return {};
  constexpr double z = 1.959964;
  const double p = static_cast<double>(k) / n;
  const double centre = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4.0 * n * n)) / (1 + z * z / n);
  return {100 * std::max(0.0, centre - half), 100 * std::min(1.0, centre + half)};
}

Interval MedianInterval(const std::vector<double>& values) {
  if (values.empty()) return {0, 0};
  std::mt19937_64 random(1);
  std::vector<double> medians, sample(values.size());
  for (int i = 0; i < 2000; ++i) {
    for (double& x : sample) x = values[random() % values.size()];
    std::nth_element(sample.begin(), sample.begin() + static_cast<long>(sample.size() / 2), sample.end());
    medians.push_back(sample[sample.size() / 2]);
  }
  std::sort(medians.begin(), medians.end());
  return {medians[49], medians[1949]};
}

}  // namespace coach
