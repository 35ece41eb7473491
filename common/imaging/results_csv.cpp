#include "common/imaging/results_csv.h"

#include <cstdio>
#include <stdexcept>

namespace coach {
namespace {

std::ofstream Open(const std::filesystem::path& file, const char* header) {
  std::ofstream out(file);
  if (!(out << header << std::flush)) throw std::runtime_error(file.string() + ": cannot be written");
  return out;
}

void Check(std::ofstream& out, const std::filesystem::path& file) {
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written (disk full?)");
}

template <class... Args>
std::string Print(const char* format, Args... args) {
  char text[128];
  std::snprintf(text, sizeof text, format, args...);
  return text;
}

std::vector<std::string> InstanceNames(const Task& task) {
  std::vector<std::string> names;
  for (const Part& part : task.parts) names.push_back(part.name);
  return names;
}

std::string NameOf(const std::vector<std::string>& instances, int part) {
  return part >= 0 && static_cast<size_t>(part) < instances.size() ? instances[static_cast<size_t>(part)] : "";
}

void CheckParts(size_t found, size_t expected) {
  if (found != expected)
    throw std::invalid_argument("poses of " + std::to_string(found) + " parts for a task of " +
                                std::to_string(expected));
}

}  // namespace

PosesCsv::PosesCsv(const std::filesystem::path& file, const Task& task, int scene_id)
    : file_(file), out_(Open(file, "scene_id,im_id,obj_id,score,R,t,time\n")), scene_id_(scene_id) {
  for (size_t i = 0; i < task.parts.size(); ++i) object_ids_.push_back(task.TypeOf(static_cast<int>(i)).bop_id);
  last_X_TP_.assign(task.parts.size(), Pose::Identity());
  seen_.assign(task.parts.size(), false);
}

void PosesCsv::Write(int im_id, const PartPoses& poses) {
  CheckParts(poses.parts.size(), object_ids_.size());
  const Pose X_CT = poses.X_TC.inverse();
  for (size_t i = 0; i < poses.parts.size(); ++i) {
    const PartEstimate& part = poses.parts[i];
    const bool found = part.status != PartStatus::kAbsent && part.status != PartStatus::kLost;
    if (found) {
      last_X_TP_[i] = part.X_TP;
      seen_[i] = true;
    }
    const Pose X_CP = seen_[i] ? X_CT * last_X_TP_[i] : Pose::Identity();
    std::string R, t;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) R += Print("%s%.8f", R.empty() ? "" : " ", X_CP.linear()(r, c));
    for (int r = 0; r < 3; ++r) t += Print("%s%.5f", r ? " " : "", X_CP.translation()(r) * 1000);
    out_ << scene_id_ << ',' << im_id << ',' << object_ids_[i] << ',' << Print("%.6f", found ? part.confidence : 0.)
         << ',' << R << ',' << t << ",-1\n";
  }
  Check(out_, file_);
}

StatesCsv::StatesCsv(const std::filesystem::path& file, const Task& task)
    : file_(file), instances_(InstanceNames(task)) {
  std::string header = "im_id,instance,status,visible_fraction,confidence,ambiguous_with,ambiguous_probability";
  for (int i = 0; i < 21; ++i) header += Print(",c_%d", i);
  out_ = Open(file, (header + "\n").c_str());
}

void StatesCsv::Write(int im_id, const PartPoses& poses) {
  CheckParts(poses.parts.size(), instances_.size());
  for (size_t i = 0; i < poses.parts.size(); ++i) {
    const PartEstimate& part = poses.parts[i];
    out_ << im_id << ',' << instances_[i] << ',' << ToString(part.status)
         << Print(",%.6f,%.6f,", part.visible_fraction, part.confidence) << NameOf(instances_, part.ambiguous_with)
         << Print(",%.6f", part.ambiguous_probability);
    const Matrix6 covariance_C = RotateCovariance(poses.X_TC.linear().transpose(), part.covariance);
    for (int r = 0; r < 6; ++r)
      for (int c = r; c < 6; ++c) out_ << Print(",%.9g", covariance_C(r, c));
    out_ << '\n';
  }
  Check(out_, file_);
}

EventsCsv::EventsCsv(const std::filesystem::path& file, const Task& task, int64_t first_utime)
    : file_(file),
      out_(Open(file, "time,connection,type,part_a,part_b,probability,decided\n")),
      instances_(InstanceNames(task)),
      first_utime_(first_utime) {}

void EventsCsv::Write(const GuidanceEvent& event) {
  if (event.kind != "connect" && event.kind != "wrong" && event.kind != "disconnect") return;
  const auto seconds = [&](int64_t utime) { return Print("%.6f", static_cast<double>(utime - first_utime_) * 1e-6); };
  out_ << seconds(event.since) << ',' << event.subject << ',' << event.kind << ',' << NameOf(instances_, event.part_a)
       << ',' << NameOf(instances_, event.part_b) << ',' << Print("%.6f", event.probability) << ','
       << seconds(event.utime) << '\n';
  Check(out_, file_);
}

TimingsCsv::TimingsCsv(const std::filesystem::path& file) : file_(file), out_(Open(file, "im_id,stage,seconds\n")) {}

void TimingsCsv::Write(int im_id, const std::string& stage, double seconds) {
  out_ << im_id << ',' << stage << Print(",%.6f\n", seconds);
  Check(out_, file_);
}

}  // namespace coach
