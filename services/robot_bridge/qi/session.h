// A client of qi messaging: calls methods of a robot's services and listens to their signals, without ever waiting.
//
// Connects, logs in, finds services by the directory, fetches what each can do, and begins anew, with growing pauses,
// whenever the connection is lost. Nothing of an old connection is used in a new one: ids change.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "services/robot_bridge/qi/meta_object.h"
#include "services/robot_bridge/qi/transport.h"

namespace coach::qi {

struct SessionOptions {
  std::string url = "tcp://nao.local:9559";
  std::string user, token;               ///< both empty: no login
  int64_t connect_timeout_us = 5000000;  ///< us, until the directory answers
  int64_t call_timeout_us = 5000000;     ///< us, of calls that give none
  int64_t first_pause_us = 500000;       ///< us before the first new attempt; doubled each time
  int64_t longest_pause_us = 10000000;   ///< us
};

struct Result {
  bool ok = false;
  Value value;
  std::string error;  ///< of the robot's, or "no answer within ..." or "the connection was lost"
};
using OnResult = std::function<void(const Result&)>;

/// One thread. Callbacks run inside Poll(), or inside the call itself if it can't be made; each is called exactly once.
class Session {
 public:
  /// @throws std::invalid_argument for a URL that is none
  explicit Session(const SessionOptions& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Does what can be done. @param now us, monotonic
  void Poll(int64_t now);

  bool connected() const;
  /// Why it is not connected; empty while the first attempt lasts.
  const std::string& problem() const { return problem_; }
  /// Counts connections: a new number means that everything must be set up again.
  int64_t generation() const { return generation_; }

  /// Calls a method by the overload that fits the arguments. The service is opened when it is first used. At most 256
  /// calls are under way.
  void Call(const std::string& service, const std::string& method, List arguments, OnResult on_result,
            int64_t timeout_us = 0);

  /// Listens to ALMemory's event of this name until the connection is lost.
  /// @param on_value gets the value of every event
  void Listen(const std::string& event, std::function<void(const Value&)> on_value, OnResult on_result);

 private:
  class Connection;
  struct Service;
  struct Target;
  using OnService = std::function<void(const std::shared_ptr<Service>&, const std::string& error)>;

  void Connect();
  void Fail(const std::string& problem);
  void SetUpDirectory();
  void Open(const std::string& name, OnService on_service);
  void Locate(const std::string& name, const Result& result, const Signature& signature);
  void FetchMethods(const std::string& name, const ServiceInfo& info, const std::shared_ptr<Connection>& connection);
  void Opened(const std::string& name, const std::shared_ptr<Service>& service, const std::string& error);
  std::shared_ptr<Connection> ConnectionTo(const std::vector<std::string>& endpoints);
  void CallOn(const Target& target, const std::string& method, const List& arguments, OnResult on_result,
              int64_t timeout_us);
  void ListenTo(const Target& target, const std::string& event, std::function<void(const Value&)> on_value,
                const OnResult& on_result);

  SessionOptions options_;
  Endpoint endpoint_;
  int64_t now_ = 0, next_attempt_ = 0, pause_ = 0, deadline_ = 0;
  std::string problem_;
  int64_t generation_ = 0;
  uint32_t next_link_ = 1;
  std::vector<std::shared_ptr<Connection>> connections_;  // the directory's first
  std::shared_ptr<Service> directory_;                    // set: connected
  std::map<std::string, std::shared_ptr<Service>> services_;
  std::map<std::string, std::vector<OnService>> opening_;
};

}  // namespace coach::qi
