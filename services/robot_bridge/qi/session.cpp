#include "services/robot_bridge/qi/session.h"

#include <algorithm>
#include <stdexcept>

#include "services/robot_bridge/qi/codec.h"
#include "services/robot_bridge/qi/connection.h"

namespace coach::qi {
namespace {

constexpr uint32_t kDirectoryService = 1, kMainObject = 1;
constexpr uint32_t kRegisterEventAction = 0, kMetaObjectAction = 2;

const Signature& MetaObjectType() {
  static const Signature kType = ParseSignature(kMetaObjectSignature);
  return kType;
}

/// Payload of metaObject(I) and the like.
std::string Numbers(const std::string& signature, const List& numbers) {
  return Encode(ParseSignature(signature), Tuple{numbers});
}

}  // namespace

struct Session::Service {
  std::shared_ptr<Connection> connection;
  uint32_t id = 0;
  MetaObject meta;
};

/// An object of a service, with what it can do.
struct Session::Target {
  std::shared_ptr<Connection> connection;
  uint32_t service = 0, object = kMainObject;
  MetaObject meta;
};

Session::Session(const SessionOptions& options) : options_(options), pause_(options.first_pause_us) {
  const auto endpoint = ParseEndpoint(options.url);
  if (!endpoint) throw std::invalid_argument("'" + options.url + "' is not tcp://host:port or tcps://host:port");
  endpoint_ = *endpoint;
}

Session::~Session() {
  for (const auto& connection : connections_) connection->Abandon();
}

bool Session::connected() const { return directory_ != nullptr; }

void Session::Connect() {
  connections_.push_back(std::make_shared<Connection>(endpoint_, options_, now_));
  deadline_ = now_ + options_.connect_timeout_us;
  SetUpDirectory();
}

void Session::Fail(const std::string& problem) {
  problem_ = problem;
  const auto connections = std::exchange(connections_, {});
  directory_.reset();
  services_.clear();
  const auto opening = std::exchange(opening_, {});
  for (const auto& connection : connections) connection->FailAll("the connection was lost");
  for (const auto& [name, waiting] : opening) {
    for (const OnService& on_service : waiting) on_service(nullptr, "the connection was lost");
  }
  next_attempt_ = now_ + pause_;
  pause_ = std::min(2 * pause_, options_.longest_pause_us);
}

void Session::SetUpDirectory() {
  const auto connection = connections_.front();
  connection->Call(
      {kDirectoryService, kMainObject, kMetaObjectAction}, Numbers("(I)", {0}), MetaObjectType(),
      [this, connection](const Result& result) {
        if (!result.ok || connections_.empty()) return;  // the deadline or the loss tells
        try {
          directory_ = std::make_shared<Service>(Service{connection, kDirectoryService, MetaObjectOf(result.value)});
          ++generation_;
          problem_.clear();
          pause_ = options_.first_pause_us;
        } catch (const FormatError&) {
          // as above
        }
      },
      options_.connect_timeout_us);
}

void Session::Poll(int64_t now) {
  now_ = now;
  if (connections_.empty()) {
    if (now < next_attempt_) return;
    Connect();
  }
  const auto connections = connections_;
  for (const auto& connection : connections) connection->Poll(now);
  if (connections_.empty()) return;
  if (connections_.front()->closed()) {
    Fail(std::string(connections_.front()->problem()));
    return;
  }
  if (!connected() && now > deadline_) {
    Fail("no answer from " + ToString(endpoint_));
    return;
  }
  for (const auto& connection : connections) {
    if (!connection->closed() || connections_.empty()) continue;
    const std::string problem = connection->problem();
    const bool used = std::any_of(services_.begin(), services_.end(),
                                  [&](const auto& entry) { return entry.second->connection == connection; });
    if (used) {  // a service's process has died: start anew, its ids are gone
      Fail(problem);
      return;
    }
    // A service that could never be reached: the others go on without it.
    std::erase(connections_, connection);
    connection->FailAll(problem);
  }
}

std::shared_ptr<Session::Connection> Session::ConnectionTo(const std::vector<std::string>& endpoints) {
  std::vector<Endpoint> usable;
  for (const std::string& url : endpoints) {
    if (const auto endpoint = ParseEndpoint(url)) usable.push_back(*endpoint);
  }
  const auto have = [&](const Endpoint& endpoint) {
    return std::find_if(connections_.begin(), connections_.end(),
                        [&](const auto& connection) { return connection->endpoint() == endpoint; });
  };
  // The directory's own process: whatever name it gives its host, the port tells.
  for (const Endpoint& endpoint : usable) {
    if (endpoint.port == endpoint_.port && endpoint.tls == endpoint_.tls) return connections_.front();
  }
  std::stable_sort(usable.begin(), usable.end(), [&](const Endpoint& a, const Endpoint& b) {
    const auto rank = [&](const Endpoint& e) {
      return (e.host == endpoint_.host ? 0 : 1) + (e.tls == endpoint_.tls ? 0 : 2);
    };
    return rank(a) < rank(b);
  });
  if (usable.empty()) return connections_.front();
  // 127.0.0.1 as the robot sees it is the host that was dialled, as we see it.
  Endpoint chosen = usable.front();
  if (chosen.host == "127.0.0.1" || chosen.host == "localhost") chosen.host = endpoint_.host;
  if (const auto found = have(chosen); found != connections_.end()) return *found;
  connections_.push_back(std::make_shared<Connection>(chosen, options_, now_));
  return connections_.back();
}

void Session::Open(const std::string& name, OnService on_service) {
  if (!connected()) {
    on_service(nullptr, problem_.empty() ? "not connected" : problem_);
    return;
  }
  if (const auto found = services_.find(name); found != services_.end()) {
    on_service(found->second, "");
    return;
  }
  const bool first = !opening_.contains(name);
  opening_[name].push_back(std::move(on_service));
  if (!first) return;
  const List arguments{name};
  const MetaMethod* method = directory_->meta.Resolve("service", arguments);
  if (method == nullptr) {
    Opened(name, nullptr, "the directory has no method 'service'");
    return;
  }
  const Signature returned = method->returned;
  directory_->connection->Call(
      {kDirectoryService, kMainObject, method->id}, Encode(method->parameters, Tuple{arguments}), returned,
      [this, name, returned](const Result& result) { Locate(name, result, returned); }, options_.call_timeout_us);
}

void Session::Locate(const std::string& name, const Result& result, const Signature& signature) {
  if (!result.ok || !connected()) {
    Opened(name, nullptr, "no service '" + name + "': " + result.error);
    return;
  }
  try {
    const ServiceInfo info = ServiceInfoOf(signature, result.value);
    FetchMethods(name, info, ConnectionTo(info.endpoints));
  } catch (const FormatError& error) {
    Opened(name, nullptr, "service '" + name + "': " + error.what());
  }
}

void Session::FetchMethods(const std::string& name, const ServiceInfo& info,
                           const std::shared_ptr<Connection>& connection) {
  connection->Call(
      {info.id, kMainObject, kMetaObjectAction}, Numbers("(I)", {0}), MetaObjectType(),
      [this, name, info, connection](const Result& result) {
        if (!result.ok || !connected()) {
          Opened(name, nullptr, "service '" + name + "': " + result.error);
          return;
        }
        try {
          Opened(name, std::make_shared<Service>(Service{connection, info.id, MetaObjectOf(result.value)}), "");
        } catch (const FormatError& error) {
          Opened(name, nullptr, "service '" + name + "': " + error.what());
        }
      },
      options_.call_timeout_us);
}

void Session::Opened(const std::string& name, const std::shared_ptr<Service>& service, const std::string& error) {
  if (service) services_[name] = service;
  const auto node = opening_.extract(name);
  if (node.empty()) return;
  for (const OnService& on_service : node.mapped()) on_service(service, error);
}

void Session::CallOn(const Target& target, const std::string& method, const List& arguments, OnResult on_result,
                     int64_t timeout_us) {
  const MetaMethod* found = target.meta.Resolve(method, arguments);
  if (found == nullptr) {
    on_result({false, {}, "no method '" + method + "' takes these arguments"});
    return;
  }
  std::string payload;
  try {
    payload = Encode(found->parameters, Tuple{arguments});
  } catch (const FormatError& error) {
    on_result({false, {}, method + ": " + error.what()});
    return;
  }
  target.connection->Call({target.service, target.object, found->id}, std::move(payload), found->returned,
                          std::move(on_result), timeout_us > 0 ? timeout_us : options_.call_timeout_us);
}

void Session::Call(const std::string& service, const std::string& method, List arguments, OnResult on_result,
                   int64_t timeout_us) {
  Open(service, [this, method, arguments = std::move(arguments), on_result = std::move(on_result), timeout_us](
                    const std::shared_ptr<Service>& opened, const std::string& error) {
    if (!opened) {
      on_result({false, {}, error});
      return;
    }
    CallOn({opened->connection, opened->id, kMainObject, opened->meta}, method, arguments, on_result, timeout_us);
  });
}

void Session::Listen(const std::string& event, std::function<void(const Value&)> on_value, OnResult on_result) {
  Open("ALMemory", [this, event, on_value = std::move(on_value), on_result = std::move(on_result)](
                       const std::shared_ptr<Service>& memory, const std::string& error) {
    if (!memory) {
      on_result({false, {}, error});
      return;
    }
    const auto connection = memory->connection;
    const auto listen = [this, connection, event, on_value, on_result](const Result& result) {
      const auto* object = result.value.As<Object>();
      if (!result.ok || object == nullptr) {
        on_result({false, {}, result.ok ? "ALMemory.subscriber gave no object" : result.error});
        return;
      }
      try {
        ListenTo({connection, object->service, object->object, MetaObjectOf(object->meta_object.front())}, event,
                 on_value, on_result);
      } catch (const FormatError& problem) {
        on_result({false, {}, problem.what()});
      }
    };
    CallOn({connection, memory->id, kMainObject, memory->meta}, "subscriber", {event}, listen, 0);
  });
}

void Session::ListenTo(const Target& target, const std::string& event, std::function<void(const Value&)> on_value,
                       const OnResult& on_result) {
  const MetaSignal* signal = target.meta.FindSignal("signal");
  if (signal == nullptr) {
    on_result({false, {}, "the subscriber of '" + event + "' has no signal"});
    return;
  }
  target.connection->OnEvent({target.service, target.object, signal->id}, signal->parameters,
                             [on_value = std::move(on_value)](const Value& arguments) {
                               if (!arguments.Items().empty()) on_value(arguments.Items()[0]);
                             });
  const Value link = next_link_++;
  target.connection->Call({target.service, target.object, kRegisterEventAction},
                          Numbers("(IIL)", {target.service, signal->id, link}), ParseSignature("L"), on_result,
                          options_.call_timeout_us);
}

}  // namespace coach::qi
