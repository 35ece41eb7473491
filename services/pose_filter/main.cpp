// coach-pose-filter: the pose of every part in every frame.
#include <CLI/CLI.hpp>

#include "common/assembly/task_file.h"
#include "common/bus/service_main.h"
#include "common/bus/task_follower.h"
#include "services/pose_filter/full_filter.h"
#include "services/pose_filter/paper_filter.h"
#include "services/pose_filter/pose_filter_service.h"

namespace coach {
namespace {

PoseFilterService::MakeFilter ReadFilter(const YamlNode& section) {
  const std::string mode = section.GetChoice("mode", "full", {"full", "paper"});
  const auto seed = static_cast<uint64_t>(section.Get<int64_t>("seed", 1));
  FullFilterOptions full;
  PaperFilterOptions paper;
  full.particles = static_cast<int>(section.GetInRange("particles", full.particles, 10, 10'000));
  paper.particles = static_cast<int>(section.GetInRange("particles", paper.particles, 10, 10'000));
  section.RejectUnknownKeys();
  if (mode == "paper")
    return [paper, seed](const Task& task) { return std::make_unique<PaperFilter>(task, paper, seed); };
  return [full, seed](const Task& task) { return std::make_unique<FullFilter>(task, full, seed); };
}

void RunFilter(ServiceContext& context) {
  const Station& station = context.station;
  const PoseFilterService::MakeFilter make_filter = ReadFilter(station.Section("pose_filter"));
  if (station.task.empty()) throw ConfigurationError("no task: give task in the station file, or --task");
  const Task task = LoadTask(station.task);
  PoseFilterServiceOptions options;
  if (!station.state_folder.empty()) options.state_file = station.state_folder / "pose-filter.json";
  context.node.expects_frames = true;
  PoseFilterService service(context.node, task, make_filter, options);
  const TaskFollower follower(service.node(), station, task.sha256, [&](const Task& other) { service.SetTask(other); });
  service.Run();
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  return coach::ServiceMain(argc, argv, "pose-filter", "Tracks the pose of every part of the task.", nullptr,
                            coach::RunFilter);
}
