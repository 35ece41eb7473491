#include "tools/operator/page_server.h"

#include <httplib.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "common/configuration/yaml_reader.h"
#include "tools/operator/json_text.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr int kThreads = 48;              // streams plus what else a dozen pages ask for at once
constexpr int kHeartbeat = 1000;          // ms
constexpr int kStatePause = 200;          // ms between two states: a page needs no more
constexpr size_t kMaxPosted = 64 * 1024;  // bytes, where a route does not say otherwise
constexpr size_t kMaxText = 400;          // bytes of a command's argument
constexpr size_t kMaxAnnotations = 300;   // that a page is sent

int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

const char* ContentType(const std::string& name) {
  static constexpr std::array<std::pair<const char*, const char*>, 5> kTypes{
      {{".html", "text/html; charset=utf-8"},
       {".js", "text/javascript; charset=utf-8"},
       {".css", "text/css; charset=utf-8"},
       {".svg", "image/svg+xml"},
       {".webmanifest", "application/manifest+json"}}};
  for (const auto& [ending, type] : kTypes) {
    if (name.ends_with(ending)) return type;
  }
  return "application/octet-stream";
}

std::string CookieToken(const std::string& cookies) {
  const std::string key = "coach_token=";
  const size_t start = cookies.find(key);
  if (start == std::string::npos) return "";
  return cookies.substr(start + key.size(), cookies.find(';', start) - start - key.size());
}

RequestFacts FactsOf(const httplib::Request& request) {
  RequestFacts facts;
  facts.remote_address = request.remote_addr;
  facts.host = request.get_header_value("Host");
  facts.origin = request.get_header_value("Origin");
  facts.changes_something = request.method != "GET" && request.method != "HEAD";
  facts.marked = request.has_header("X-Coach");
  facts.token =
      request.has_param("token") ? request.get_param_value("token") : CookieToken(request.get_header_value("Cookie"));
  return facts;
}

void Refuse(httplib::Response& response, int status, const std::string& reason) {
  response.status = status;
  response.set_content(Dump({{"error", reason}}), "application/json");
}

void AppendRecord(std::string& out, const char* data, size_t size) {
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>((size >> shift) & 0xff);
  out.append(data, size);
}

/// Counts an open stream for as long as it lives.
class StreamTicket {
 public:
  explicit StreamTicket(std::atomic<int>& open) : open_(open) { ++open_; }
  ~StreamTicket() { --open_; }
  StreamTicket(const StreamTicket&) = delete;
  StreamTicket& operator=(const StreamTicket&) = delete;

 private:
  std::atomic<int>& open_;
};

}  // namespace

struct PageServer::Impl {
  Options options;
  Sources sources;
  httplib::Server server;
  std::thread thread;
  std::atomic<bool> closing{false};
  std::atomic<int> streams{0};
  int port = 0;

