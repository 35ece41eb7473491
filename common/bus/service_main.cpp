#include "common/bus/service_main.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "common/configuration/task_choice.h"

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

/// The file of the task called `name`, if it is another than the station's present one.
std::optional<std::filesystem::path> OtherTask(const Station& station, const std::string& name) try {
  const std::filesystem::path file = TaskFileNamed(station, name);
  return file == station.task ? std::nullopt : std::optional(file);
} catch (const ConfigurationError& e) {
  spdlog::warn("{}", e.what());
  return std::nullopt;
}

/// Runs the service, and again from the start for every task that the operator chooses.
void RunWithEveryTask(const ServiceContext& context, const std::function<void(ServiceContext&)>& run) {
  for (std::filesystem::path task = context.station.task;;) try {
      ServiceContext fresh = context;
      fresh.station.task = task;
      fresh.node.choose_task = [&station = fresh.station](const std::string& name) { return OtherTask(station, name); };
      return run(fresh);
    } catch (const TaskChosen& chosen) {
      spdlog::info("task {}", chosen.task.string());
      task = chosen.task;
    }
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
    station.task = task.empty() ? RememberedTask(station) : std::filesystem::absolute(task);
    context.node.service = name;
    context.node.station = station.name;
    context.node.url = station.table_url;
    context.node.output_url = output_url;
    context.node.configuration = station.text;
    RunWithEveryTask(context, run);
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
