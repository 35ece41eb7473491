// The HTTP side of the virtual robot: serves the page and its sounds, sends every event to all who are attached
// (server-sent events), takes their reports. See docs/robot-protocol.md. Thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace coach {

struct VirtualRobotOptions {
  std::string host = "127.0.0.1";  ///< address to listen at; any that is not loopback needs a token
  int port = 8765;                 ///< 0: any free one
  std::string token;               ///< empty: none asked for; else pages are opened by /?token=...
  int max_pages = 12;              ///< pages and clients attached at once
};

/// What an attached page or client has told.
struct ScreenReport {
  enum class Kind { kSpeechStarted, kSpeechDone, kHelp };
  Kind kind = Kind::kHelp;
  std::string client;  ///< who, as it calls itself
  int64_t id = 0;      ///< of the speech
};

class ScreenServer {
 public:
  /// @throws std::runtime_error naming the address if it can't listen there.
  explicit ScreenServer(const VirtualRobotOptions& options);
  ~ScreenServer();
  ScreenServer(const ScreenServer&) = delete;
  ScreenServer& operator=(const ScreenServer&) = delete;

  int port() const;
  std::string url() const;

  /// Sends one JSON object to all. The last one of each `topic` is kept and sent first to whoever attaches later; an
  /// empty topic is not kept.
  void Send(const std::string& topic, const std::string& json);
  /// Forgets what is kept of a topic.
  void Drop(const std::string& topic);
  /// Offers a sound at /speech/<id>.wav; the last eight are kept.
  void OfferSpeech(int64_t id, std::string wav);

  /// At most 64 are kept between two calls.
  std::vector<ScreenReport> TakeReports();
  int attached() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coach