  void Configure() {
    server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server.set_keep_alive_max_count(10'000);
    size_t largest = kMaxPosted;
    for (const Route& route : sources.routes) largest = std::max(largest, route.largest_body);
    server.set_payload_max_length(largest);
    // Not SO_REUSEPORT, httplib's default: a second page on the same port must fail, not share it.
    server.set_socket_options([](socket_t sock) {
      const int yes = 1;
      setsockopt(sock, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
      setsockopt(sock, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    });
    server.set_default_headers({{"Content-Security-Policy",
                                 "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
                                 "frame-ancestors 'self'; form-action 'self'"},
                                {"X-Content-Type-Options", "nosniff"},
                                {"Referrer-Policy", "no-referrer"},
                                {"Cache-Control", "no-store"}});
    server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      const RequestFacts facts = FactsOf(request);
      const std::string refused = WhyRefused(facts, options.access);
      if (!refused.empty()) {
        Refuse(response, 403, refused);
        return httplib::Server::HandlerResponse::Handled;
      }
      if (facts.changes_something && !SmallEnough(request)) {
        Refuse(response, 413, "this is too large");
        return httplib::Server::HandlerResponse::Handled;
      }
      if (request.has_param("token") && !options.access.token.empty()) {
        response.set_header("Set-Cookie", "coach_token=" + facts.token + "; HttpOnly; SameSite=Strict; Path=/");
      }
      return httplib::Server::HandlerResponse::Unhandled;
    });
    server.set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr error) {
      try {
        std::rethrow_exception(error);
      } catch (const Json::exception&) {
        Refuse(response, 400, "the request is not understood");
      } catch (const ConfigurationError& e) {
        Refuse(response, 400, e.what());
      } catch (const std::invalid_argument& e) {
        Refuse(response, 400, e.what());
      } catch (const std::exception& e) {
        Refuse(response, 500, e.what());
      }
    });
  }

  /// Bodies are read only after this: what is too large, or does not say how large it is, never comes in.
  bool SmallEnough(const httplib::Request& request) const {
    size_t largest = kMaxPosted;
    for (const Route& route : sources.routes) {
      if (route.post && route.path == request.path) largest = route.largest_body;
    }
    return request.has_header("Content-Length") && request.get_header_value<uint64_t>("Content-Length") <= largest;
  }

  void AddFurther(const Route& route) {
    const auto answer = [handler = route.handler](const httplib::Request& request, httplib::Response& response) {
      const Answer made = handler({request.body, request.has_param("name") ? request.get_param_value("name") : ""});
      response.set_content(made.body, made.type);
    };
    if (route.post) {
      server.Post(route.path, answer);
    } else {
      server.Get(route.path, answer);
    }
  }

  void AddRoutes() {
    for (const Route& route : sources.routes) AddFurther(route);
    server.Get("/api/events", [this](const auto& request, auto& response) { Events(request, response); });
    server.Get("/api/live", [this](const auto& request, auto& response) { Live(request, response); });
    server.Get("/api/task", [this](const auto&, auto& response) {
      const auto task = sources.lesson->task();
      response.set_content(task ? task->json : "{}", "application/json");
    });
    server.Get("/metrics", [this](const auto&, auto& response) {
      response.set_content(PrometheusText(sources.lesson->Read(0).services, sources.station, Now()),
                           "text/plain; version=0.0.4");
    });
    server.Post("/api/command", [this](const auto& request, auto& response) { Command(request, response); });
    server.Post("/api/annotation", [this](const auto& request, auto& response) { Annotate(request, response); });
    server.Get(R"(/([\w.-]*))", [this](const auto& request, auto& response) { File(request.matches[1], response); });
  }

  void File(const std::string& asked, httplib::Response& response) const {
    const std::string name = asked.empty() ? "index.html" : asked;
    if (!options.folder.empty()) {
      std::ifstream in(std::filesystem::path(options.folder) / name, std::ios::binary);
      if (in) return response.set_content({std::istreambuf_iterator<char>(in), {}}, ContentType(name));
    } else if (const std::string* bytes = BuiltInFile(name)) {
      return response.set_content(*bytes, ContentType(name));
    }
    Refuse(response, 404, "there is no such page");
  }

  /// Null, with the refusal in `response`, if too many are open.
  std::shared_ptr<StreamTicket> OpenStream(httplib::Response& response) {
    auto ticket = std::make_shared<StreamTicket>(streams);
    if (streams <= options.max_streams) return ticket;
    Refuse(response, 503, "too many pages are open; close one");
    return nullptr;
  }

  void Events(const httplib::Request&, httplib::Response& response) {
    auto ticket = OpenStream(response);
    if (!ticket) return;
    response.set_chunked_content_provider(
        "text/event-stream", [this, ticket, revision = int64_t{0}, session = int64_t{0}, last_event = int64_t{0}](
                                 size_t, httplib::DataSink& sink) mutable {
          if (revision != 0) std::this_thread::sleep_for(std::chrono::milliseconds(kStatePause));
          sources.lesson->WaitForChange(revision, kHeartbeat);
          if (closing) return false;
          auto snapshot = sources.lesson->Read(last_event);
          if (snapshot.state.session != session) {
            session = snapshot.state.session;
            snapshot = sources.lesson->Read(0);
          }
          revision = snapshot.revision;
          if (!snapshot.events.empty()) last_event = snapshot.events.back().id;
          const std::string text =
              "data: " +
              StateJson(snapshot, sources.outbox->Recent(), sources.annotations->Current(kMaxAnnotations),
                        sources.facts(), sources.station, Now()) +
              "\n\n";
          return sink.write(text.data(), text.size());
        });
  }

  void Live(const httplib::Request& request, httplib::Response& response) {
    auto ticket = OpenStream(response);
    if (!ticket) return;
    const bool pictures = MaySeePictures(FactsOf(request), options.access);
    response.set_chunked_content_provider("application/octet-stream", [this, ticket, pictures, number = int64_t{0}](
                                                                          size_t, httplib::DataSink& sink) mutable {
      const auto view = sources.lesson->WaitForView(number, kHeartbeat);
      if (closing) return false;
      std::string record;
      if (view) {
        number = view->number;
        const std::string json = ViewJson(*view);
        AppendRecord(record, json.data(), json.size());
        const bool shown = pictures && view->picture;
        AppendRecord(record, shown ? reinterpret_cast<const char*>(view->picture->jpeg.data()) : "",
                     shown ? view->picture->jpeg.size() : 0);
      } else {
        AppendRecord(record, "", 0);
        AppendRecord(record, "", 0);
      }
      return sink.write(record.data(), record.size());
    });
  }

  void Command(const httplib::Request& request, httplib::Response& response) const {
    const Json posted = Json::parse(request.body);
    const auto kind = OperatorKindOf(posted.at("kind"));
    const std::string argument = posted.value("argument", "");
    if (!kind) return Refuse(response, 400, "unknown command");
    if (argument.size() > kMaxText) return Refuse(response, 400, "the text is longer than 400 bytes");
    const int64_t id = sources.outbox->Post(*kind, argument, Now());
    if (id == 0) return Refuse(response, 503, "too many commands are waiting for an answer");
    sources.command_waits();
    sources.lesson->Touch();
    response.set_content(Json{{"id", id}}.dump(), "application/json");
  }

  void Annotate(const httplib::Request& request, httplib::Response& response) const {
    const Json posted = Json::parse(request.body);
    Annotation annotation;
    annotation.kind = posted.at("kind");
    annotation.subject = posted.value("subject", "");
    annotation.value = posted.value("value", "");
    annotation.annotator = posted.value("annotator", "");
    annotation.utime = posted.value("utime", int64_t{0});
    annotation.replaces_id = posted.value("replaces_id", int64_t{0});
    const std::string problem = ProblemOf(annotation);
    if (!problem.empty()) return Refuse(response, 400, problem);
    const Annotation kept = sources.annotations->Add(annotation, Now());
    sources.publish(kept);
    sources.lesson->Touch();
    response.set_content(Json{{"id", kept.id}}.dump(), "application/json");
  }
};

