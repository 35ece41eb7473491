// The tracker on drawn pictures, with the sensor's noise: readings of 1.9 mm standard deviation at 0.8 m.
//
// What follows from that: 60 witnesses (RefinementOptions) of DepthSigma(0.8) = 3.9 mm give 0.5 mm a direction and, at
// 3 cm from the axis, 1 degree. Tolerances are five of those and half a pixel (0.7 mm) of the outline.
#include "services/pose_filter/full_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/support/drawn_session.h"

namespace coach {
namespace {

constexpr double kPosition = 0.0032, kAngle = 5 * kDegree;

const std::vector<Pose> kThree{OnTable(-0.15, 0.02, 0.3), OnTable(0.13, -0.07, 2.1), OnTable(0.05, 0.14, 1.0)};

void ExpectAt(const PartPoses& out, size_t part, const Task& task, const Pose& truth, const std::string& what) {
  const Pose found = InCamera(out, part);
  EXPECT_EQ(out.parts[part].status, PartStatus::kTracked) << what;
  EXPECT_LT(PositionError(found, truth), kPosition) << what;
  EXPECT_LT(RotationError(task.TypeOf(static_cast<int>(part)).symmetries, found.linear(), truth.linear()), kAngle)
      << what;
}

/// Which of two equal parts the filter calls the first is its choice: truth in the filter's order.
std::vector<Pose> InItsOrder(const PartPoses& out, std::vector<Pose> truth) {
  if (PositionError(InCamera(out, 0), truth[1]) < PositionError(InCamera(out, 0), truth[0]))
    std::swap(truth[0], truth[1]);
  return truth;
}

void ExpectSane(const PartPoses& out, size_t parts) {
  ASSERT_EQ(out.parts.size(), parts);
  EXPECT_TRUE(out.X_TC.matrix().allFinite());
  EXPECT_TRUE(out.X_TC_covariance.allFinite());
  for (const PartEstimate& p : out.parts) {
    EXPECT_TRUE(p.X_TP.matrix().allFinite());
    EXPECT_NEAR(p.X_TP.linear().determinant(), 1, 1e-6);
    EXPECT_TRUE(p.velocity.allFinite());
    EXPECT_TRUE(p.covariance.allFinite());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(p.covariance).eigenvalues()[0], 0);
    EXPECT_TRUE(p.visible_fraction >= 0 && p.visible_fraction <= 1);
    EXPECT_TRUE(p.confidence >= 0 && p.confidence <= 1);
  }
  for (const PairEvidence& p : out.pairs) {
    EXPECT_TRUE(p.X_AB.matrix().allFinite() && p.covariance.allFinite() && std::isfinite(p.log_evidence));
    EXPECT_LT(p.part_a, p.part_b);
  }
  for (const ForeignBlob& f : out.foreign) EXPECT_TRUE(f.centre.allFinite() && f.velocity.allFinite());
}

TEST(FullFilter, FindsTwoEqualPartsAndAnotherFromNothing) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  PartPoses out;
  for (uint64_t k = 0; k < 6; ++k) {
    out = session.Step(DrawScene(task, kThree, k));
    ExpectSane(out, 3);
  }
  const std::vector<Pose> truth = InItsOrder(out, kThree);
  for (size_t p = 0; p < 3; ++p) {
    ExpectAt(out, p, task, truth[p], task.parts[p].name);
    EXPECT_GT(out.parts[p].visible_fraction, 0.6);
    EXPECT_GT(out.parts[p].confidence, 0.7);
    EXPECT_NEAR(out.parts[p].X_TP.translation().z(), 0.015, 0.004) << "it lies on the table";
    EXPECT_LT(out.parts[p].velocity.head<3>().norm(), 0.05);
  }
  EXPECT_TRUE(out.table_found);
  // Median of |N(0, 1.9 mm)| along the ray, seen at 50 degrees, is 1 mm.
  EXPECT_NEAR(out.table_residual, 0.001, 0.0007);
  EXPECT_TRUE(out.foreign.empty());
}

