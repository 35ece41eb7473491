// The `robot:` part of the station file.
#pragma once

#include <string>

#include "common/configuration/yaml_reader.h"
#include "services/robot_bridge/conductor.h"
#include "services/robot_bridge/nao_robot.h"
#include "services/robot_bridge/screen_server.h"

namespace coach {

struct RobotOptions {
  std::string back_end = "virtual";  ///< virtual, nao or log
  double volume = 0.6;               ///< 0..1 at the start
  std::string recordings;            ///< folder, as given; empty: none. See recordings.h
  ConductorOptions conductor;
  VirtualRobotOptions virtual_robot;
  NaoOptions nao;
};

/// The robot opposite the child, below the camera: half a metre from the middle of the table, low.
Pose DefaultRobotPose();

/// `roll_pitch_yaw` of a seat (degrees) as the station file has it: turned about z, then the new y, then the new x.
Vector3 SeatDegrees(const Pose& X_TR);

/// Reads the options; it may be an empty map (all defaults).
/// @throws ConfigurationError naming file, line, key, what was found and expected.
RobotOptions ReadRobotOptions(const YamlNode& robot);

}  // namespace coach
