// Where the robot sits: for the pages, and from two parts on the table: one by its feet and one straight ahead of it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/geometry/pose.h"

namespace coach {

struct RobotSeat {
  std::string problem;           ///< empty: found; else close (the two are too near to each other for a direction)
  Pose X_TR = Pose::Identity();  ///< the robot's torso in the table frame, upright
};

/// @param p_T_near, p_T_far m, table frame: the parts' middles as the tracker sees them
/// @param ahead m, from the torso's origin forward to the nearer part's middle
/// @param height m, of the torso's origin above the table
RobotSeat SeatFromMarks(const Vector3& p_T_near, const Vector3& p_T_far, double ahead, double height);

/// {position (m), roll_pitch_yaw (degrees)} as the station file has them.
nlohmann::json SeatJson(const Pose& X_TR);

}  // namespace coach
