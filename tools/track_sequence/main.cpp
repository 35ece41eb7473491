// coach-track-sequence: tracks the parts of a recorded scene.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "tools/track_sequence/cures.h"
#include "tools/track_sequence/sequence_tracker.h"

namespace {

std::string Names() {
  std::string all;
  for (const std::string& cure : coach::CureNames()) all += (all.empty() ? "" : ", ") + cure;
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Tracks the parts of a recorded RGB-D scene, recognises their connections and writes both as csv files"};
  coach::SequenceOptions o;
  std::filesystem::path variants;
  app.add_option("scene", o.scene, "scene folder (rgb, depth, scene_camera.json)")->required();
  app.add_option("--task", o.task, "task file")->required();
  app.add_option("--poses", o.poses, "poses to write (BOP results csv)");
  app.add_option("--events", o.events, "connections made, wrong and undone, to write");
  app.add_option("--states", o.states, "status and covariance of every part, to write");
  app.add_option("--timings", o.timings, "processor time of every stage, to write");
  app.add_option("--seed", o.seed, "of every random choice")->capture_default_str();
  app.add_option("--fps", o.fps, "frames a second of the recording")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_flag("--paper", o.paper, "the paper's algorithm by its equations");
  app.add_option("--paper-colour", o.paper_colour, "how colour takes part in it: input, observation or fused")
      ->capture_default_str();
  app.add_option("--without", o.without, "cures of the full mode to leave out: " + Names());
  app.add_option("--variants", variants, "folder: every variant of the trackers at once, each with its own results");
  app.add_flag("--initial-poses-from-gt", o.initial_poses_from_gt, "start from the true poses of the first frame");
  app.add_flag("--realtime", o.realtime, "drop frames as a live camera would (not reproducible)");
  CLI11_PARSE(app, argc, argv);
  try {
    if (!variants.empty()) {
      coach::TrackVariants(o, variants);
      return 0;
    }
    const coach::SequenceSummary s = coach::TrackSequence(o);
    std::printf(
        "%d frames, %d dropped, %d events; processor time a frame: detector %.2f ms (p99 %.2f), pose filter %.2f ms "
        "(p99 %.2f)\n",
        s.frames, s.dropped, s.events, 1e3 * s.detector_median, 1e3 * s.detector_p99, 1e3 * s.filter_median,
        1e3 * s.filter_p99);
  } catch (const std::exception& e) {
    std::cerr << "coach-track-sequence: " << e.what() << '\n';
    return 2;
  }
  return 0;
}
