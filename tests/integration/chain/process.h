// Programs under test as child processes.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace coach {

/// A running program; killed when it goes out of scope.
class Process {
 public:
  /// @param arguments the program's path first. Its stderr goes to a file, see output().
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();
  Process(Process&& other) noexcept;
  Process& operator=(Process&&) = delete;

  void Signal(int signal) const;
  /// Waits. @returns the exit code, -signal if it was killed, nothing if it still runs after `seconds`.
  std::optional<int> Wait(double seconds);
  bool running();
  /// What it wrote to stderr and stdout so far.
  std::string output() const;

 private:
  pid_t pid_ = -1;
  std::optional<int> code_;
  std::string log_;
};

/// Path of one of the project's programs.
std::string Program(const std::string& name);

}  // namespace coach
