#include "tools/operator/seat_calibration.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "services/robot_bridge/kinematics.h"
#include "services/robot_bridge/log_back_end.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr int64_t kTick = 50000;  // us

/// Goes where it is sent, at once; what it does outlives it.
class ObedientRobot : public LogBackEnd {
 public:
  struct Memory {
    JointAngles angles = RestAngles();
    int robots = 0, freezes = 0;
  };
  explicit ObedientRobot(Memory* memory) : LogBackEnd([](const std::string&) {}), memory_(memory) { ++memory_->robots; }
  ~ObedientRobot() override { --memory_->robots; }
  void Move(const JointPath& path) override { memory_->angles = path.points.back().angles; }
  void Freeze() override { ++memory_->freezes; }
  std::optional<JointAngles> MeasuredAngles() const override { return memory_->angles; }

 private:
  Memory* memory_;
};

class SeatCalibrationTest : public testing::Test {
 protected:
  /// Lets time pass, with a tracker that sees the part in the hand.
  void Pass(double seconds) {
    for (const int64_t end = now_ + static_cast<int64_t>(seconds * 1e6); now_ < end; now_ += kTick) {
      PartPoses seen;
      seen.parts.resize(1);
      seen.parts[0].status = PartStatus::kTracked;
      seen.parts[0].confidence = 0.9;
      seen.parts[0].X_TP = X_TR_ * HandPose(Arm::kRight, memory_.angles);
      calibration_.OnPoses(seen);
      calibration_.Step(now_);
    }
  }
  Json Status() const { return Json::parse(calibration_.Status()); }

  const Pose X_TR_ = MakePose(ExpRotation(Vector3(0.02, -0.03, 1.5)), Vector3(0.05, -0.45, 0.1));
  const std::string request_ = R"({"part": 0, "arm": "right", "url": "tcp://nao:9559"})";
  int64_t now_ = 1000000;
  ObedientRobot::Memory memory_;
  std::string url_;
  SeatCalibration calibration_{[this](const NaoOptions& options) {
    url_ = options.url;
    return std::make_unique<ObedientRobot>(&memory_);
  }};
};

TEST_F(SeatCalibrationTest, TellsProgressAndTheSeatAndLetsTheRobotGo) {
  EXPECT_EQ(Status()["state"], "none");
  EXPECT_EQ(Json::parse(calibration_.Start(request_, {}, false))["state"], "connecting");
  EXPECT_EQ(url_, "tcp://nao:9559");
  EXPECT_THROW(calibration_.Start(request_, {}, false), std::invalid_argument);
  Pass(12);
  EXPECT_EQ(Status()["state"], "moving");
  EXPECT_GT(Status()["reports"].size(), 0u);
  Pass(120);
  const Json done = Status();
  ASSERT_EQ(done["state"], "done") << done;
  EXPECT_TRUE(done["good"]);
  EXPECT_NEAR(done["position"][1], -0.45, 2e-4);
  EXPECT_LT(done["residual_mm"], 0.2);
  EXPECT_EQ(memory_.robots, 0);
  calibration_.Start(request_, {}, false);
  EXPECT_EQ(Status()["state"], "connecting") << "once more";
}

TEST_F(SeatCalibrationTest, StopHoldsTheArm) {
  calibration_.Stop();
  calibration_.Start(request_, {}, false);
  Pass(5);
  calibration_.Stop();
  EXPECT_EQ(memory_.freezes, 1);
  EXPECT_EQ(Status()["state"], "failed");
  EXPECT_EQ(Status()["problem"], "stopped");
  Pass(2);
  EXPECT_EQ(memory_.robots, 0);
}

TEST_F(SeatCalibrationTest, NotDuringALessonNorWithoutArmOrPart) {
  EXPECT_THROW(calibration_.Start(request_, {}, true), std::invalid_argument);
  EXPECT_ANY_THROW(calibration_.Start("{}", {}, false));
  EXPECT_ANY_THROW(calibration_.Start("no json", {}, false));
  EXPECT_EQ(Status()["state"], "none");
}

}  // namespace
}  // namespace coach
