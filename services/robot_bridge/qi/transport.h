// A stream of qi messages over TCP or TLS that never blocks: everything happens in Poll().
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "services/robot_bridge/qi/message.h"

namespace coach::qi {

struct Endpoint {
  bool tls = false;
  std::string host;
  uint16_t port = 0;
  bool operator==(const Endpoint&) const = default;
};

/// tcp://host:port or tcps://host:port (port 9559 and 9503 if missing); nothing for anything else.
std::optional<Endpoint> ParseEndpoint(const std::string& url);
std::string ToString(const Endpoint& endpoint);

/// One connection, from its beginning to its end. TLS accepts the robot's self-signed certificate, as NAOqi's own
/// clients do.
class Transport {
 public:
  enum class State { kConnecting, kOpen, kClosed };

  /// Begins to connect; the name is looked up in a thread of its own.
  explicit Transport(const Endpoint& endpoint);
  ~Transport();
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  State state() const { return state_; }
  /// Why it is closed.
  const std::string& problem() const { return problem_; }
  const Endpoint& endpoint() const { return endpoint_; }

  void Poll();
  /// Queues a message. More than 8 MB that the other side does not take close the connection.
  void Send(const Message& message);
  /// The next message that has come.
  std::optional<Message> Receive();
  /// Closes, or says better why it is closed.
  void Close(const std::string& problem);

 private:
  struct Lookup;
  struct Tls;

  void StartConnecting();
  void FinishConnecting();
  void StartTls();
  void Shake();
  void Write();
  void Read();
  /// Bytes moved; 0: none now; -1: closed.
  long SomeWritten(const char* bytes, size_t size);
  long SomeRead(char* bytes, size_t size);

  Endpoint endpoint_;
  State state_ = State::kConnecting;
  std::string problem_;
  std::shared_ptr<Lookup> lookup_;
  size_t next_address_ = 0;
  int fd_ = -1;
  bool connected_ = false;
  std::unique_ptr<Tls> tls_;
  std::string outgoing_;
  MessageReader reader_;
};

}  // namespace coach::qi