TEST(FullFilter, FollowsAMovingPart) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  std::vector<Pose> truth = kThree;
  PartPoses out;
  for (uint64_t k = 0; k < 5; ++k) out = session.Step(DrawScene(task, truth, k));
  truth = InItsOrder(out, truth);
  const Pose start = truth[0];
  double worst = 0;
  for (int k = 1; k <= 20; ++k) {  // 30 cm/s up and along, 1.5 rad/s
    const double t = k / 30.0;
    Vector6 xi;
    xi << 0.15 * t, -0.15 * t, -0.2 * t, 0.8 * t, 0.9 * t, 0.9 * t;
    truth[0] = Perturb(start, xi);
    out = session.Step(DrawScene(task, truth, 100 + static_cast<uint64_t>(k)));
    // One frame's motion is 1 cm: a filter that lags by half a frame is 5 mm off.
    worst = std::max(worst, PositionError(InCamera(out, 0), truth[0]));
    EXPECT_EQ(out.parts[0].status, PartStatus::kTracked) << k;
  }
  EXPECT_LT(worst, 0.005);
  ExpectAt(out, 0, task, truth[0], "moving");
  ExpectAt(out, 1, task, truth[1], "still");
  ExpectAt(out, 2, task, truth[2], "still");
  const double speed = std::hypot(0.15, 0.15, 0.2);
  EXPECT_NEAR(out.parts[0].velocity.head<3>().norm(), speed, 0.3 * speed);
}

TEST(FullFilter, AHiddenPartAtRestStaysWhereItWas) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  PartPoses out;
  for (uint64_t k = 0; k < 15; ++k) out = session.Step(DrawScene(task, kThree, k));
  const size_t hidden = PositionError(InCamera(out, 0), kThree[0]) < 0.02 ? 0 : 1;
  const Pose before = out.parts[hidden].X_TP;
  double doubt = out.parts[hidden].covariance.trace();
  for (uint64_t k = 0; k < 15; ++k) {
    out = session.Step(DrawScene(task, kThree, 50 + k, 1, 80, 310));
    ExpectSane(out, 3);
    EXPECT_EQ(out.parts[hidden].status, PartStatus::kOccluded) << k;
    EXPECT_LT(PositionError(out.parts[hidden].X_TP, before), 1e-9) << k;
    EXPECT_LT(AngleError(out.parts[hidden].X_TP, before), 1e-7) << k;
    EXPECT_GT(out.parts[hidden].covariance.trace(), doubt) << k;
    EXPECT_LT(out.parts[hidden].visible_fraction, 0.05);
    doubt = out.parts[hidden].covariance.trace();
    EXPECT_EQ(out.parts[1 - hidden].status, PartStatus::kTracked) << k;
  }
  for (uint64_t k = 0; k < 3; ++k) out = session.Step(DrawScene(task, kThree, 90 + k));
  ExpectAt(out, hidden, task, kThree[0], "seen again");
}

TEST(FullFilter, APartAppearsLater) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  PartPoses out;
  const std::vector<Pose> away{kThree[0], kThree[1], OnTable(0, 9, 0)};
  for (uint64_t k = 0; k < 5; ++k) out = session.Step(DrawScene(task, away, k));
  EXPECT_EQ(out.parts[2].status, PartStatus::kAbsent);
  EXPECT_EQ(out.parts[2].visible_fraction, 0);
  int found = 0;
  for (uint64_t k = 0; k < 6; ++k) {
    out = session.Step(DrawScene(task, kThree, 20 + k));
    found += out.parts[2].status == PartStatus::kTracked;
  }
  EXPECT_GE(found, 5) << "0.2 s are enough";
  ExpectAt(out, 2, task, kThree[2], "appeared");
}

TEST(FullFilter, APartThatIsCarriedOffIsFoundElsewhere) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  std::vector<Pose> truth = kThree;
  for (uint64_t k = 0; k < 5; ++k) session.Step(DrawScene(task, truth, k));
  truth[2] = OnTable(-0.05, -0.12, 2.5);
  PartPoses out;
  for (uint64_t k = 0; k < 8; ++k) out = session.Step(DrawScene(task, truth, 20 + k));
  ExpectAt(out, 2, task, truth[2], "moved in one frame");
}

