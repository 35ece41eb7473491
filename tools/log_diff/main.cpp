// coach-log-diff: are two recordings the same?
#include <iostream>

#include "tools/log_diff/recording.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: coach-log-diff A.lcm B.lcm\n"
                 "Compares the payloads of every channel but SERVICE_HEALTH. Exit code: 0 identical, 1 different, 2 "
                 "unreadable.\n";
    return 2;
  }
  try {
    const coach::Recording a = coach::ReadRecording(argv[1]), b = coach::ReadRecording(argv[2]);
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
