#include "common/bus/task_follower.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "common/assembly/task_file.h"
#include "common/bus/messages.h"
#include "tests/support/test_meshes.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class TaskFollowerTest : public testing::Test {
 protected:
  TaskFollowerTest() : folder_(fs::temp_directory_path() / ("coach_follower_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    WritePly(folder_ / "box.ply", BoxMesh({0.1, 0.05, 0.03}), 1000);
    for (const char* name : {"one", "two"}) WriteTask(name, name);
    station_ = DefaultStation();
    station_.task = folder_ / "one.yaml";
    NodeOptions options;
    options.service = "detector";
    options.station = "S";
    options.url = "memq://";
    options.period_ms = 1;
    node_ = std::make_unique<Node>(options);
    follower_ = std::make_unique<TaskFollower>(*node_, station_, LoadTask(station_.task).sha256,
                                               [this](const Task& task) { changes_.push_back(task.name); });
  }
  ~TaskFollowerTest() override { fs::remove_all(folder_); }

  void WriteTask(const std::string& file, const std::string& name) const {
    std::ofstream(folder_ / (file + ".yaml"))
        << "name: " << name
        << "\nunits: mm\nparts:\n  - {type: box, count: 1, mesh: box.ply, mesh_units: mm, bop_id: 1, "
           "colour: blue, hsv: {low: [100, 100, 40], high: [125, 255, 255]}}\n";
  }
  /// The reasoner says so, each three times, as it does every second.
  void Say(const std::vector<Task>& tasks) {
    size_t said = 0;
    node_->Run([&] {
      if (said++ < 3 * tasks.size())
        node_->Publish(ToMessage(tasks[(said - 1) / 3]));
      else
        node_->Stop();
    });
  }

  fs::path folder_;
  Station station_;
  std::unique_ptr<Node> node_;
  std::unique_ptr<TaskFollower> follower_;
  std::vector<std::string> changes_;
};

TEST_F(TaskFollowerTest, ChangesOnceWhenTheLessonDoes) {
  const Task one = LoadTask(folder_ / "one.yaml"), two = LoadTask(folder_ / "two.yaml");
  Say({one, two, one});
  EXPECT_THAT(changes_, ElementsAre("two", "one"));
}

TEST_F(TaskFollowerTest, AFileThatIsNotTheSameIsNotUsed) {
  std::vector<Task> others(3, LoadTask(folder_ / "two.yaml"));
  WriteTask("two", "changed");
  others[1].file = "/etc/passwd";
  others[1].sha256 = "00";
  others[2].file = "../one.yaml";
  others[2].sha256 = "01";
  Say(others);
  EXPECT_THAT(changes_, IsEmpty());
}

}  // namespace
}  // namespace coach
