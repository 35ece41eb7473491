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
#include <cstring>
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

template <class T>
void Append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T ReadAt(const std::string& bytes, size_t at) {
  T value{};
  if (at + sizeof value > bytes.size()) throw std::runtime_error("WAV: truncated");
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace

std::string WavFile(const RenderedSpeech& speech) {
  const auto data_size = static_cast<uint32_t>(speech.samples.size() * 2);
  std::string bytes = "RIFF";
  Append<uint32_t>(bytes, 36 + data_size);
  bytes += "WAVEfmt ";
  Append<uint32_t>(bytes, 16);
  Append<uint16_t>(bytes, 1);  // PCM
  Append<uint16_t>(bytes, 1);  // mono
  Append<uint32_t>(bytes, static_cast<uint32_t>(speech.sample_rate));
  Append<uint32_t>(bytes, static_cast<uint32_t>(speech.sample_rate) * 2);
  Append<uint16_t>(bytes, 2);
  Append<uint16_t>(bytes, 16);
  bytes += "data";
  Append<uint32_t>(bytes, data_size);
  bytes.append(reinterpret_cast<const char*>(speech.samples.data()), data_size);
  return bytes;
}

RenderedSpeech ReadWav(const std::string& bytes) {
  if (bytes.size() < 12 || bytes.compare(0, 4, "RIFF") != 0 || bytes.compare(8, 4, "WAVE") != 0) {
    throw std::runtime_error("WAV: no RIFF/WAVE header");
  }
  RenderedSpeech speech;
  size_t channels = 0;
  for (size_t at = 12; at + 8 <= bytes.size();) {
    const std::string kind = bytes.substr(at, 4);
    const size_t size = ReadAt<uint32_t>(bytes, at + 4);
    at += 8;
    if (kind == "fmt ") {
      channels = ReadAt<uint16_t>(bytes, at + 2);
      speech.sample_rate = static_cast<int>(ReadAt<uint32_t>(bytes, at + 4));
      const bool pcm16 = ReadAt<uint16_t>(bytes, at) == 1 && ReadAt<uint16_t>(bytes, at + 14) == 16;
      if (!pcm16 || channels < 1 || channels > 2 || speech.sample_rate < 8000 || speech.sample_rate > 96000) {
        throw std::runtime_error("WAV: only 16-bit PCM, mono or stereo, 8 to 96 kHz");
      }
    } else if (kind == "data") {
      if (channels == 0) throw std::runtime_error("WAV: data before format");
      const size_t frames = std::min(size, bytes.size() - at) / (2 * channels);
      speech.samples.resize(frames);
      for (size_t i = 0; i < frames; ++i) {
        int sum = 0;
        for (size_t c = 0; c < channels; ++c) sum += ReadAt<int16_t>(bytes, at + 2 * (i * channels + c));
        speech.samples[i] = static_cast<int16_t>(sum / static_cast<int>(channels));
      }
      return speech;
    }
    at += size + size % 2;
  }
  throw std::runtime_error("WAV: no data");
}

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

SpeechRenderer::SpeechRenderer()
    : voices_(InstalledVoices()), thread_([this](const std::stop_token& stop) { Run(stop); }) {}

SpeechRenderer::~SpeechRenderer() = default;

bool SpeechRenderer::Speaks(const std::string& language) const {
  const std::string base = language.substr(0, language.find('-'));
  for (const std::string& voice : voices_) {
    if (voice == language || voice == base || voice.starts_with(base + "-")) return true;
  }
  return false;
}

void SpeechRenderer::Order(int64_t id, const std::string& text, const std::string& language) {
  const std::lock_guard lock(mutex_);
  jobs_.push_back({id, text, language});
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

void SpeechRenderer::Run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (wake_.wait(lock, stop, [this] { return !jobs_.empty(); })) {
    const Job job = jobs_.front();
    jobs_.pop_front();
    lock.unlock();
    RenderedSpeech speech;
    try {
      const std::string voice =
          voices_.contains(job.language) ? job.language : job.language.substr(0, job.language.find('-'));
      speech = ReadWav(RunEspeak({"--stdin", "--stdout", "-b", "1", "-s", "145", "-p", "62", "-v", voice}, job.text));
    } catch (const std::exception& error) {
      speech.error = std::string("espeak-ng could not say it: ") + error.what();
    }
    speech.id = job.id;
    lock.lock();
    finished_.push_back(std::move(speech));
  }
}

}  // namespace coach
