#include "tools/evaluate/estimates.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace coach {
namespace {

std::vector<std::string> Split(const std::string& line) {
  std::vector<std::string> fields;
  std::stringstream in(line);
  for (std::string field; std::getline(in, field, ',');) {
    field.erase(0, field.find_first_not_of(" \t\r"));
    field.erase(field.find_last_not_of(" \t\r") + 1);
    fields.push_back(field);
  }
  return fields;
}

bool Number(const std::string& text, double* value) {
  char* end = nullptr;
  *value = std::strtod(text.c_str(), &end);
  return !text.empty() && end == text.c_str() + text.size();
}

/// Calls `row` for each line that is not a header; what it throws gets file and line.
template <class Row>
void ForEachRow(const std::filesystem::path& file, size_t least_fields, const Row& row) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": can't be read");
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const auto fields = Split(line);
    double unused;
    if (fields.empty() || (number == 1 && !Number(fields[0], &unused))) continue;
    if (fields.size() < least_fields || !row(fields)) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) +
                               ": not a row of such a file: " + line.substr(0, 60));
    }
  }
}

bool Numbers(const std::string& text, size_t n, std::vector<double>* values) {
  std::stringstream in(text);
  values->clear();
  for (double x; in >> x;) values->push_back(x);
  return values->size() == n;
}

std::map<int, int> FrameOfImage(const SceneTruth& truth) {
  std::map<int, int> frames;
  for (int f = 0; f < truth.frames(); ++f) frames[truth.image_ids[static_cast<size_t>(f)]] = f;
  return frames;
}

void ReadPoses(const std::filesystem::path& file, const SceneTruth& truth, Estimates* e) {
  const auto frames = FrameOfImage(truth);
  std::map<int, std::vector<int>> parts_of;
  for (int k = 0; k < truth.parts(); ++k) parts_of[truth.objects[static_cast<size_t>(k)].obj_id].push_back(k);
  std::map<std::pair<int, int>, size_t> count;
  e->X_CP.assign(truth.image_ids.size(), std::vector<std::optional<Pose>>(truth.objects.size()));
  ForEachRow(file, 6, [&](const std::vector<std::string>& row) {
    double image = 0, obj_id = 0;
    std::vector<double> R, t;
    if (!Number(row[1], &image) || !Number(row[2], &obj_id) || !Numbers(row[4], 9, &R) || !Numbers(row[5], 3, &t))
      return false;
    const auto frame = frames.find(static_cast<int>(image));
    const auto parts = parts_of.find(static_cast<int>(obj_id));
    if (frame == frames.end() || parts == parts_of.end()) return true;
    const size_t n = count[{frame->first, parts->first}]++;
    if (n >= parts->second.size()) return true;
    Pose X = Pose::Identity();
    X.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
    X.translation() = 0.001 * Eigen::Map<const Vector3>(t.data());
    if (X.matrix().allFinite()) e->X_CP[static_cast<size_t>(frame->second)][static_cast<size_t>(parts->second[n])] = X;
    return true;
  });
}

/// Rows name instances; the n-th name that comes up is the n-th part, kinds in the order of their first part.
void ReadStates(const std::filesystem::path& file, const SceneTruth& truth, Estimates* e) {
  const auto frames = FrameOfImage(truth);
  std::vector<int> order;
  for (int k = 0; k < truth.parts(); ++k) {
    if (std::find(order.begin(), order.end(), k) != order.end()) continue;
    for (int j = k; j < truth.parts(); ++j) {
      if (truth.objects[static_cast<size_t>(j)].obj_id == truth.objects[static_cast<size_t>(k)].obj_id)
        order.push_back(j);
    }
  }
  std::vector<std::string> names;
  e->states.assign(truth.image_ids.size(), std::vector<std::optional<StateRow>>(truth.objects.size()));
  ForEachRow(file, 28, [&](const std::vector<std::string>& row) {
    double image = 0;
    if (!Number(row[0], &image)) return false;
    auto name = std::find(names.begin(), names.end(), row[1]);
    if (name == names.end()) name = names.insert(names.end(), row[1]);
    const size_t n = static_cast<size_t>(name - names.begin());
    const auto frame = frames.find(static_cast<int>(image));
    if (frame == frames.end() || n >= order.size()) return true;
    StateRow state{row[2]};
    size_t field = row.size() - 21;
    for (int r = 0; r < 6; ++r) {
      for (int c = r; c < 6; ++c, ++field) {
        double x = 0;
        if (!Number(row[field], &x)) return false;
        state.covariance(r, c) = state.covariance(c, r) = x;
      }
    }
    e->states[static_cast<size_t>(frame->second)][static_cast<size_t>(order[n])] = state;
    return true;
  });
}

}  // namespace

ResultFiles Companions(const std::filesystem::path& poses) {
  ResultFiles files{poses, {}, {}, {}};
  const std::string name = poses.filename().string();
  const size_t at = name.rfind("poses");
  if (at == std::string::npos) return files;
  const auto companion = [&](const std::string& kind) {
    std::string other = name;
    other.replace(at, 5, kind);
    const std::filesystem::path path = poses.parent_path() / other;
    return std::filesystem::exists(path) ? path : std::filesystem::path();
  };
  files.events = companion("events");
  files.states = companion("states");
  files.timings = companion("timings");
  return files;
}

Estimates ReadEstimates(const ResultFiles& files, const SceneTruth& truth) {
  Estimates e;
  e.name = files.poses.string();
  ReadPoses(files.poses, truth, &e);
  if (!files.states.empty()) ReadStates(files.states, truth, &e);
  if (!files.events.empty()) {
    e.has_events = true;
    ForEachRow(files.events, 3, [&](const std::vector<std::string>& row) {
      EventRow event{0, row[1], row[2], 0};
      if (!Number(row[0], &event.time)) return false;
      if (row.size() < 7 || !Number(row[6], &event.decided)) event.decided = event.time;
      e.events.push_back(event);
      return true;
    });
    std::stable_sort(e.events.begin(), e.events.end(),
                     [](const EventRow& a, const EventRow& b) { return a.time < b.time; });
  }
  if (!files.timings.empty()) {
    ForEachRow(files.timings, 3, [&](const std::vector<std::string>& row) {
      double seconds = 0;
      if (!Number(row[2], &seconds)) return false;
      e.stage_ms[row[1]].push_back(1000 * seconds);
      return true;
    });
  }
  return e;
}

}  // namespace coach
