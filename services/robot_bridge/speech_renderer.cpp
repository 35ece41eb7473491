#include "services/robot_bridge/speech_renderer.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <sstream>
#include <stdexcept>
#include <utility>

extern char** environ;

namespace coach {
namespace {

constexpr size_t kLargestOutput = 16 << 20;  // bytes; six minutes of speech
constexpr size_t kMostJobs = 16;
constexpr std::chrono::seconds kTimeLimit{8};

/// Runs espeak-ng with the text on its standard input and returns its standard output; empty if it can't be run, takes
/// too long or says too much.
std::string RunEspeak(const std::vector<std::string>& arguments, const std::string& input) {
  int to_child[2], from_child[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, to_child) != 0) return "";
  if (pipe2(from_child, O_CLOEXEC) != 0) {
    close(to_child[0]), close(to_child[1]);
    return "";
  }
  std::vector<char*> argv{const_cast<char*>("espeak-ng")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to_child[1], 0);
  posix_spawn_file_actions_adddup2(&actions, from_child[1], 1);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  pid_t pid = -1;
  const int failed = posix_spawnp(&pid, "espeak-ng", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(to_child[1]), close(from_child[1]);
  std::string output;
  if (failed == 0) {
    // A command's text is far smaller than a socket's buffer: this does not block.
    send(to_child[0], input.data(), input.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    shutdown(to_child[0], SHUT_WR);
    const auto end = std::chrono::steady_clock::now() + kTimeLimit;
    std::array<char, 65536> buffer{};
    bool complete = false;
    while (output.size() < kLargestOutput && std::chrono::steady_clock::now() < end) {
      pollfd waiting{from_child[0], POLLIN, 0};
      if (poll(&waiting, 1, 200) <= 0) continue;
      const ssize_t got = read(from_child[0], buffer.data(), buffer.size());
      complete = got == 0;
      if (got <= 0) break;
      output.append(buffer.data(), static_cast<size_t>(got));
    }
    if (!complete) kill(pid, SIGKILL);
    int status = 0;
    waitpid(pid, &status, 0);
    if (!complete || !WIFEXITED(status) || WEXITSTATUS(status) != 0) output.clear();
  }
  close(to_child[0]), close(from_child[0]);
  return output;
}

}  // namespace

std::set<std::string> InstalledVoices() {
  std::set<std::string> voices;
  std::istringstream lines(RunEspeak({"--voices"}, ""));
  std::string line;
  std::getline(lines, line);  // the heading
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string priority, language;
    if (words >> priority >> language) voices.insert(language);
  }
  return voices;
}

SpeechRenderer::SpeechRenderer(Recordings recordings)
    : recordings_(std::move(recordings)),
      voices_(InstalledVoices()),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

SpeechRenderer::~SpeechRenderer() = default;

bool SpeechRenderer::CanSay(const SpeechOrder& speech) const {
  if (HasRecording(speech)) return true;
  const std::string& language = speech.language;
  const std::string base = language.substr(0, language.find('-'));
  for (const std::string& voice : voices_) {
    if (voice == language || voice == base || voice.starts_with(base + "-")) return true;
  }
  return false;
}

void SpeechRenderer::Order(const SpeechOrder& speech) {
  const std::lock_guard lock(mutex_);
  jobs_.push_back(speech);
  if (jobs_.size() > kMostJobs) {
    finished_.push_back({jobs_.front().id, 22050, {}, "too many sentences wait to be rendered"});
    jobs_.pop_front();
  }
  wake_.notify_one();
}

std::vector<RenderedSpeech> SpeechRenderer::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(finished_, {});
}

RenderedSpeech SpeechRenderer::Render(const SpeechOrder& speech) const {
  RenderedSpeech rendered;
  if (const auto recording = recordings_.Find(speech)) {
    try {
      rendered = ReadWavFile(*recording);
    } catch (const std::exception& error) {
      rendered.error = error.what();
    }
  } else {
    try {
      const std::string voice =
          voices_.contains(speech.language) ? speech.language : speech.language.substr(0, speech.language.find('-'));
      rendered =
          ReadWav(RunEspeak({"--stdin", "--stdout", "-b", "1", "-s", "145", "-p", "62", "-v", voice}, speech.text));
    } catch (const std::exception& error) {
      rendered.error = std::string("espeak-ng could not say it: ") + error.what();
    }
  }
  rendered.id = speech.id;
  return rendered;
}

void SpeechRenderer::Run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (wake_.wait(lock, stop, [this] { return !jobs_.empty(); })) {
    const SpeechOrder speech = jobs_.front();
    jobs_.pop_front();
    lock.unlock();
    RenderedSpeech rendered = Render(speech);
    lock.lock();
    finished_.push_back(std::move(rendered));
  }
}

}  // namespace coach
