// The frame around every service's main(): arguments, station file, logging, exit codes.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "common/bus/node.h"
#include "common/configuration/station.h"

namespace CLI {
class App;
}

namespace coach {

/// A camera, recording or robot that can't be used and never will be without somebody's help. Exit code 3.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a service is started with.
struct ServiceContext {
  Station station;   ///< with the command line's --station, --lcm-url, --robot-url and --task already in it
  NodeOptions node;  ///< filled in; the service may change what it likes before it makes its Node
};

/// Runs a service:
///   coach-NAME [--config station.yaml] [--station NAME] [--lcm-url URL] [--output-url URL] [--robot-url URL] [--task
///   FILE] ...
/// @param add_options adds the service's own options to the parser; may be empty.
/// @returns the exit code: 0 ended because asked to (or the recording is over), 1 failed, 2 wrong usage or
/// configuration (ConfigurationError), 3 device missing (DeviceError), 4 bus unusable (BusError). Each failure is one
/// line on stderr.
int ServiceMain(int argc, char** argv, const std::string& name, const std::string& description,
                const std::function<void(CLI::App&)>& add_options, const std::function<void(ServiceContext&)>& run);

}  // namespace coach
