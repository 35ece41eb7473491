#include "common/geometry/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coach {
namespace {

TEST(CameraTest, BackProjectUndoesProject) {
  CameraModel camera{640, 480, 525, 520, 318, 241, {}};
  for (const bool distorted : {false, true}) {
    if (distorted) camera.distortion = {0.1, -0.2, 1e-3, -5e-4, 0.05};
    for (double x = 0; x < 640; x += 71) {
      for (double y = 0; y < 480; y += 53) {
        const Vector3 p = camera.BackProject({x, y}, 0.9);
        EXPECT_NEAR(p.z(), 0.9, 1e-12);
        EXPECT_NEAR((camera.Project(p) - Eigen::Vector2d(x, y)).norm(), 0, 1e-8);
      }
    }
  }
}

TEST(CameraTest, NamesWhatIsWrong) {
  const CameraModel good{640, 480, 525, 525, 320, 240, {}};
  EXPECT_EQ(good.Problem(), "");
  CameraModel bad = good;
  bad.width = 0;
  EXPECT_NE(bad.Problem(), "");
  bad = good;
  bad.fx = -1;
  EXPECT_NE(bad.Problem(), "");
  bad = good;
  bad.cx = 5000;
  EXPECT_NE(bad.Problem(), "");
  bad = good;
  bad.distortion[2] = NAN;
  EXPECT_NE(bad.Problem(), "");
}

}  // namespace
}  // namespace coach
