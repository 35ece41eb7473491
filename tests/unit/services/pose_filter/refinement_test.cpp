#include "services/pose_filter/refinement.h"

#include <gtest/gtest.h>

#include "services/pose_filter/depth_renderer.h"
#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

Task OneL() { return TestTask({TestType("l", LMesh(), true, 1)}); }

RefinementResult RefineDrawn(const PartModel& model, const DrawnObservation& drawn, const Pose& start,
                             const RefinementOptions& options = {}) {
  const OwnerMap owners = NoOwners(drawn.picture.camera);
  RefinementScratch scratch;
  return Refine(model, drawn.View(), owners, 0, 1, start, options, scratch);
}

Pose Moved(const Pose& X, std::mt19937_64& generator, double position, double rotation) {
  Vector6 xi;
  xi << RandomVector(generator, position), RandomVector(generator, rotation);
  return Perturb(X, xi);
}

TEST(Refinement, ConvergesFromFiveMillimetresAndFourDegrees) {
  const Task task = OneL();
  const PartModel model = MakePartModel(task.types[0]);
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 12; ++k) {
    const Pose truth = OnTable(0.15 * uniform(generator), 0.1 * uniform(generator), 3 * uniform(generator));
    const DrawnObservation drawn(task, DrawScene(task, {truth}, 1, 0));
    const Pose start = Moved(truth, generator, 0.005, 4 * kDegree);
    // Depth is written in whole millimetres: up to 0.5 mm over an arm of 3 cm, 1 degree of roll, and half a pixel of
    // the outline (0.7 mm) as much again. A track refines its pose every frame: three calls are three frames of a part
    // that stands still.
    Pose X_CP = start;
    RefinementResult r;
    for (int frame = 0; frame < 3; ++frame) {
      r = RefineDrawn(model, drawn, X_CP);
      X_CP = r.X_CP;
    }
    EXPECT_LT(PositionError(r.X_CP, truth), 0.0007) << k;
    EXPECT_LT(AngleError(r.X_CP, truth), 2 * kDegree) << k;
    EXPECT_GT(r.last.depth_used, 30);
    EXPECT_GT(r.last.contour_used, 0.8 * r.last.contour_judged);
  }
}

TEST(Refinement, ThePriorHoldsWhatTheImageDoesNot) {
  const Task task = OneL();
  const PartModel model = MakePartModel(task.types[0]);
  const Pose truth = OnTable(0.03, -0.02, 0.6);
  // Nothing but table: whatever pulls is noise, and a pose that is believed to a millimetre doesn't move by three.
  const DrawnObservation empty(task, DrawScene(task, {OnTable(0, 9, 0)}, 1));
  RefinementOptions sure;
  sure.prior_position = 0.001;
  sure.prior_rotation = 0.01;
  EXPECT_LT(PositionError(RefineDrawn(model, empty, truth, sure).X_CP, truth), 0.003);
  // Where the image speaks, each prior is one observation beside many: the pose lies between start and truth, the
  // nearer to the start the surer that is.
  const DrawnObservation drawn(task, DrawScene(task, {truth}, 1, 0));
  Vector6 xi = Vector6::Zero();
  xi[0] = 0.004;
  const Pose start = Perturb(truth, xi);
  double nearer = 1;
  for (const double sigma : {0.1, 0.001, 0.0002, 0.00002}) {
    RefinementOptions options;
    options.iterations = 8;
    options.prior_position = sigma;
    options.prior_rotation = 6 * sigma;
    const double away = PositionError(RefineDrawn(model, drawn, start, options).X_CP, start);
    EXPECT_LT(away, nearer) << sigma;
    nearer = away;
  }
  EXPECT_LT(nearer, 0.0002);
}