PageServer::PageServer(const Options& options, const Sources& sources) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->sources = sources;
  if (!IsLoopback(options.address) && options.address != "localhost" && options.access.token.empty()) {
    throw std::runtime_error("address " + options.address +
                             " is open to the network: a token is needed (operator: token in the station file)");
  }
  impl_->Configure();
  impl_->AddRoutes();
  impl_->port = options.port;
  const bool bound = options.port == 0 ? (impl_->port = impl_->server.bind_to_any_port(options.address)) > 0
                                       : impl_->server.bind_to_port(options.address, options.port);
  if (!bound) {
    throw std::runtime_error("can't listen on " + options.address + ":" + std::to_string(options.port) +
                             ": the port is taken or the address is not of this computer");
  }
  impl_->thread = std::thread([impl = impl_.get()] { impl->server.listen_after_bind(); });
}

PageServer::~PageServer() {
  impl_->closing = true;
  impl_->sources.lesson->Close();
  // stop() before the listening thread has begun would be forgotten.
  while (!impl_->server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  impl_->server.stop();
  impl_->thread.join();
}

int PageServer::port() const { return impl_->port; }

std::string PageServer::Url() const {
  const auto& options = impl_->options;
  const std::string host = IsLoopback(options.address) ? "localhost" : options.address;
  return "http://" + host + ":" + std::to_string(impl_->port) + "/" +
         (options.access.token.empty() ? "" : "?token=" + options.access.token);
}

}  // namespace coach
