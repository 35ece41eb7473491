// coach-log-diff: are two recordings the same?
#include <CLI/CLI.hpp>
#include <iostream>

#include "tools/log_diff/recording.h"

int main(int argc, char** argv) {
  std::string first, second;
  CLI::App app(
      "Compares the payloads of every channel but SERVICE_HEALTH. Exit code: 0 identical, 1 different, 2 unreadable.",
      "coach-log-diff");
  app.add_option("A", first, "recording")->required();
  app.add_option("B", second, "recording")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    const coach::Recording a = coach::ReadRecording(first), b = coach::ReadRecording(second);
    const std::vector<std::string> differences = coach::Differences(a, b);
    for (const std::string& line : differences) std::cout << line << '\n';
    if (!differences.empty()) return 1;
    size_t messages = 0;
    for (const auto& [channel, payloads] : a) messages += payloads.size();
    std::cout << "identical: " << messages << " messages on " << a.size() << " channels\n";
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "coach-log-diff: " << e.what() << '\n';
    return 2;
  }
}
