#include "tools/simulator/scene_recorder.h"

#include "common/imaging/scene_folder.h"
#include "tools/simulator/truth_files.h"

namespace coach {

void RecordScene(const Scenario& scenario, const std::filesystem::path& folder, const RecordOptions& options,
                 const std::function<void(int)>& progress) {
  Simulator simulator(scenario.stage, scenario.options.seed);
  SceneWriter::Options writer_options;
  writer_options.jpeg = options.jpeg;
  writer_options.jpeg_quality = options.jpeg_quality;
  std::vector<FrameTruth> frames;
  ColourRanges ranges(scenario.stage.task);
  {
    SceneWriter writer(folder, writer_options);
    for (size_t i = 0; i < scenario.frame_times.size(); ++i) {
      FrameTruth truth;
      const Frame frame = simulator.Render(scenario.performance, scenario.camera, scenario.frame_times[i], &truth);
      writer.Write(frame, scenario.image_ids[i]);
      if (i % 5 == 0) ranges.Add(frame.colour, truth.part_at);
      truth.part_at.release();
      frames.push_back(std::move(truth));
      if (progress) progress(static_cast<int>(i) + 1);
    }
  }
  WriteModels(folder, scenario.stage.task);
  WriteTask(folder, scenario.stage.task, ranges.Ranges());
  WriteAssembly(folder, scenario, ranges.Ranges());
  WriteTruth(folder, scenario, frames);
  WriteEvents(folder, scenario, frames);
}

}  // namespace coach