// If one of the six columns of the Jacobian were wrong, one step from a pose moved along that axis would not come back.
// Errors are measured by the information: where the image hardly holds the part, roll about its length, little matters.
TEST(Refinement, OneStepTakesBackASmallMotionAlongEveryAxis) {
  const Task task = OneL();
  const PartModel model = MakePartModel(task.types[0]);
  const Pose truth = OnTable(0.03, -0.02, 0.6);
  const DrawnObservation drawn(task, DrawScene(task, {truth}, 1, 0));
  RefinementOptions many;
  many.iterations = 12;
  const RefinementResult fixed = RefineDrawn(model, drawn, truth, many);
  RefinementOptions one;
  one.iterations = 1;
  const auto size = [&](const Vector6& e) { return std::sqrt(e.dot(fixed.last.information * e)); };
  for (int axis = 0; axis < 6; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vector6 xi = Vector6::Zero();
      xi[axis] = sign * (axis < 3 ? 0.0025 : 2.5 * kDegree);
      const Vector6 left = Difference(fixed.X_CP, RefineDrawn(model, drawn, Perturb(fixed.X_CP, xi), one).X_CP);
      // A column of the wrong sign doubles the error, a missing one leaves all of it; the pixels' grid leaves 1.5
      // sigmas.
      EXPECT_LT(size(left), 1.5 + 0.35 * size(xi)) << "axis " << axis << " sign " << sign;
    }
  }
}

// A plate that faces the camera: its normal equations can be written down.
TEST(Refinement, InformationIsThatOfAPlateFacingTheCamera) {
  const double width = 0.10, height = 0.06, z = 0.5;
  const Task task = TestTask({TestType("plate", BoxMesh({width, height, 0.02}), true, 1)});
  const PartModel model = MakePartModel(task.types[0]);
  Pose truth = Pose::Identity();
  truth.translation() << 0, 0, z + 0.01;
  Pose away = TestTable();
  away.translation().z() = 1.6;
  const DrawnObservation drawn(task, DrawScene(task, {truth}, 1, 0, 0, 0, 0.4, away), away);
  RefinementOptions options;
  DrawnObservation depth_only = drawn;
  depth_only.class_map.clear();
  const RefinementResult d = RefineDrawn(model, depth_only, truth, options);
  // Witnesses of variance sigma^2 + (1 mm)^2 on the plane z = 0.5: H_zz = N / variance, H about x = N mean(y^2) /
  // variance with mean(y^2) = height^2 / 12 for points spread evenly. The outermost 2 px (2 x 1.75 mm) are not used.
  const double sigma = DepthSigma(z), zz = options.depth_witnesses / (sigma * sigma + 1e-6);
  EXPECT_NEAR(d.last.information(2, 2), zz, 0.03 * zz);
  const double inner = height - 0.0035, about_x = zz * inner * inner / 12;
  EXPECT_NEAR(d.last.information(3, 3), about_x, 0.15 * about_x);
  // Nothing in depth holds a plate that slides in its own plane or turns in it.
  for (const int axis : {0, 1, 5}) {
    EXPECT_LT(d.last.information(axis, axis), 1e-6 * zz) << axis;
  }

  DrawnObservation colour_only = drawn;
  colour_only.picture.depth.release();
  colour_only.picture.colour.release();  // the class map alone, whose bias is estimated
  const RefinementResult c = RefineDrawn(model, colour_only, truth, options);
  // The two short sides hold x with (f / z)^2 / variance a witness, the variance 0.6 px^2 and that of the posterior
  // over the step's place. With each sample a factor exp(-2 gain) per px: sum over d of d^2 exp(-2.4 |d|) is 0.2 px^2,
  // for a step between two samples.
  const double share = height / (width + height), per_witness = 570 * 570 / (z * z) / 0.85;
  const double xx = options.contour_witnesses * share * per_witness;
  EXPECT_NEAR(c.last.information(0, 0), xx, 0.25 * xx);
  EXPECT_GT(c.last.information(0, 0), 100 * c.last.information(2, 2)) << "an outline says little of distance";
}

