// Starts and steers fake_qi_server.py.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace coach {

class FakeQiServer {
 public:
  /// @param arguments of the script, e.g. {"--token", "secret"}
  explicit FakeQiServer(const std::vector<std::string>& arguments = {});
  ~FakeQiServer();

  int port() const { return port_; }
  std::string url() const { return "tcp://127.0.0.1:" + std::to_string(port_); }
  void Order(const std::string& line);
  void Kill();  ///< as by kill -9

  std::vector<nlohmann::json> Events() const;
  /// Calls so far, in order: "ALMotion.rest".
  std::vector<std::string> Calls() const;
  int Count(const std::string& call) const;
  nlohmann::json LastArguments(const std::string& call) const;
  /// Anything that the client should not have done.
  std::vector<std::string> Violations() const;

 private:
  void Listen();

  int pid_ = -1, in_ = -1, out_ = -1, port_ = 0;
  mutable std::mutex mutex_;
  std::vector<nlohmann::json> events_;
  std::thread thread_;
};

int64_t SteadyNow();  ///< us

/// Calls `step` every 5 ms until the condition holds. @returns whether it did within the time
bool Until(double seconds, const std::function<void()>& step, const std::function<bool()>& condition);

}  // namespace coach
