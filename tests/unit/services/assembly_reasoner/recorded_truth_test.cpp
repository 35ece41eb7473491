// The reasoner on the true motions of a recorded session, seen through the errors of a good tracker.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "common/assembly/task_file.h"
#include "tools/evaluate_reasoner/event_score.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kScene = fs::path(COACH_SOURCE_DIR) / ".." / "shared" / "scenes" / "assemble_dev";

json Read(const char* name) { return json::parse(std::ifstream(kScene / name)); }

Pose PoseOf(const json& object) {
  const auto R = object.at("cam_R_m2c").get<std::array<double, 9>>();
  const auto t = object.at("cam_t_m2c").get<std::array<double, 3>>();
  Matrix3 rotation;
  rotation << R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8];
  return MakePose(rotation, 0.001 * Vector3(t[0], t[1], t[2]));
}

/// PART_POSES in the camera frame, which does not move in this scene.
std::vector<PartPoses> NoisyPoses(double position, uint64_t seed, double fps) {
  const json truth = Read("scene_gt.json"), info = Read("scene_gt_info.json");
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector6> noise(4, Vector6::Zero());
  std::vector<PartPoses> out;
  const double dt = 1 / fps, keep = std::exp(-dt / 0.15), angle = position * 10;
  for (size_t f = 0; f < truth.size(); ++f) {
    PartPoses poses;
    poses.utime = static_cast<int64_t>(1e6 * (1 + static_cast<double>(f) * dt));
    for (size_t p = 0; p < 4; ++p) {
      for (int i = 0; i < 6; ++i)
        noise[p][i] = keep * noise[p][i] + std::sqrt(1 - keep * keep) * (i < 3 ? position : angle) * normal(random);
      PartEstimate part;
      part.visible_fraction = info.at(std::to_string(f))[p].at("visib_fract");
      part.status = part.visible_fraction >= 0.05 ? PartStatus::kTracked : PartStatus::kOccluded;
      const bool held = part.status == PartStatus::kOccluded && !out.empty();
      part.X_TP = held ? out.back().parts[p].X_TP : Perturb(PoseOf(truth.at(std::to_string(f))[p]), noise[p]);
      part.covariance.setZero();
      part.covariance.diagonal() << Vector3::Constant(position * position), Vector3::Constant(angle * angle);
      poses.parts.push_back(part);
    }
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        const PartEstimate &A = poses.parts[a], &B = poses.parts[b];
        PairEvidence pair;
        pair.part_a = a;
        pair.part_b = b;
        pair.X_AB = A.X_TP.inverse() * B.X_TP;
        if (std::min(A.visible_fraction, B.visible_fraction) < 0.05 || pair.X_AB.translation().norm() > 0.16) continue;
        pair.covariance = 2 * A.covariance;
        pair.covariance.topLeftCorner<3, 3>() *= 2;
        pair.surface_distance = 0.01;
        poses.pairs.push_back(pair);
      }
    }
    out.push_back(poses);
  }
  return out;
}

std::vector<TrueEvent> Truth(double fps, const std::vector<PartPoses>& poses) {
  const json assembly = Read("assembly.json"), events = Read("events.json");
  std::map<std::string, std::vector<std::string>> alike;
  for (const char* key : {"connections", "wrong_connections"}) {
    for (const json& c : assembly.at(key)) alike[c.at("class")].push_back(c.at("name"));
  }
  const std::map<std::string, std::string> types{
      {"connect", "connect"}, {"wrong_connect", "wrong"}, {"disconnect", "disconnect"}};
  std::vector<TrueEvent> out;
  for (const json& e : events.at("events")) {
    const auto type = types.find(e.at("type"));
    if (type == types.end()) continue;
    TrueEvent t;
    t.moment = static_cast<int64_t>(1e6 * (1 + e.at("time").get<double>()));
    t.type = type->second;
    for (const auto& [name, list] : alike) {
      if (std::find(list.begin(), list.end(), e.at("connection")) != list.end()) t.names = list;
    }
    const auto gt = e.at("gt").get<std::array<int, 2>>();
    t.due = t.moment;
    for (size_t f = static_cast<size_t>(e.at("time").get<double>() * fps); f < poses.size(); ++f) {
      const auto& parts = poses[f].parts;
      if (std::min(parts[gt[0]].visible_fraction, parts[gt[1]].visible_fraction) < 0.3) continue;
      t.due = std::max(t.moment, poses[f].utime);
      break;
    }
    out.push_back(t);
  }
  return out;
}

class RecordedTruth : public testing::TestWithParam<double> {};

TEST_P(RecordedTruth, EveryConnectionIsFoundAndNoneInvented) {
  if (!fs::exists(kScene)) GTEST_SKIP() << "no recordings at " << kScene;
  const double fps = Read("events.json").at("fps");
  const Task task = LoadTask(kScene / "task.yaml");
  EventScore sum;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    AssemblyReasoner reasoner(task);
    std::vector<ConnectionEvent> said;
    const auto stream = NoisyPoses(GetParam(), seed, fps);
    for (const PartPoses& poses : stream) {
      const ReasonerOutput out = reasoner.Step(poses);
      ASSERT_TRUE(out.accepted) << out.refused;
      said.insert(said.end(), out.events.begin(), out.events.end());
    }
    sum += Score(Truth(fps, stream), said);
  }
  EXPECT_EQ(sum.truths, 15);
  EXPECT_EQ(sum.found, 15);
  EXPECT_EQ(sum.within_1s, 15);
  EXPECT_EQ(sum.false_alarms, 0);
  EXPECT_EQ(sum.disconnects_found, 3);
}

INSTANTIATE_TEST_SUITE_P(Noise, RecordedTruth, testing::Values(0.0003, 0.001, 0.0015));

}  // namespace
}  // namespace coach
