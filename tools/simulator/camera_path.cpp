#include "tools/simulator/camera_path.h"

#include <cmath>

#include "tools/simulator/motion.h"

namespace coach {
namespace {

Pose LookAt(const Vector3& eye, const Vector3& target, double roll) {
  const Vector3 z = (target - eye).normalized();
  const Vector3 x = z.cross(Vector3::UnitZ()).normalized();
  Matrix3 R;
  R << x, z.cross(x), z;
  return MakePose(R * Eigen::AngleAxisd(roll, Vector3::UnitZ()).toRotationMatrix(), eye);
}

double Push(const Jolt& jolt, double time) {
  const double since = time - jolt.time;
  if (since <= 0) return 0;
  return MinimumJerk(since / jolt.duration) - MinimumJerk((since - jolt.duration - 0.2) / 2.0);
}

}  // namespace

Pose CameraPath::At(double time) const {
  const double w = 2 * M_PI / period;
  const double a = azimuth + swing * (0.45 * std::sin(w * time + phase) + 0.18 * std::sin(2.3 * w * time + 2 * phase));
  const double e = elevation + swing * 0.2 * std::sin(0.71 * w * time + 1.7 * phase);
  const double d = distance * (1 + swing * 0.1 * std::sin(0.53 * w * time + 0.6 * phase));
  const Vector3 eye = target + d * Vector3(-std::cos(e) * std::sin(a), -std::cos(e) * std::cos(a), std::sin(e));
  const double shake = swing * 0.05 * std::sin(1.3 * w * time + 3 * phase);
  Pose X_WC = LookAt(eye, target, roll + shake);
  if (tremor > 0) {
    for (int i = 0; i < 3; ++i) {
      const double f = 2 * M_PI * (1.1 + 0.7 * i);
      X_WC.translation()[i] += tremor * (std::sin(f * time + phase * (i + 1)) + 0.4 * std::sin(3.7 * f * time + i));
      X_WC.linear() = X_WC.linear() * ExpRotation(1.2 * tremor * std::sin(0.9 * f * time + 2 * i) * Vector3::Unit(i));
    }
  }
  for (const Jolt& jolt : jolts) {
    const double push = Push(jolt, time);
    X_WC.translation() += push * jolt.shift;
    X_WC.linear() = X_WC.linear() * ExpRotation(push * jolt.turn);
  }
  return X_WC;
}

}  // namespace coach
