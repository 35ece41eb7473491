// The `robot:` part of the station file.
#pragma once

#include <string>

#include "common/configuration/yaml_reader.h"
#include "services/robot_bridge/conductor.h"
#include "services/robot_bridge/screen_server.h"

namespace coach {

struct NaoOptions {
  std::string url = "tcp://nao.local:9559";  ///< tcp://host:port or tcps://host:port
  std::string user, token;                   ///< both empty: no login
  double call_timeout_s = 5;                 ///< s, of short calls; motion gets its own length more
  double largest_volume = 0.8;               ///< 0..1
};

struct RobotOptions {
  std::string back_end = "virtual";  ///< virtual, nao or log
  double volume = 0.6;               ///< 0..1 at the start
  ConductorOptions conductor;
  VirtualRobotOptions virtual_robot;
  NaoOptions nao;
};

/// The robot opposite the child, half a metre from the middle of the table, low.
Pose DefaultRobotPose();

/// Reads the options; it may be an empty map (all defaults).
/// @throws ConfigurationError naming file, line, key, what was found and expected.
RobotOptions ReadRobotOptions(const YamlNode& robot);

}  // namespace coach
