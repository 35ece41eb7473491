// coach-pose-filter: the pose of every part in every frame.
#include <CLI/CLI.hpp>

#include "common/assembly/task_file.h"
#include "common/bus/service_main.h"
#include "services/pose_filter/full_filter.h"
#include "services/pose_filter/pose_filter_service.h"

namespace coach {
namespace {

struct FilterSettings {
  FullFilterOptions filter;
  int64_t seed = 1;
};

FilterSettings ReadSettings(const YamlNode& section) {
  FilterSettings settings;
  settings.seed = section.Get<int64_t>("seed", settings.seed);
  settings.filter.particles = static_cast<int>(section.GetInRange("particles", settings.filter.particles, 10, 10'000));
  section.RejectUnknownKeys();
  return settings;
}

void RunFilter(ServiceContext& context) {
  const Station& station = context.station;
  const FilterSettings settings = ReadSettings(station.Section("pose_filter"));
  if (station.task.empty()) throw ConfigurationError("no task: give task in the station file, or --task");
  const Task task = LoadTask(station.task);
  PoseFilterServiceOptions options;
  if (!station.state_folder.empty()) options.state_file = station.state_folder / "pose-filter.json";
  context.node.expects_frames = true;
  PoseFilterService(
      context.node, task,
      std::make_unique<FullFilter>(task, settings.filter, static_cast<uint64_t>(settings.seed), SerialFor()), options)
      .Run();
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  return coach::ServiceMain(argc, argv, "pose-filter", "Tracks the pose of every part of the task.", nullptr,
                            coach::RunFilter);
}
