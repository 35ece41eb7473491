#include "services/robot_bridge/qi/transport.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "services/robot_bridge/qi/signature.h"

namespace coach::qi {
namespace {

constexpr size_t kLargestPayload = 16 << 20;
constexpr size_t kMostOutgoing = 8 << 20;

/// A robot that loses its power or its network says no farewell.
void GiveUpOnSilence(int fd) {
  const int yes = 1, idle = 5, interval = 2, probes = 3;  // s, s
  const unsigned unacknowledged = 10000;                  // ms
  setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
  setsockopt(fd, IPPROTO_TCP, TCP_KEEPIDLE, &idle, sizeof idle);
  setsockopt(fd, IPPROTO_TCP, TCP_KEEPINTVL, &interval, sizeof interval);
  setsockopt(fd, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
  setsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &unacknowledged, sizeof unacknowledged);
}

bool IsAddress(const std::string& host) {
  in6_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1 || inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

}  // namespace

std::optional<Endpoint> ParseEndpoint(const std::string& url) {
  Endpoint endpoint;
  size_t at = 0;
  if (url.starts_with("tcp://")) {
    at = 6;
    endpoint.port = 9559;
  } else if (url.starts_with("tcps://")) {
    at = 7;
    endpoint.tls = true;
    endpoint.port = 9503;
  } else {
    return std::nullopt;
  }
  const size_t colon = url.rfind(':');
  const bool has_port = colon != std::string::npos && colon > at && url.find(']', colon) == std::string::npos;
  endpoint.host = url.substr(at, has_port ? colon - at : std::string::npos);
  if (endpoint.host.starts_with('[') && endpoint.host.ends_with(']')) {
    endpoint.host = endpoint.host.substr(1, endpoint.host.size() - 2);
  }
  if (has_port) {
    const char *first = url.data() + colon + 1, *last = url.data() + url.size();
    const auto [end, error] = std::from_chars(first, last, endpoint.port);
    if (error != std::errc() || end != last || endpoint.port == 0) return std::nullopt;
  }
  if (endpoint.host.empty()) return std::nullopt;
  return endpoint;
}

std::string ToString(const Endpoint& endpoint) {
  const bool v6 = endpoint.host.find(':') != std::string::npos;
  return (endpoint.tls ? "tcps://" : "tcp://") + (v6 ? "[" + endpoint.host + "]" : endpoint.host) + ":" +
         std::to_string(endpoint.port);
}

struct Transport::Lookup {
  struct Address {
    sockaddr_storage storage{};
    socklen_t size = 0;
  };
  std::mutex mutex;
  bool done = false;
  std::string problem;
  std::vector<Address> addresses;

  void Run(const std::string& host, uint16_t port) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
    const std::lock_guard lock(mutex);
    if (error != 0) problem = "unknown host '" + host + "': " + gai_strerror(error);
    for (const addrinfo* info = found; info != nullptr; info = info->ai_next) {
      Address address;
      std::memcpy(&address.storage, info->ai_addr, info->ai_addrlen);
      address.size = info->ai_addrlen;
      addresses.push_back(address);
    }
    if (found != nullptr) freeaddrinfo(found);
    done = true;
  }
};

struct Transport::Tls {
  SSL_CTX* context = nullptr;
  SSL* ssl = nullptr;
  bool shaken = false;
  ~Tls() {
    SSL_free(ssl);
    SSL_CTX_free(context);
  }
};

Transport::Transport(const Endpoint& endpoint)
    : endpoint_(endpoint), lookup_(std::make_shared<Lookup>()), reader_(kLargestPayload) {
  // A look-up may take long and can't be cut short: the thread owns what it writes to and is left alone.
  std::thread([lookup = lookup_, host = endpoint.host, port = endpoint.port] { lookup->Run(host, port); }).detach();
}

Transport::~Transport() { Close("closed"); }

void Transport::Close(const std::string& problem) {
  problem_ = problem;
  state_ = State::kClosed;
  tls_.reset();
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
}

void Transport::StartConnecting() {
  const std::lock_guard lock(lookup_->mutex);
  if (!lookup_->done) return;
  if (next_address_ >= lookup_->addresses.size()) {
    Close(lookup_->problem.empty() ? "no connection to " + ToString(endpoint_) + ": " + problem_ : lookup_->problem);
    return;
  }
  const Lookup::Address& address = lookup_->addresses[next_address_++];
  fd_ = socket(address.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd_ < 0) return;
  const int yes = 1;
  setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  GiveUpOnSilence(fd_);
  if (connect(fd_, reinterpret_cast<const sockaddr*>(&address.storage), address.size) == 0 || errno == EINPROGRESS)
    return;
  problem_ = std::strerror(errno);
  close(fd_);
  fd_ = -1;
}

void Transport::FinishConnecting() {
  pollfd waiting{fd_, POLLOUT, 0};
  if (poll(&waiting, 1, 0) <= 0) return;
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) {
    problem_ = std::strerror(error);
    close(fd_);
    fd_ = -1;  // the next address, if there is one
    return;
  }
  connected_ = true;
  if (endpoint_.tls) {
    StartTls();
  } else {
    state_ = State::kOpen;
  }
}

