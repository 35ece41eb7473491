#include "common/imaging/results_csv.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <sstream>

namespace coach {
namespace {

namespace fs = std::filesystem;

class ResultsCsv : public testing::Test {
 protected:
  ResultsCsv() {
    file_ = fs::temp_directory_path() /
            ("coach_csv_" + std::to_string(getpid()) + testing::UnitTest::GetInstance()->current_test_info()->name());
    task_.types.resize(2);
    task_.types[0].bop_id = 4;
    task_.types[1].bop_id = 2;
    task_.parts = {{"long_1", 0}, {"short_1", 1}};
  }
  ~ResultsCsv() override { fs::remove(file_); }

  std::vector<std::string> Lines() const {
    std::ifstream in(file_);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  /// The camera 1 m above the table's origin, looking down: x_C = x_T, z_C = -z_T.
  static PartPoses TwoParts() {
    PartPoses poses;
    poses.X_TC.linear() = Vector3(1, -1, -1).asDiagonal();
    poses.X_TC.translation() = Vector3(0, 0, 1);
    poses.parts.resize(2);
    poses.parts[0].X_TP.translation() = Vector3(0.1, 0.2, 0.3);
    poses.parts[0].status = PartStatus::kTracked;
    poses.parts[0].confidence = 0.75;
    return poses;
  }

  fs::path file_;
  Task task_;
};

TEST_F(ResultsCsv, PosesAreInTheCameraInMillimetres) {
  PosesCsv(file_, task_, 3).Write(12, TwoParts());
  const auto lines = Lines();
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], "scene_id,im_id,obj_id,score,R,t,time");
  EXPECT_EQ(lines[1].substr(0, 16), "3,12,4,0.750000,");
  EXPECT_NE(lines[1].find(",100.00000 -200.00000 700.00000,-1"), std::string::npos) << lines[1];
  EXPECT_EQ(lines[2].substr(0, 16), "3,12,2,0.000000,");  // never seen
  EXPECT_NE(lines[2].find(",0.00000 0.00000 0.00000,-1"), std::string::npos) << lines[2];
}

TEST_F(ResultsCsv, ALostPartRepeatsItsLastPoseWithScoreZero) {
  PosesCsv csv(file_, task_, 0);
  PartPoses poses = TwoParts();
  csv.Write(0, poses);
  poses.parts[0].status = PartStatus::kLost;
  poses.parts[0].X_TP.translation().setZero();
  csv.Write(1, poses);
  const auto lines = Lines();
  EXPECT_EQ(lines[3].substr(0, 15), "0,1,4,0.000000,");
  EXPECT_EQ(lines[3].substr(15), lines[1].substr(15));
}

TEST_F(ResultsCsv, StatesTurnTheCovarianceIntoTheCamera) {
  PartPoses poses = TwoParts();
  poses.parts[0].covariance.setZero();
  poses.parts[0].covariance(0, 1) = poses.parts[0].covariance(1, 0) = 2;  // of x and y in the table: y_C = -y_T
  poses.parts[0].covariance(5, 5) = 3;
  poses.parts[0].ambiguous_with = 1;
  poses.parts[0].ambiguous_probability = 0.25;
  StatesCsv(file_, task_).Write(7, poses);
  const auto lines = Lines();
  std::vector<std::string> fields;
  std::stringstream in(lines.at(1));
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  ASSERT_EQ(fields.size(), 7U + 21U);
  EXPECT_EQ(std::vector<std::string>(fields.begin(), fields.begin() + 7),
            (std::vector<std::string>{"7", "long_1", "tracked", "0.000000", "0.750000", "short_1", "0.250000"}));
  EXPECT_EQ(std::stod(fields[7 + 1]), -2);
  EXPECT_EQ(std::stod(fields[7 + 20]), 3);
}

TEST_F(ResultsCsv, EventsCountSecondsFromTheFirstFrame) {
  EventsCsv csv(file_, task_, 1'000'000);
  GuidanceEvent event;
  event.kind = "connect";
  event.subject = "c1";
  event.since = 3'000'000;
  event.utime = 3'500'000;
  event.part_a = 0;
  event.part_b = 1;
  event.probability = 0.9;
  csv.Write(event);
  event.kind = "say";
  csv.Write(event);
  event = GuidanceEvent();
  event.kind = "disconnect";
  event.subject = "c1";
  event.since = 4'000'000;
  event.utime = 5'000'000;
  csv.Write(event);
  EXPECT_EQ(Lines(), (std::vector<std::string>{"time,connection,type,part_a,part_b,probability,decided",
                                               "2.000000,c1,connect,long_1,short_1,0.900000,2.500000",
                                               "3.000000,c1,disconnect,,,0.000000,4.000000"}));
}

TEST_F(ResultsCsv, AFileThatCannotBeWrittenIsNamed) {
  try {
    TimingsCsv csv("/nowhere/t.csv");
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(std::string(e.what()), "/nowhere/t.csv: cannot be written");
  }
}

TEST_F(ResultsCsv, PosesOfAnotherTaskAreRefused) {
  PosesCsv csv(file_, task_, 0);
  EXPECT_THROW(csv.Write(0, PartPoses()), std::invalid_argument);
}

}  // namespace
}  // namespace coach