/// Everything that a step says, as bytes.
std::string Bytes(const PartPoses& out) {
  std::string bytes;
  const auto add = [&](const auto& m) {
    bytes.append(reinterpret_cast<const char*>(m.data()), sizeof(double) * static_cast<size_t>(m.size()));
  };
  add(out.X_TC.matrix());
  add(out.X_TC_covariance);
  for (const PartEstimate& p : out.parts) {
    add(p.X_TP.matrix());
    add(p.velocity);
    add(p.covariance);
    bytes += std::to_string(static_cast<int>(p.status)) + std::to_string(p.visible_fraction);
  }
  for (const PairEvidence& p : out.pairs) {
    add(p.X_AB.matrix());
    add(p.covariance);
  }
  for (const ForeignBlob& f : out.foreign) add(f.centre);
  return bytes;
}

TEST(FullFilter, SameSeedSameBytes) {
  const Task task = TwoLsAndABrick();
  DrawnSession a(task, 7), b(task, 7);
  std::string first, again;
  for (int round = 0; round < 2; ++round) {
    std::string& all = round ? again : first;
    for (int k = 0; k < 8; ++k) {
      const std::vector<Pose> truth{OnTable(-0.15 + 0.01 * k, 0.02, 0.3), kThree[1], kThree[2]};
      const TestPicture picture = DrawScene(task, truth, static_cast<uint64_t>(k), 1, 500 - 20 * k, 560 - 20 * k);
      const std::string bytes = Bytes(a.Step(picture));
      if (round == 0) {
        EXPECT_TRUE(bytes == Bytes(b.Step(picture))) << k;
      }
      all += bytes;
    }
    a.filter().Reset();
  }
  EXPECT_TRUE(first == again) << "after a reset the session begins anew";
}

TEST(FullFilter, SuggestedPosesMustWinOnTheImage) {
  const Task task = TwoLsAndABrick();
  FullFilterOptions options;
  options.relocation_gain = 1e12;  // nothing is found but what is suggested
  DrawnSession session(task, 1, options);
  Vector6 xi;
  xi << 0.003, -0.003, 0.002, 0.03, 0.03, -0.03;
  session.filter().Suggest({Perturb(kThree[0], xi), OnTable(0.0, -0.15, 0), Perturb(kThree[2], xi)});
  PartPoses out;
  for (uint64_t k = 0; k < 4; ++k) out = session.Step(DrawScene(task, kThree, k));
  ExpectAt(out, 0, task, kThree[0], "suggested");
  ExpectAt(out, 2, task, kThree[2], "suggested");
  EXPECT_EQ(out.parts[1].status, PartStatus::kAbsent) << "suggested where nothing is";
  session.filter().Suggest({Pose::Identity()});  // of another task: ignored
  ExpectSane(session.Step(DrawScene(task, kThree, 9)), 3);
}

TEST(FullFilter, DepthOnlyAndColourOnlyKeepTracking) {
  const Task task = TwoLsAndABrick();
  for (const bool colour : {false, true}) {
    DrawnSession session(task);
    PartPoses out;
    for (uint64_t k = 0; k < 5; ++k) out = session.Step(DrawScene(task, kThree, k));
    const std::vector<Pose> truth = InItsOrder(out, kThree);
    for (uint64_t k = 0; k < 10; ++k) {
      TestPicture picture = DrawScene(task, kThree, 20 + k);
      (colour ? picture.depth : picture.colour) = cv::Mat();
      out = session.Step(picture);
      ExpectSane(out, 3);
    }
    for (size_t p = 0; p < 3; ++p) {
      EXPECT_EQ(out.parts[p].status, PartStatus::kTracked) << task.parts[p].name << (colour ? " colour" : " depth");
      // Without depth, half a pixel on either side of a silhouette 38 px wide is 2 cm of distance at 0.8 m; across the
      // line of sight it is 0.7 mm. Without colour, a part slides a little in its own faces.
      const Vector3 off = InCamera(out, p).translation() - truth[p].translation();
      const Vector3 ray = truth[p].translation().normalized();
      EXPECT_LT(std::abs(off.dot(ray)), colour ? 0.025 : 0.005) << task.parts[p].name;
      EXPECT_LT((off - off.dot(ray) * ray).norm(), 0.006) << task.parts[p].name << (colour ? " colour" : " depth");
    }
  }
}

