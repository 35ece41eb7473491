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
#include "tools/track_sequence/cures.h"

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
  if (options.paper) {
    PaperFilterOptions paper;
    paper.colour = ColourUseByName(options.paper_colour);
    return std::make_unique<PaperFilter>(task, paper, options.seed);
  }
  FullFilterOptions full;
  for (const std::string& cure : options.without) full = Without(cure, full);
  return std::make_unique<FullFilter>(task, full, options.seed);
}

AssemblyReasonerOptions ReasonerOptions(const SequenceOptions& options) {
  AssemblyReasonerOptions out;
  out.paper = options.paper;
  return out;
}

/// One tracker and reasoner on their way through the scene.
class Run {
 public:
  Run(const SequenceOptions& options, const Task& task, const SceneReader& reader)
      : filter_(MakeFilter(options, task)),
        reasoner_(task, ReasonerOptions(options)),
        results_(options, task, reader),
        observe_(options.observe) {
    if (options.initial_poses_from_gt) filter_->Suggest(TruePoses(options.scene, task, reader.im_id(0)));
  }

  void Step(int im_id, const Frame& frame, const Detections& detections, double detector_time) {
    FilterInput input;
    input.utime = frame.utime;
    input.sequence = frame.sequence;
    input.camera = frame.camera;
    input.depth = frame.depth;
    input.metres_per_unit = frame.metres_per_unit;
    input.colour = frame.colour;
    input.detections = &detections;
    input.belief = &belief_;
    const double t0 = ProcessorTime();
    const PartPoses& poses = filter_->Step(input);
    const double t1 = ProcessorTime();
    ReasonerOutput reasoned = reasoner_.Step(poses);
    const double t2 = ProcessorTime();
    belief_ = std::move(reasoned.belief);
    if (observe_) observe_(poses);
    detector_times_.push_back(detector_time);
    filter_times_.push_back(t1 - t0);
    results_.Write(im_id, poses);
    results_.Write(im_id, "detector", detector_time);
    results_.Write(im_id, "pose_filter", t1 - t0);
    results_.Write(im_id, "assembly_reasoner", t2 - t1);
    for (const ConnectionEvent& e : reasoned.events) results_.Write(e);
    events_ += static_cast<int>(reasoned.events.size());
  }

  SequenceSummary Summary(int dropped) const {
    SequenceSummary s;
    s.frames = static_cast<int>(filter_times_.size());
    s.dropped = dropped;
    s.events = events_;
    s.detector_median = Percentile(detector_times_, 0.5);
    s.detector_p99 = Percentile(detector_times_, 0.99);
    s.filter_median = Percentile(filter_times_, 0.5);
    s.filter_p99 = Percentile(filter_times_, 0.99);
    return s;
  }

 private:
  std::unique_ptr<PoseFilter> filter_;
  AssemblyReasoner reasoner_;
  Results results_;
  std::function<void(const PartPoses&)> observe_;
  ConnectionBelief belief_;
  std::vector<double> detector_times_, filter_times_;
  int events_ = 0;
};

/// Scene, task, frame rate and `realtime` are those of the first.
std::vector<SequenceSummary> TrackTogether(const std::vector<SequenceOptions>& all) {
  if (all.empty()) return {};
  const SequenceOptions& first = all.front();
  const Task task = LoadTask(first.task);
  const SceneReader reader(first.scene, {.fps = first.fps, .utime_origin = 0});
  HsvDetector detector(task);
  std::vector<std::unique_ptr<Run>> runs;
  for (const SequenceOptions& options : all) runs.push_back(std::make_unique<Run>(options, task, reader));
  int dropped = 0;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < reader.size(); ++i) {
    if (first.realtime && i > 0) {
      // A live camera would be at this frame by now: what has passed is lost.
      const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const int live = static_cast<int>(now * 1e6 / reader.period_us());
      dropped += std::max(0, std::min(live, reader.size() - 1) - i);
      i = std::clamp(live, i, reader.size() - 1);
    }
    const Frame frame = reader.Read(i);
    const double t0 = ProcessorTime();
    const Detections detections = detector.Detect(frame.colour, frame.depth, frame.metres_per_unit);
    const double detector_time = ProcessorTime() - t0;
    for (const auto& run : runs) run->Step(reader.im_id(i), frame, detections, detector_time);
  }
  std::vector<SequenceSummary> summaries;
  for (const auto& run : runs) summaries.push_back(run->Summary(dropped));
  return summaries;
}

}  // namespace

SequenceSummary TrackSequence(const SequenceOptions& options) { return TrackTogether({options}).front(); }

void TrackVariants(const SequenceOptions& options, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::vector<SequenceOptions> runs;
  const auto add = [&](const std::string& name, SequenceOptions run) {
    run.poses = folder / (name + "_poses.csv"), run.states = folder / (name + "_states.csv");
    run.events = folder / (name + "_events.csv"), run.timings = folder / (name + "_timings.csv");
    runs.push_back(std::move(run));
  };
  SequenceOptions full = options, paper = options;
  full.paper = false, full.without.clear(), paper.paper = true;
  add("full", full);
  for (const std::string& cure : CureNames()) {
    full.without = {cure};
    add("full-without-" + cure, full);
  }
  for (const std::string colour : {"input", "observation", "fused"}) {
    paper.paper_colour = colour;
    add(colour == "input" ? "paper" : "paper-" + colour, paper);
  }
  TrackTogether(runs);
}

}  // namespace coach
