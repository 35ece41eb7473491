#include "services/robot_bridge/qi/connection.h"

#include <utility>

#include "services/robot_bridge/qi/codec.h"

namespace coach::qi {
namespace {

constexpr size_t kMostPending = 256;
constexpr uint32_t kAuthenticateAction = 8;
constexpr uint32_t kMainObject = 1, kMetaObjectAction = 2;
constexpr int64_t kLoginContinues = 2, kLoginDone = 3;
constexpr int kMostLoginRounds = 4;
constexpr int kUnansweredUntilDoubt = 2;  // calls in a row

const Signature& Dynamic() {
  static const Signature kDynamic = ParseSignature("m");
  return kDynamic;
}
const Signature& Capabilities() {
  static const Signature kCapabilities = ParseSignature("{sm}");
  return kCapabilities;
}

/// A dynamic value that holds a text; some servers send the text alone.
std::string ErrorText(const std::string& payload) {
  try {
    return Decode(Dynamic(), payload).Text();
  } catch (const FormatError&) {
    return Decode(ParseSignature("s"), payload).Text();
  }
}

}  // namespace

Result ResultOf(const Message& message, const Signature& returned) {
  Result result;
  try {
    switch (message.type) {
      case MessageType::kReply: {
        const bool dynamic = (message.flags & kDynamicPayload) != 0;
        result.value = Decode(dynamic ? Dynamic() : returned, message.payload);
        result.ok = true;
        break;
      }
      case MessageType::kError:
        result.error = ErrorText(message.payload);
        if (result.error.empty()) result.error = "the robot reports an error without a word";
        break;
      default:
        result.error = "the call was cancelled";
    }
  } catch (const FormatError& error) {
    result.ok = false;
    result.error = std::string("an answer that can't be read: ") + error.what();
  }
  return result;
}

Session::Connection::Connection(const Endpoint& endpoint, const SessionOptions& options, int64_t now)
    : options_(options), token_(options.token), transport_(endpoint), now_(now) {}

void Session::Connection::Authenticate() {
  Map capabilities;
  const auto add = [&](const char* name, Value value) { capabilities.items.emplace_back(name, std::move(value)); };
  add("ClientServerSocket", true);
  add("MessageFlags", true);
  add("MetaObjectCache", false);
  add("RemoteCancelableCalls", false);
  add("ObjectPtrUID", false);
  if (!options_.user.empty()) add("auth_user", options_.user);
  if (!token_.empty()) add("auth_token", token_);
  Message message;
  message.id = login_id_ = next_id_++;
  message.action = kAuthenticateAction;
  message.payload = Encode(Capabilities(), capabilities);
  stage_ = Stage::kAuthenticating;
  transport_.Send(message);
}

void Session::Connection::HandleLogin(const Message& message) {
  const bool login_asked = !options_.user.empty() || !options_.token.empty();
  if (message.type == MessageType::kCapability) {
    // A server that knows no authentication may say so by its capabilities. Others send them of their own accord: with
    // a login only the answer to it counts.
    if (!login_asked) BeReady();
    return;
  }
  const Result result = ResultOf(message, Capabilities());
  if (message.type == MessageType::kReply && !result.ok) {
    transport_.Close("login: " + result.error);
  } else if (message.type == MessageType::kReply) {
    HandleLoginState(result.value);
  } else if (login_asked) {
    transport_.Close("login refused: " + result.error);
  } else {
    BeReady();  // a server that knows no authentication; one that wants it closes the connection
  }
}

void Session::Connection::HandleLoginState(const Value& answer) {
  const Value* state = answer.Find("__qi_auth_state");
  if (state == nullptr || state->Integer() == kLoginDone) {
    BeReady();
    return;
  }
  if (state->Integer() == kLoginContinues && ++login_rounds_ < kMostLoginRounds) {
    if (const Value* token = answer.Find("auth_newToken")) token_ = token->Text();
    Authenticate();
    return;
  }
  const Value* reason = answer.Find("__qi_auth_err_reason");
  transport_.Close("login refused" + (reason == nullptr ? "" : ": " + reason->Text()));
}

void Session::Connection::BeReady() {
  stage_ = Stage::kReady;
  for (const Message& waiting : std::exchange(waiting_, {})) transport_.Send(waiting);
}

void Session::Connection::Call(const Address& address, std::string payload, const Signature& returned,
                               OnResult on_result, int64_t timeout_us) {
  if (closed() || pending_.size() >= kMostPending) {
    on_result({false, {}, closed() ? problem() : "too many calls are under way"});
    return;
  }
  Message message;
  message.id = next_id_++;
  message.service = address.service;
  message.object = address.object;
  message.action = address.action;
  message.payload = std::move(payload);
  last_service_ = address.service;
  pending_[message.id] = {returned, std::move(on_result), now_ + timeout_us, timeout_us};
  if (stage_ == Stage::kReady) {
    transport_.Send(message);
  } else {
    waiting_.push_back(std::move(message));
  }
}

void Session::Connection::OnEvent(const Address& address, const Signature& parameters,
                                  std::function<void(const Value&)> on_value) {
  listeners_[address] = {parameters, std::move(on_value)};
}

void Session::Connection::HandleEvent(const Message& message) {
  const auto found = listeners_.find({message.service, message.object, message.action});
  if (found == listeners_.end()) return;
  const Listener listener = found->second;
  try {
    const bool dynamic = (message.flags & kDynamicPayload) != 0;
    listener.on_value(Decode(dynamic ? Dynamic() : listener.parameters, message.payload));
  } catch (const FormatError&) {
    // An event that can't be read says nothing; the next one may.
  }
}

void Session::Connection::Handle(const Message& message) {
  unanswered_ = 0;
  if (stage_ == Stage::kAuthenticating) {
    const bool answer = message.id == login_id_ && message.type != MessageType::kEvent;
    if (answer || message.type == MessageType::kCapability) HandleLogin(message);
    return;
  }
  switch (message.type) {
    case MessageType::kReply:
    case MessageType::kError:
    case MessageType::kCancelled: {
      const auto found = pending_.find(message.id);
      if (found == pending_.end()) return;  // too late: its time was over
      const Pending pending = std::move(found->second);
      pending_.erase(found);
      pending.on_result(ResultOf(message, pending.returned));
      return;
    }
    case MessageType::kEvent:
    case MessageType::kPost:
      HandleEvent(message);
      return;
    default:
      return;
  }
}

void Session::Connection::Expire() {
  std::vector<Pending> late;
  for (auto i = pending_.begin(); i != pending_.end();) {
    if (i->second.deadline > now_) {
      ++i;
    } else {
      late.push_back(std::move(i->second));
      i = pending_.erase(i);
    }
  }
  unanswered_ += static_cast<int>(late.size());
  for (const Pending& pending : late) {
    pending.on_result({false, {}, "no answer within " + std::to_string(pending.timeout / 1000) + " ms"});
  }
}

/// A call without an answer says nothing of the others. After some in a row without any other word from there, an
/// object is asked what it can do: who does not even answer that is gone, though the network does not say so.
void Session::Connection::Doubt() {
  if (probing_ || unanswered_ < kUnansweredUntilDoubt || closed() || stage_ != Stage::kReady) return;
  probing_ = true;
  static const Signature kArgument = ParseSignature("(I)");
  Call(
      {last_service_, kMainObject, kMetaObjectAction}, Encode(kArgument, Tuple{List{0}}),
      ParseSignature(kMetaObjectSignature),
      [this](const Result&) {
        probing_ = false;
        if (unanswered_ > 0) transport_.Close(ToString(endpoint()) + " does not answer any more");
      },
      options_.call_timeout_us);
}

void Session::Connection::Poll(int64_t now) {
  now_ = now;
  transport_.Poll();
  if (stage_ == Stage::kConnecting && transport_.state() == Transport::State::kOpen) Authenticate();
  while (const auto message = transport_.Receive()) Handle(*message);
  Expire();
  Doubt();
}

void Session::Connection::FailAll(const std::string& error) {
  transport_.Close(error);
  listeners_.clear();
  for (const auto& [id, pending] : std::exchange(pending_, {})) pending.on_result({false, {}, error});
}

}  // namespace coach::qi
