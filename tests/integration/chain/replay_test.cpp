// A lesson that lcm-logger recorded: lcm-logplayer plays it into live services, and each service works through it twice
// in lockstep with the same result.
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "common/bus/bus.h"
#include "common/bus/process_facts.h"
#include "process.h"
#include "tiny_scene.h"
#include "tools/log_diff/recording.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr char kUrl[] = "udpm://239.255.76.67:7667?ttl=0";

class Replay : public testing::Test {
 protected:
  Replay() : folder_(fs::temp_directory_path() / ("coach_replay_" + std::to_string(getpid()))) {
    WriteTinyScene(folder_, 60);
  }
  ~Replay() override { fs::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  Process Service(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{Program("coach-" + name), "--station", "S"};
    if (name != "capture") arguments.insert(arguments.end(), {"--task", Path("task.yaml")});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Process(arguments);
  }
  static void Sleep(double seconds) { usleep(static_cast<useconds_t>(seconds * 1e6)); }

  fs::path folder_;
};

TEST_F(Replay, TwiceInLockstepIsIdenticalAndLogplayerFeedsLiveServices) {
  {
    const Process detector = Service("detector"), filter = Service("pose-filter");
    Process logger({LCM_LOGGER, "--quiet", std::string("--lcm-url=") + kUrl, Path("lesson.lcm")});
    Sleep(1.5);
    Process capture = Service("capture", {"--source", "scene:" + folder_.string(), "--fps", "30"});
    ASSERT_EQ(capture.Wait(20), 0) << capture.output();
    Sleep(0.5);
    logger.Signal(SIGINT);
    ASSERT_EQ(logger.Wait(5), 0);
  }
  const Recording lesson = ReadRecording(Path("lesson.lcm"));
  ASSERT_GE(lesson.at("S/PART_POSES").size(), 50U);

  struct Alone {
    std::string name, input, output;
    std::vector<std::string> options;
  };
  for (const Alone& alone : {Alone{"detector", "S/COLOR_IMAGE", "S/DETECTIONS", {}},
                             Alone{"pose-filter", "S/DEPTH_IMAGE", "S/PART_POSES", {}},
                             Alone{"assembly-reasoner", "S/PART_POSES", "S/CONNECTION_BELIEF", {"--start"}}}) {
    const std::string& name = alone.name;
    for (const std::string run : {"1", "2"}) {
      std::vector<std::string> options{"--lcm-url", "file://" + Path("lesson.lcm") + "?speed=0", "--output-url",
                                       "file://" + Path(name + run + ".lcm") + "?mode=w"};
      options.insert(options.end(), alone.options.begin(), alone.options.end());
      Process service = Service(name, options);
      ASSERT_EQ(service.Wait(30), 0) << service.output();
    }
    const Recording first = ReadRecording(Path(name + "1.lcm"));
    EXPECT_EQ(first.at(alone.output).size(), lesson.at(alone.input).size()) << name << ": every frame is answered";
    if (name == "assembly-reasoner") {
      EXPECT_TRUE(first.contains("S/ROBOT_COMMAND")) << "the lesson begins with a word";
    }
    Process diff({Program("coach-log-diff"), Path(name + "1.lcm"), Path(name + "2.lcm")});
    EXPECT_EQ(diff.Wait(5), 0) << diff.output();
  }

  Process filter({Program("coach-pose-filter"), "--station", "S", "--task", Path("task.yaml")});
  Bus listener(kUrl, "S");
  int64_t answers = 0;
  listener.Subscribe<part_poses_t>([&](const part_poses_t&) { ++answers; });
  Sleep(1);
  // The recording's own PART_POSES stay out, so that what is heard comes from the service.
  Process player(
      {LCM_LOGPLAYER, "-e", "S/(DEPTH_IMAGE|DETECTIONS)", std::string("--lcm-url=") + kUrl, Path("lesson.lcm")});
  for (const int64_t end = SteadyTime() + 10'000'000; answers < 50 && SteadyTime() < end;) listener.Handle(20);
  EXPECT_GE(answers, 50);
}

TEST_F(Replay, CaptureInLockstepGivesTheSameRecordingTwice) {
  for (const std::string run : {"1", "2"}) {
    Process capture = Service("capture", {"--source", "scene:" + folder_.string(), "--fps", "30", "--lockstep",
                                          "--output-url", "file://" + Path("frames" + run + ".lcm") + "?mode=w"});
    ASSERT_EQ(capture.Wait(20), 0) << capture.output();
  }
  const Recording first = ReadRecording(Path("frames1.lcm"));
  EXPECT_EQ(first.at("S/COLOR_IMAGE").size(), 60U);
  EXPECT_EQ(first.at("S/DEPTH_IMAGE").size(), 60U);
  EXPECT_TRUE(Differences(first, ReadRecording(Path("frames2.lcm"))).empty());
}

}  // namespace
}  // namespace coach
