// The station file: one camera, one table, one robot. See deploy/station.yaml for every key with its meaning.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/configuration/yaml_reader.h"

namespace coach {

/// What every service needs to know, and the sections that belong to one service each.
struct Station {
  std::string name;            ///< prefix of every channel; default: the host's name
  std::filesystem::path file;  ///< empty: defaults only
  std::string text;            ///< the file as it was read
  /// Networks; the table bus never leaves the tracker's host. See common/bus/bus.h for what a URL may be.
  std::string table_url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";
  std::string robot_url = "udpm://239.255.76.67:7668?ttl=0";
  std::filesystem::path key_file;  ///< 16 bytes or more, for the robot bus' commands; empty: no signature
  std::filesystem::path task;      ///< task file; empty: none given
  std::filesystem::path
      state_folder;  ///< where services keep what can't be rebuilt from the bus; empty: they keep nothing
  std::optional<YamlNode> root;

  /// The section of one service, e.g. "camera"; an empty map if the file has none. The service asks for the section's
  /// keys and rejects the unknown ones.
  YamlNode Section(const std::string& name) const;
};

/// Reads a station file. Paths in it are relative to it. An empty file is a station of defaults.
/// @throws ConfigurationError naming file, line, key and what was expected.
Station ReadStation(const std::filesystem::path& file);
Station ParseStation(const std::string& text, const std::filesystem::path& file);

/// A station without a file.
Station DefaultStation();

/// Empty if `name` may be a station's name (1..32 characters of A-Z a-z 0-9 _ - .), else what was expected.
std::string StationNameProblem(const std::string& name);

}  // namespace coach