void Transport::StartTls() {
  signal(SIGPIPE, SIG_IGN);  // OpenSSL writes by write(2): a server that dies must not take this process with it
  tls_ = std::make_unique<Tls>();
  tls_->context = SSL_CTX_new(TLS_client_method());
  SSL_CTX_set_min_proto_version(tls_->context, TLS1_2_VERSION);
  SSL_CTX_set_verify(tls_->context, SSL_VERIFY_NONE, nullptr);
  SSL_CTX_set_mode(tls_->context, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  tls_->ssl = SSL_new(tls_->context);
  if (!IsAddress(endpoint_.host)) SSL_set_tlsext_host_name(tls_->ssl, endpoint_.host.c_str());  // RFC 6066: names only
  SSL_set_fd(tls_->ssl, fd_);
}

void Transport::Shake() {
  ERR_clear_error();
  const int done = SSL_connect(tls_->ssl);
  if (done == 1) {
    tls_->shaken = true;
    state_ = State::kOpen;
    return;
  }
  const int error = SSL_get_error(tls_->ssl, done);
  if (error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE) return;
  char text[160] = "the other side closed";
  if (const unsigned long code = ERR_get_error(); code != 0) ERR_error_string_n(code, text, sizeof text);
  Close("TLS with " + ToString(endpoint_) + " failed: " + text);
}

long Transport::SomeWritten(const char* bytes, size_t size) {
  if (tls_) {
    ERR_clear_error();
    const int sent = SSL_write(tls_->ssl, bytes, static_cast<int>(std::min<size_t>(size, 1 << 20)));
    if (sent > 0) return sent;
    const int error = SSL_get_error(tls_->ssl, sent);
    return error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE ? 0 : -1;
  }
  const ssize_t sent = send(fd_, bytes, size, MSG_NOSIGNAL);
  if (sent >= 0) return sent;
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : -1;
}

long Transport::SomeRead(char* bytes, size_t size) {
  if (tls_) {
    ERR_clear_error();
    const int got = SSL_read(tls_->ssl, bytes, static_cast<int>(size));
    if (got > 0) return got;
    const int error = SSL_get_error(tls_->ssl, got);
    return error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE ? 0 : -1;
  }
  const ssize_t got = recv(fd_, bytes, size, 0);
  if (got > 0) return got;
  if (got == 0) return -1;
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : -1;
}

void Transport::Write() {
  while (state_ == State::kOpen && !outgoing_.empty()) {
    const long sent = SomeWritten(outgoing_.data(), outgoing_.size());
    if (sent == 0) return;
    if (sent < 0) {
      Close("the connection to " + ToString(endpoint_) + " was lost");
      return;
    }
    outgoing_.erase(0, static_cast<size_t>(sent));
  }
}

void Transport::Read() {
  std::array<char, 65536> bytes{};
  for (int i = 0; i < 64 && state_ == State::kOpen; ++i) {  // at most 4 MB at a time: others want to be served too
    const long got = SomeRead(bytes.data(), bytes.size());
    if (got == 0) return;
    if (got < 0) {
      Close("the connection to " + ToString(endpoint_) + " was lost");
      return;
    }
    reader_.Append(bytes.data(), static_cast<size_t>(got));
  }
}

void Transport::Poll() {
  if (state_ == State::kConnecting) {
    if (fd_ < 0) StartConnecting();
    if (fd_ >= 0 && !connected_) FinishConnecting();
    if (tls_ && !tls_->shaken) Shake();
  }
  if (state_ != State::kOpen) return;
  Write();
  if (state_ == State::kOpen) Read();
}

void Transport::Send(const Message& message) {
  if (state_ == State::kClosed) return;
  outgoing_ += EncodeMessage(message);
  if (outgoing_.size() > kMostOutgoing) Close(ToString(endpoint_) + " takes nothing any more");
  Write();
}

std::optional<Message> Transport::Receive() {
  try {
    return reader_.Next();
  } catch (const FormatError& error) {
    Close(ToString(endpoint_) + ": " + error.what());
    return std::nullopt;
  }
}

}  // namespace coach::qi
