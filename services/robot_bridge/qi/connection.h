// One authenticated connection to a process of the robot: calls by message id, events by their address.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "services/robot_bridge/qi/session.h"

namespace coach::qi {

/// Where a method or signal lives.
struct Address {
  uint32_t service = 0, object = 0, action = 0;
  auto operator<=>(const Address&) const = default;
};

class Session::Connection {
 public:
  Connection(const Endpoint& endpoint, const SessionOptions& options, int64_t now);

  /// Moves bytes, hands out results and events. Call at 50 Hz or more.
  void Poll(int64_t now);

  bool ready() const { return stage_ == Stage::kReady && transport_.state() == Transport::State::kOpen; }
  bool closed() const { return transport_.state() == Transport::State::kClosed; }
  const std::string& problem() const { return transport_.problem(); }
  const Endpoint& endpoint() const { return transport_.endpoint(); }

  /// Sends now, or as soon as it is logged in.
  void Call(const Address& address, std::string payload, const Signature& returned, OnResult on_result,
            int64_t timeout_us);
  void OnEvent(const Address& address, const Signature& parameters, std::function<void(const Value&)> on_value);
  /// Ends every call under way.
  void FailAll(const std::string& error);
  /// Forgets every call under way, without a word.
  void Abandon() {
    pending_.clear();
    listeners_.clear();
  }

 private:
  enum class Stage { kConnecting, kAuthenticating, kReady };
  struct Pending {
    Signature returned;
    OnResult on_result;
    int64_t deadline = 0;
    int64_t timeout = 0;
  };
  struct Listener {
    Signature parameters;
    std::function<void(const Value&)> on_value;
  };

  void Authenticate();
  void HandleLogin(const Message& message);
  void HandleLoginState(const Value& answer);
  void BeReady();
  void Handle(const Message& message);
  void HandleEvent(const Message& message);
  void Expire();
  void Doubt();

  const SessionOptions& options_;
  std::string token_;  // the robot may give a new one
  Transport transport_;
  Stage stage_ = Stage::kConnecting;
  int64_t now_ = 0;
  uint32_t next_id_ = 1, login_id_ = 0, last_service_ = 1;
  int login_rounds_ = 0;
  int unanswered_ = 0;  // calls in a row since the last word from the other side
  bool probing_ = false;
  std::map<uint32_t, Pending> pending_;
  std::vector<Message> waiting_;  // for the login to be done
  std::map<Address, Listener> listeners_;
};

/// The value of a reply, an error, or why neither can be read.
Result ResultOf(const Message& message, const Signature& returned);

}  // namespace coach::qi