TEST(Refinement, AFingerOverAThirdDoesNotMoveThePart) {
  const Task task = OneL();
  const PartModel model = MakePartModel(task.types[0]);
  const Pose truth = OnTable(0, 0, 0);
  double left = 1e9, right = 0;
  for (const Vector3& v : model.mesh.vertices) {
    const double u = TestCamera().Project(truth * v).x();
    left = std::min(left, u);
    right = std::max(right, u);
  }
  const double third = (right - left) / 3;
  for (const double nearer : {0.015, 0.03, 0.1}) {
    for (int place = 0; place < 3; ++place) {
      const int from = static_cast<int>(left + place * third), to = static_cast<int>(from + third);
      const double depth = truth.translation().z() - 0.04 - nearer;  // the part reaches 4 cm nearer than its origin
      const DrawnObservation drawn(task, DrawScene(task, {truth}, 1, 0, from, to, depth));
      // Drawn edges are hard: a place of the edge corrected for mixed pixels is a quarter of a pixel (0.35 mm) off,
      // which over half of an arm of 3 cm is 1.4 degrees more.
      for (const bool colour : {false, true}) {
        DrawnObservation seen = drawn;
        if (!colour) seen.picture.colour.release();
        const RefinementResult r = RefineDrawn(model, seen, truth);
        EXPECT_LT(PositionError(r.X_CP, truth), 0.0015) << nearer << " m nearer, third " << place;
        EXPECT_LT(AngleError(r.X_CP, truth), (colour ? 3.2 : 1.5) * kDegree) << nearer << " m nearer, third " << place;
      }
    }
  }
}

TEST(Refinement, NothingToSeeLeavesThePoseAlone) {
  const Task task = OneL();
  const PartModel model = MakePartModel(task.types[0]);
  const Pose truth = OnTable(0, 0, 0.4);
  DrawnObservation drawn(task, DrawScene(task, {truth}, 1));
  drawn.picture.depth.setTo(0);
  drawn.class_map.clear();
  const RefinementResult r = RefineDrawn(model, drawn, truth);
  EXPECT_EQ(r.last.depth_used, 0);
  EXPECT_LT(PositionError(r.X_CP, truth), 1e-12);
  EXPECT_LT(r.last.information.norm(), 1e-9);
  Pose behind = truth;
  behind.translation().z() = -0.5;
  EXPECT_TRUE(RefineDrawn(model, drawn, behind).X_CP.matrix() == behind.matrix());
}

TEST(FindOutline, LiesOnTheEdgeOfTheSilhouette) {
  for (const bool concave : {false, true}) {
    const Task task = TestTask({TestType("part", concave ? LMesh() : BoxMesh({0.12, 0.03, 0.05}), true, 1)});
    const PartModel model = MakePartModel(task.types[0]);
    const RenderMesh mesh(task.types[0].mesh);
    const PixelGrid grid = SampledGrid(TestCamera(), 1);
    std::mt19937_64 generator(concave);
    for (int k = 0; k < 20; ++k) {
      const Pose X_CP = MakePose(RandomRotation(generator), Vector3(0, 0, 0.7) + RandomVector(generator, 0.1));
      DepthTile tile;
      RenderTile(model, TestCamera(), X_CP, OwnerMap::kStep, 6, tile);
      std::vector<RefinementScratch::OutlinePoint> outline;
      FindOutline(model, TestCamera(), X_CP, tile, 80, outline);
      EXPECT_GE(outline.size(), 30u);
      EXPECT_LE(outline.size(), 110u);
      RenderedDepth drawn;  // by the other rasteriser, every pixel
      RenderDepth(mesh, grid, X_CP, drawn);
      const auto covered = [&](const Eigen::Vector2d& p) {
        const int x = static_cast<int>(std::lround(p.x())) - drawn.area.x,
                  y = static_cast<int>(std::lround(p.y())) - drawn.area.y;
        return x >= 0 && y >= 0 && x < drawn.area.width && y < drawn.area.height &&
               drawn.row(y)[x] < RenderedDepth::kEmpty;
      };
      int off = 0, over = 0;
      for (const auto& o : outline) {
        const Eigen::Vector2d at = TestCamera().Project(X_CP * o.p_P);
        EXPECT_NEAR(o.normal.norm(), 1, 1e-9);
        // Rounding to a pixel is 0.71 px off at most; near a corner the normal of one edge may lead to the other.
        over += covered(at + 1.5 * o.normal);
        off += !covered(at - 1.5 * o.normal);
      }
      EXPECT_LE(over, static_cast<int>(outline.size()) / 10) << k;
      EXPECT_LE(off, static_cast<int>(outline.size()) / 10) << k;
    }
  }
}

}  // namespace
}  // namespace coach