TEST(FullFilter, BadInputIsSurvived) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  const TestPicture good = DrawScene(task, kThree, 1);
  const auto step = [&](const TestPicture& picture, double dt = 1.0 / 30) { ExpectSane(session.Step(picture, dt), 3); };
  TestPicture bad = good;
  bad.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(0));  // all zero, from the start
  step(bad);
  bad.depth = cv::Mat();
  step(bad);
  step(good);
  bad = good;
  bad.colour = cv::Mat();
  step(bad);
  bad.depth = cv::Mat();
  step(bad);
  bad = good;
  bad.depth = cv::Mat(240, 320, CV_16UC1, cv::Scalar(800));  // another size
  step(bad);
  bad.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.8));  // another type
  step(bad);
  bad = good;
  bad.camera.fx = bad.camera.fy = 300;  // intrinsics that don't match the image
  step(bad);
  step(good, -5);  // time runs backwards
  step(good, 0);
  step(good, 3600);
  session.filter().Suggest(std::vector<Pose>(3, Pose(Eigen::Matrix4d::Constant(std::nan("")))));
  step(good);
  for (int k = 0; k < 3; ++k) step(good);
  const PartPoses out = session.Step(good);
  const std::vector<Pose> truth = InItsOrder(out, kThree);
  for (size_t p = 0; p < 3; ++p) ExpectAt(out, p, task, truth[p], "after all that");
}

TEST(FullFilter, UnusableCamerasAreSurvived) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  const TestPicture good = DrawScene(task, kThree, 1);
  session.Step(good);
  TestPicture bad = good;
  bad.camera.fx = std::nan("");
  ExpectSane(session.Step(bad), 3);
  bad.camera = {};
  ExpectSane(session.Step(bad), 3);
  ExpectSane(session.filter().Step(FilterInput()), 3);
  for (int k = 0; k < 3; ++k) session.Step(good);
  const PartPoses out = session.Step(good);
  const std::vector<Pose> truth = InItsOrder(out, kThree);
  for (size_t p = 0; p < 3; ++p) ExpectAt(out, p, task, truth[p], "seen well again");
}

TEST(FullFilter, FrameDropsAndIrregularTimes) {
  const Task task = TwoLsAndABrick();
  DrawnSession session(task);
  std::vector<Pose> truth = kThree;
  PartPoses out;
  for (uint64_t k = 0; k < 5; ++k) out = session.Step(DrawScene(task, truth, k));
  truth = InItsOrder(out, truth);
  const Pose start = truth[1];
  double t = 0;
  std::mt19937_64 generator(3);
  for (uint64_t k = 0; k < 15; ++k) {  // 15 cm/s, steps of 10 to 150 ms
    const double dt = 0.01 + 0.14 * static_cast<double>(generator() % 1000) / 1000;
    t += dt;
    Vector6 xi = Vector6::Zero();
    xi << -0.15 * t, 0, 0, 0, 0, 0;
    truth[1] = Perturb(start, xi);
    out = session.Step(DrawScene(task, truth, 30 + k), dt);
    EXPECT_EQ(out.parts[1].status, PartStatus::kTracked) << k;
    EXPECT_LT(PositionError(InCamera(out, 1), truth[1]), 0.006) << k << ", dt " << dt;
  }
}

TEST(FullFilter, AnyMesh) {
  // Inside out, with a hole, of thousands of triangles.
  TriangleMesh turned = LMesh(), open = BoxMesh({0.09, 0.03, 0.03});
  for (auto& t : turned.triangles) std::swap(t[0], t[1]);
  open.triangles.pop_back();
  const Task task = TestTask({TestType("turned", turned, true, 1), TestType("open", open, false, 1),
                              TestType("dense", TorusMesh(0.03, 0.012, 80, 40), false, 1)});
  DrawnSession session(task);
  PartPoses out;
  for (uint64_t k = 0; k < 3; ++k) {
    out = session.Step(DrawScene(task, {OnTable(-0.1, 0, 0.3), OnTable(0.12, -0.1, 1), OnTable(0.1, 0.1, 0)}, k));
    ExpectSane(out, 3);
  }
  EXPECT_EQ(out.parts[2].status, PartStatus::kTracked);
  DrawnSession empty{Task{}};
  EXPECT_TRUE(empty.Step(DrawScene(Task{}, {}, 1)).parts.empty());
}

}  // namespace
}  // namespace coach
