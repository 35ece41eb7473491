// coach-replay: a recording, or a piece of it, onto the bus or into another file.
#include <lcm/lcm.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>

#include "common/configuration/station.h"
#include "tools/log/log_file.h"

namespace coach {
namespace {

std::atomic<bool> ended{false};

struct Options {
  std::string log, url = Station().table_url, output, station;
  double speed = 1, from = 0, until = 0;
};

/// The channel under another station's name.
std::string Renamed(const std::string& channel, const std::string& station) {
  return station.empty() ? channel : station + channel.substr(channel.find('/'));
}

int64_t Replay(const Options& options) {
  LogReader reader(options.log);
  std::optional<LogWriter> writer;
  lcm_t* lcm = nullptr;
  if (!options.output.empty()) {
    writer.emplace(options.output);
  } else if (!(lcm = lcm_create(options.url.c_str()))) {
    throw std::runtime_error(options.url + ": the network can't be used");
  }
  const auto begin = std::chrono::steady_clock::now();
  int64_t origin = -1, count = 0;
  while (const auto event = ended ? std::nullopt : reader.Next()) {
    if (origin < 0) origin = event->utime;
    const double at = static_cast<double>(event->utime - origin) / 1e6;
    if (at < options.from) continue;
    if (options.until > 0 && at > options.until) break;
    const std::string channel = Renamed(event->channel, options.station);
    if (writer) {
      if (!writer->Write(event->utime, channel, event->bytes)) throw std::runtime_error(options.output + ": disk full");
    } else {
      std::this_thread::sleep_until(begin + std::chrono::duration<double>((at - options.from) / options.speed));
      lcm_publish(lcm, channel.c_str(), event->bytes.data(), static_cast<unsigned>(event->bytes.size()));
    }
    ++count;
  }
  if (lcm) lcm_destroy(lcm);
  return count;
}

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  coach::Options options;
  CLI::App app(
      "Plays a recording onto the bus. The network may lose what comes too fast; for a replay that loses nothing cut "
      "the "
      "piece out by --output and give it to a service as --lcm-url 'file:///PIECE?speed=0'.",
      "coach-replay");
  app.add_option("LOG", options.log, "recording")->required();
  app.add_option("--speed", options.speed, "times real time (default 1)")->check(CLI::PositiveNumber);
  app.add_option("--from", options.from, "s from the recording's first message")->check(CLI::NonNegativeNumber);
  app.add_option("--until", options.until, "s from the recording's first message; 0: to the end")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--station", options.station, "publish under this station's name instead of the recorded one");
  app.add_option("--lcm-url", options.url, "network (default: the table bus)");
  app.add_option("--output", options.output, "write the piece to this file instead of publishing it");
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGINT, [](int) { coach::ended = true; });
  std::signal(SIGTERM, [](int) { coach::ended = true; });
  try {
    const int64_t count = coach::Replay(options);
    std::printf("%lld messages\n", static_cast<long long>(count));
    return count > 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coach-replay: %s\n", e.what());
    return 1;
  }
}
