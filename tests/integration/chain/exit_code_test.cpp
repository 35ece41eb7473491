// What a service says, and the code it ends with, when it can't work.
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "process.h"
#include "tiny_scene.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ExitCode : public testing::Test {
 protected:
  ExitCode() : folder_(fs::temp_directory_path() / ("coach_exit_" + std::to_string(getpid()))) {
    WriteTinyScene(folder_, 3);
  }
  ~ExitCode() override { fs::remove_all(folder_); }

  static void Expect(const std::vector<std::string>& arguments, int code, const std::string& message) {
    Process process(arguments);
    EXPECT_EQ(process.Wait(5), code) << process.output();
    EXPECT_THAT(process.output(), HasSubstr(message));
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

TEST_F(ExitCode, FourWithoutAMulticastRouteNamingTheCommand) {
  for (const char* service : {"coach-capture", "coach-detector", "coach-pose-filter"}) {
    Expect({"/usr/bin/unshare", "-n", Program(service), "--station", "S", "--task", Path("task.yaml")}, 4,
           "sudo ip link set lo multicast on && sudo ip route add 239.255.76.67/32 dev lo");
  }
}

TEST_F(ExitCode, TwoForWrongUsageAndConfiguration) {
  Expect({Program("coach-detector"), "--nonsense"}, 2, "--nonsense");
  Expect({Program("coach-detector"), "--station", "a/b"}, 2, "a/b");
  Expect({Program("coach-detector"), "--station", "S"}, 2, "no task");
  Expect({Program("coach-detector"), "--task", "/nowhere.yaml"}, 2, "/nowhere.yaml");
  Expect({Program("coach-capture"), "--source", "usb:1"}, 2, "usb:1");
  std::ofstream(Path("station.yaml")) << "station: S\ncamara: {}\n";
  Expect({Program("coach-capture"), "--config", Path("station.yaml")}, 2, "station.yaml:2");
  std::ofstream(Path("station.yaml")) << "station: S\npose_filter: {partikel: 3}\n";
  Expect({Program("coach-pose-filter"), "--config", Path("station.yaml"), "--task", Path("task.yaml")}, 2, "partikel");
}

TEST_F(ExitCode, ThreeForARecordingThatCanNotBeUsed) {
  Expect({Program("coach-capture"), "--source", "scene:/nowhere"}, 3, "/nowhere/scene_camera.json");
  std::ofstream(Path("scene_camera.json")) << "{";
  Expect({Program("coach-capture"), "--source", "scene:" + folder_.string()}, 3, "not valid JSON");
  Expect({Program("coach-capture"), "--source", "oni:" + Path("task.yaml")}, 3, "task.yaml");
}

TEST_F(ExitCode, NoneForACameraThatIsNotThereYet) {
  Process capture({Program("coach-capture"), "--station", "S", "--source", "openni2:"});
  EXPECT_EQ(capture.Wait(1.5), std::nullopt) << capture.output();
  EXPECT_THAT(capture.output(), HasSubstr("no camera"));
  capture.Signal(SIGINT);
  EXPECT_EQ(capture.Wait(1), 0);
}

}  // namespace
}  // namespace coach
