#include "fake_qi_server.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>

extern char** environ;

namespace coach {

int64_t SteadyNow() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

bool Until(double seconds, const std::function<void()>& step, const std::function<bool()>& condition) {
  for (const int64_t end = SteadyNow() + static_cast<int64_t>(seconds * 1e6); SteadyNow() < end;) {
    step();
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

FakeQiServer::FakeQiServer(const std::vector<std::string>& arguments) {
  int input[2], output[2];
  if (pipe2(input, O_CLOEXEC) != 0 || pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
  std::vector<std::string> words{"python3", COACH_SOURCE_DIR "/tests/unit/services/robot_bridge/fake_qi_server.py"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input[0], 0);
  posix_spawn_file_actions_adddup2(&actions, output[1], 1);
  if (posix_spawnp(&pid_, "python3", &actions, nullptr, argv.data(), environ) != 0) throw std::runtime_error("python3");
  posix_spawn_file_actions_destroy(&actions);
  close(input[0]);
  close(output[1]);
  in_ = input[1];
  out_ = output[0];
  thread_ = std::thread([this] { Listen(); });
  Until(
      10, [] {}, [this] { return !Events().empty(); });
  for (const auto& event : Events()) port_ = event.value("listening", port_);
}

FakeQiServer::~FakeQiServer() {
  Kill();
  close(in_);
  close(out_);
}

void FakeQiServer::Kill() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
  thread_.join();
}

void FakeQiServer::Order(const std::string& line) {
  const std::string bytes = line + "\n";
  if (write(in_, bytes.data(), bytes.size()) < 0) throw std::runtime_error("the fake robot is gone");
}

void FakeQiServer::Listen() {
  std::string text;
  char bytes[65536];
  for (ssize_t got = read(out_, bytes, sizeof bytes); got > 0; got = read(out_, bytes, sizeof bytes)) {
    text.append(bytes, static_cast<size_t>(got));
    for (size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
      const std::lock_guard lock(mutex_);
      events_.push_back(nlohmann::json::parse(text.substr(0, end)));
      text.erase(0, end + 1);
    }
  }
}

std::vector<nlohmann::json> FakeQiServer::Events() const {
  const std::lock_guard lock(mutex_);
  return events_;
}

std::vector<std::string> FakeQiServer::Calls() const {
  std::vector<std::string> calls;
  for (const auto& event : Events()) {
    if (event.contains("call")) calls.push_back(event["call"]);
  }
  return calls;
}

int FakeQiServer::Count(const std::string& call) const {
  int count = 0;
  for (const std::string& made : Calls()) count += made == call;
  return count;
}

nlohmann::json FakeQiServer::LastArguments(const std::string& call) const {
  nlohmann::json arguments;
  for (const auto& event : Events()) {
    if (event.value("call", "") == call) arguments = event["arguments"];
  }
  return arguments;
}

std::vector<std::string> FakeQiServer::Violations() const {
  std::vector<std::string> violations;
  for (const auto& event : Events()) {
    if (event.contains("violation")) violations.push_back(event["violation"]);
  }
  return violations;
}

}  // namespace coach
