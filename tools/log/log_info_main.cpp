// coach-log-info: what a recording holds, and whether it is sound.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "tools/log/log_summary.h"

int main(int argc, char** argv) {
  using namespace coach;
  std::string file;
  std::vector<std::string> required;
  CLI::App app(
      "What a recording holds, channel by channel. Exit code 1 if it is empty, damaged or lacks a required channel.",
      "coach-log-info");
  app.add_option("LOG", file, "recording")->required();
  app.add_option("--require", required, "channel (without the station) that must not be empty; may be repeated");
  CLI11_PARSE(app, argc, argv);
  try {
    LogReader reader(file);
    const LogSummary summary = Summarise(reader);
    std::printf("%s: %lld messages, %.1f s, %.1f MB\n", file.c_str(), static_cast<long long>(summary.events),
                summary.seconds, static_cast<double>(summary.bytes) / 1e6);
    std::printf("%-36s %8s %8s %10s %8s %11s %16s\n", "channel", "messages", "Hz", "MB", "missing", "undecodable",
                "age p50/p99 ms");
    for (const auto& [name, channel] : summary.channels) {
      std::printf("%-36s %8lld %8.1f %10.2f %8lld %11s %8.1f/%7.1f\n", name.c_str(),
                  static_cast<long long>(channel.events), channel.rate(), static_cast<double>(channel.bytes) / 1e6,
                  static_cast<long long>(channel.missing),
                  channel.known ? std::to_string(channel.undecodable).c_str() : "not ours", channel.AgePercentile(50),
                  channel.AgePercentile(99));
    }
    for (const auto& [name, health] : summary.health) {
      std::printf("%s: received %lld, answered %lld, dropped %lld; socket drops %lld, bad messages %lld; %.0f MB%s%s\n",
                  name.c_str(), static_cast<long long>(health.received), static_cast<long long>(health.answered),
                  static_cast<long long>(health.dropped), static_cast<long long>(health.socket_drops),
                  static_cast<long long>(health.decode_errors), static_cast<double>(health.resident_bytes) / 1e6,
                  health.message.empty() ? "" : "; ", health.message.c_str());
    }
    const auto problems = ProblemsOf(summary, required);
    for (const auto& problem : problems)
      std::fprintf(stderr, "coach-log-info: %s: %s\n", file.c_str(), problem.c_str());
    return problems.empty() ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "coach-log-info: %s\n", e.what());
    return 1;
  }
}
