#include "tools/track_sequence/sequence_tracker.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/assembly/task_file.h"
#include "common/imaging/results_csv.h"
#include "common/imaging/scene_folder.h"
#include "services/assembly_reasoner/assembly_reasoner.h"
#include "services/detector/hsv_detector.h"
#include "services/pose_filter/full_filter.h"
#include "services/pose_filter/paper_filter.h"

namespace coach {
namespace {

/// Processor time of this thread, s: what a step costs, whatever else the machine does.
double ProcessorTime() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The files of one run.
class Results {
 public:
  Results(const SequenceOptions& options, const Task& task, const SceneReader& reader) {
    if (!options.poses.empty()) poses_ = std::make_unique<PosesCsv>(options.poses, task, reader.scene_id());
    if (!options.states.empty()) states_ = std::make_unique<StatesCsv>(options.states, task);
    if (!options.events.empty()) events_ = std::make_unique<EventsCsv>(options.events, task, reader.utime(0));
    if (!options.timings.empty()) timings_ = std::make_unique<TimingsCsv>(options.timings);
  }

  void Write(int im_id, const PartPoses& poses) {
    if (poses_) poses_->Write(im_id, poses);
    if (states_) states_->Write(im_id, poses);
  }

  void Write(const ConnectionEvent& e) {
    if (!events_) return;
    GuidanceEvent g;
    g.utime = e.decided;
    g.since = e.since;
    g.kind = e.type;
    g.subject = e.name;
    g.part_a = e.part_a;
    g.part_b = e.part_b;
    g.probability = e.probability;
    events_->Write(g);
  }

  void Write(int im_id, const char* stage, double seconds) {
    if (timings_) timings_->Write(im_id, stage, seconds);
  }

 private:
  std::unique_ptr<PosesCsv> poses_;
  std::unique_ptr<StatesCsv> states_;
  std::unique_ptr<EventsCsv> events_;
  std::unique_ptr<TimingsCsv> timings_;
};

/// Poses of the first frame by scene_gt.json, in the order of the task's instances.
std::vector<Pose> TruePoses(const std::filesystem::path& scene, const Task& task, int im_id) {
  const std::filesystem::path file = scene / "scene_gt.json";
  std::ifstream in(file);
  const nlohmann::json all = nlohmann::json::parse(in, nullptr, false);
  const std::string key = std::to_string(im_id);
  if (all.is_discarded() || !all.contains(key)) throw std::runtime_error(file.string() + ": no poses of image " + key);
  std::vector<Pose> out(task.parts.size(), Pose::Identity());
  std::vector<bool> taken(task.parts.size(), false);
  for (const auto& g : all[key]) {
    for (size_t k = 0; k < task.parts.size(); ++k) {
      if (taken[k] || task.TypeOf(static_cast<int>(k)).bop_id != g.at("obj_id").get<int>()) continue;
      const auto R = g.at("cam_R_m2c").get<std::vector<double>>(), t = g.at("cam_t_m2c").get<std::vector<double>>();
      out[k] = MakePose(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data()),
                        Vector3(t[0], t[1], t[2]) * 1e-3);
      taken[k] = true;
      break;
    }
  }
  return out;
}

std::unique_ptr<PoseFilter> MakeFilter(const SequenceOptions& options, const Task& task) {
  if (options.paper) return std::make_unique<PaperFilter>(task, PaperFilterOptions{}, options.seed);
  return std::make_unique<FullFilter>(task, FullFilterOptions{}, options.seed);
}

}  // namespace

SequenceSummary TrackSequence(const SequenceOptions& options) {
  const Task task = LoadTask(options.task);
  const SceneReader reader(options.scene, {.fps = options.fps, .utime_origin = 0});
  HsvDetector detector(task);
  const std::unique_ptr<PoseFilter> filter = MakeFilter(options, task);
  AssemblyReasonerOptions reasoner_options;
  reasoner_options.paper = options.paper;
  AssemblyReasoner reasoner(task, reasoner_options);
  Results results(options, task, reader);
  if (options.initial_poses_from_gt) filter->Suggest(TruePoses(options.scene, task, reader.im_id(0)));

  SequenceSummary summary;
  std::vector<double> detector_times, filter_times;
  ConnectionBelief belief;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < reader.size(); ++i) {
    if (options.realtime && i > 0) {
      // A live camera would be at this frame by now: what has passed is lost.
      const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const int live = static_cast<int>(now * 1e6 / reader.period_us());
      summary.dropped += std::max(0, std::min(live, reader.size() - 1) - i);
      i = std::clamp(live, i, reader.size() - 1);
    }
    const Frame frame = reader.Read(i);
    const double t0 = ProcessorTime();
    const Detections detections = detector.Detect(frame.colour, frame.depth, frame.metres_per_unit);
    const double t1 = ProcessorTime();
    FilterInput input;
    input.utime = frame.utime;
    input.sequence = frame.sequence;
    input.camera = frame.camera;
    input.depth = frame.depth;
    input.metres_per_unit = frame.metres_per_unit;
    input.colour = frame.colour;
    input.detections = &detections;
    input.belief = &belief;
    const PartPoses& poses = filter->Step(input);
    const double t2 = ProcessorTime();
    ReasonerOutput reasoned = reasoner.Step(poses);
    const double t3 = ProcessorTime();
    belief = std::move(reasoned.belief);
    if (options.observe) options.observe(poses);
    detector_times.push_back(t1 - t0);
    filter_times.push_back(t2 - t1);
    const int im_id = reader.im_id(i);
    results.Write(im_id, poses);
    results.Write(im_id, "detector", t1 - t0);
    results.Write(im_id, "pose_filter", t2 - t1);
    results.Write(im_id, "assembly_reasoner", t3 - t2);
    for (const ConnectionEvent& e : reasoned.events) results.Write(e);
    summary.events += static_cast<int>(reasoned.events.size());
    ++summary.frames;
  }
  summary.detector_median = Percentile(detector_times, 0.5);
  summary.detector_p99 = Percentile(detector_times, 0.99);
  summary.filter_median = Percentile(filter_times, 0.5);
  summary.filter_p99 = Percentile(filter_times, 0.99);
  return summary;
}

}  // namespace coach
