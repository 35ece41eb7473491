#include "tools/operator/robot_seat.h"

#include <nlohmann/json.hpp>

#include "services/robot_bridge/robot_options.h"
#include "tools/operator/json_text.h"

namespace coach {
namespace {
constexpr double kLeastBase = 0.08;  // m; a part's error of 2 mm turns the robot by at most 1.5 degrees
}

RobotSeat SeatFromMarks(const Vector3& p_T_near, const Vector3& p_T_far, double ahead, double height) {
  Vector3 forward = p_T_far - p_T_near;
  forward.z() = 0;
  if (forward.norm() < kLeastBase) return {"close", Pose::Identity()};
  forward.normalize();
  Matrix3 R;
  R << forward, Vector3::UnitZ().cross(forward), Vector3::UnitZ();
  Vector3 p = p_T_near - ahead * forward;
  p.z() = height;
  return {"", MakePose(R, p)};
}

nlohmann::json SeatJson(const Pose& X_TR) {
  const Vector3 p = X_TR.translation(), degrees = SeatDegrees(X_TR);
  return {{"position", {Rounded(p.x(), 1e4), Rounded(p.y(), 1e4), Rounded(p.z(), 1e4)}},
          {"roll_pitch_yaw", {Rounded(degrees.x(), 100), Rounded(degrees.y(), 100), Rounded(degrees.z(), 100)}}};
}

}  // namespace coach
