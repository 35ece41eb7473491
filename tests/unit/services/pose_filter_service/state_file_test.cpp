#include "services/pose_filter/state_file.h"

#include <gtest/gtest.h>

#include <fstream>

namespace coach {
namespace {

namespace fs = std::filesystem;

class StateFile : public testing::Test {
 protected:
  StateFile() : file_(fs::path(testing::TempDir()) / "coach_state_test.json") { fs::remove(file_); }
  ~StateFile() override { fs::remove(file_); }

  static PartPoses Poses() {
    PartPoses poses;
    poses.X_TC = MakePose(ExpRotation(Vector3(3, 0.2, 0.1)), Vector3(0.1, 0.2, 0.9));
    poses.parts.resize(2);
    for (PartEstimate& part : poses.parts) part.status = PartStatus::kTracked;
    poses.parts[0].X_TP.translation() = Vector3(0.1, 0, 0.05);
    poses.parts[1].X_TP.linear() = ExpRotation(Vector3(0, 0, 2));
    return poses;
  }
  fs::path file_;
};

TEST_F(StateFile, PosesComeBackInTheCamera) {
  const PartPoses poses = Poses();
  WriteState(file_, *StateOf(poses, "abc"));
  const auto state = ReadState(file_, "abc", 2);
  ASSERT_TRUE(state);
  for (size_t i = 0; i < 2; ++i) EXPECT_TRUE(state->X_CP[i].isApprox(poses.X_TC.inverse() * poses.parts[i].X_TP, 1e-9));
}

TEST_F(StateFile, AStateOfAnotherTaskIsNone) {
  WriteState(file_, *StateOf(Poses(), "abc"));
  EXPECT_FALSE(ReadState(file_, "abd", 2));
  EXPECT_FALSE(ReadState(file_, "abc", 3));
}

TEST_F(StateFile, AMissingOrBrokenFileIsNone) {
  EXPECT_FALSE(ReadState(file_, "abc", 2));
  for (const char* text : {"", "{", "[]", R"({"task": "abc"})", R"({"task": "abc", "X_CP": [[1], [2]]})",
                           R"({"task": "abc", "X_CP": [[9,0,0,0,1,0,0,0,1,0,0,1],[1,0,0,0,1,0,0,0,1,0,0,1]]})"}) {
    std::ofstream(file_) << text;
    EXPECT_FALSE(ReadState(file_, "abc", 2)) << text;
  }
}

TEST_F(StateFile, APartThatWasNeverSeenLeavesNoState) {
  PartPoses poses = Poses();
  poses.parts[1].status = PartStatus::kAbsent;
  EXPECT_FALSE(StateOf(poses, "abc"));
}

TEST_F(StateFile, AFolderThatIsNotThereIsNamed) {
  try {
    WriteState("/nowhere/state.json", *StateOf(Poses(), "abc"));
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_NE(std::string(e.what()).find("/nowhere/state.json"), std::string::npos);
  }
}

}  // namespace
}  // namespace coach
