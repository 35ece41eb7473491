#include "common/bus/service_main.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

namespace coach {
namespace {

void LogToStandardError(const std::string& service) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("coach-" + service));
  spdlog::set_pattern("%Y-%m-%d %H:%M:%S.%e %n %^%l%$ %v");
}

int Fail(int code, const std::exception& e) {
  spdlog::critical("{}", e.what());
  return code;
}

}  // namespace

int ServiceMain(int argc, char** argv, const std::string& name, const std::string& description,
                const std::function<void(CLI::App&)>& add_options, const std::function<void(ServiceContext&)>& run) {
  LogToStandardError(name);
  std::string config, station_name, url, output_url, robot_url, task;
  CLI::App app(description, "coach-" + name);
  app.set_version_flag("--version", COACH_VERSION);
  app.add_option("--config", config, "station file");
  app.add_option("--station", station_name,
                 "prefix of every channel (default: the station file's, else the host's name)");
  app.add_option("--lcm-url", url, "LCM network, or a recording to work through: file:///in.lcm?speed=0");
  app.add_option("--output-url", output_url, "where messages go instead: file:///out.lcm?mode=w");
  app.add_option("--robot-url", robot_url, "LCM network of the robot");
  app.add_option("--task", task, "task file");
  if (add_options) add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    ServiceContext context;
    Station& station = context.station;
    station = config.empty() ? DefaultStation() : ReadStation(config);
    if (!station_name.empty()) station.name = station_name;
    if (const std::string expected = StationNameProblem(station.name); !expected.empty())
      throw ConfigurationError("--station: found '" + station.name + "', expected " + expected);
    if (!url.empty()) station.table_url = url;
    if (!robot_url.empty()) station.robot_url = robot_url;
    if (!task.empty()) station.task = std::filesystem::absolute(task);
    context.node.service = name;
    context.node.station = station.name;
    context.node.url = station.table_url;
    context.node.output_url = output_url;
    context.node.configuration = station.text;
    run(context);
    return 0;
  } catch (const ConfigurationError& e) {
    return Fail(2, e);
  } catch (const DeviceError& e) {
    return Fail(3, e);
  } catch (const BusError& e) {
    return Fail(4, e);
  } catch (const std::exception& e) {
    return Fail(1, e);
  }
}

}  // namespace coach
