// Studies as sets of independent, named units of work: resumable, split over machines, merged.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace coach {

/// Unit i of n goes to shard i % n.
struct Shard {
  int index = 0, count = 1;
};
/// "1/8" .. "8/8". @throws std::invalid_argument for another text.
Shard ParseShard(const std::string& text);

struct StudyRun {
  std::filesystem::path folder;  ///< results: folder/units/NAME.json
  Shard shard;
  int jobs = 1;  ///< units at a time
};

/// Computes every unit of this shard whose result is not there yet. A result is written under another name and then
/// renamed, so that an interrupted run leaves no half of one. A unit that throws is reported and left out.
/// @param unit makes the result (JSON text) of a unit by name.
/// @param log one line a unit, with the time left.
/// @returns the number of units that failed.
int RunUnits(const StudyRun& run, const std::vector<std::string>& units,
             const std::function<std::string(const std::string&)>& unit, std::ostream& log);

/// The results of the units, in their order; those that are missing are named in `missing`.
std::vector<std::string> ReadUnits(const std::filesystem::path& folder, const std::vector<std::string>& units,
                                   std::vector<std::string>* missing);

/// The 95 % interval of a share k / n (Wilson 1927), in percent.
struct Interval {
  double low = 0, high = 100;
};
Interval WilsonInterval(int k, int n);

/// The 95 % interval of the median by 2000 seeded bootstrap samples.
Interval MedianInterval(const std::vector<double>& values);

}  // namespace coach
