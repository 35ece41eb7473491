#include "services/robot_bridge/screen_server.h"

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "services/robot_bridge/page.h"

namespace coach {
namespace {

constexpr size_t kMostQueued = 300;  // events that one slow page may lag behind before it is cut off
constexpr size_t kMostReports = 64;
constexpr size_t kMostSpeeches = 8;
constexpr size_t kLargestReport = 4096;  // bytes
constexpr std::chrono::seconds kBeat{2};

bool Equal(const std::string& a, const std::string& b) {  // in a time that does not tell how much is right
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (size_t i = 0; i < a.size() && i < b.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

std::optional<ScreenReport> ParseReport(const std::string& body) {
  const auto json = nlohmann::json::parse(body, nullptr, false);
  if (!json.is_object() || !json.contains("type") || !json["type"].is_string()) return std::nullopt;
  ScreenReport report;
  const std::string type = json["type"];
  if (type == "speech_started") {
    report.kind = ScreenReport::Kind::kSpeechStarted;
  } else if (type == "speech_done") {
    report.kind = ScreenReport::Kind::kSpeechDone;
  } else if (type == "help") {
    report.kind = ScreenReport::Kind::kHelp;
  } else {
    return std::nullopt;
  }
  if (json.contains("id") && json["id"].is_number_integer()) report.id = json["id"];
  if (json.contains("client") && json["client"].is_string())
    report.client = json["client"].get<std::string>().substr(0, 64);
  return report;
}

}  // namespace

struct ScreenServer::Impl {
  struct Client {
    std::deque<std::string> queue;
    bool cut = false;
  };

  VirtualRobotOptions options;
  httplib::Server server;
  int port = 0;
  std::thread thread;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::atomic<bool> ending = false;
  std::vector<std::shared_ptr<Client>> clients;
  std::vector<std::pair<std::string, std::string>> kept;  // topic, event; oldest topic first
  std::deque<std::pair<int64_t, std::string>> speeches;
  std::vector<ScreenReport> reports;

  bool Allowed(const httplib::Request& request, httplib::Response& response) const;
  void Route();
  void Attach(httplib::Response& response);
  bool Feed(const std::shared_ptr<Client>& client, httplib::DataSink& sink);
};

bool ScreenServer::Impl::Allowed(const httplib::Request& request, httplib::Response& response) const {
  // A page of another site, open in the same browser, must not speak for the robot's page.
  const std::string origin = request.get_header_value("Origin");
  bool allowed = origin.empty() || origin == "http://" + request.get_header_value("Host");
  if (allowed && !options.token.empty()) {
    const std::string cookie = request.get_header_value("Cookie");
    const size_t at = cookie.find("coach_robot=");
    const std::string from_cookie =
        at == std::string::npos ? "" : cookie.substr(at + 12, cookie.find(';', at) - at - 12);
    allowed = Equal(request.get_param_value("token"), options.token) || Equal(from_cookie, options.token);
  }
  if (!allowed) {
    response.status = 403;
    response.set_content("This page needs the station's token: open it by the address on the robot's computer.\n",
                         "text/plain; charset=utf-8");
  }
  return allowed;
}

void ScreenServer::Impl::Route() {
  server.set_default_headers(
      {{"Content-Security-Policy", "default-src 'self'; frame-ancestors 'self' http://127.0.0.1:*"},
       {"X-Content-Type-Options", "nosniff"},
       {"Cache-Control", "no-store"}});
  server.set_pre_routing_handler([this](const auto& request, auto& response) {
    return Allowed(request, response) ? httplib::Server::HandlerResponse::Unhandled
                                      : httplib::Server::HandlerResponse::Handled;
  });
  for (const PageFile& file : PageFiles()) {
    server.Get(file.path, [this, &file](const httplib::Request& request, httplib::Response& response) {
      if (request.has_param("token")) {
        response.set_header("Set-Cookie", "coach_robot=" + options.token + "; HttpOnly; SameSite=Strict; Path=/");
      }
      response.set_content(file.content.data(), file.content.size(), file.type);
    });
  }
  server.Get("/events", [this](const httplib::Request&, httplib::Response& response) { Attach(response); });
  server.Get(R"(/speech/(\d{1,18})\.wav)", [this](const httplib::Request& request, httplib::Response& response) {
    const std::lock_guard lock(mutex);
    response.status = 404;
    for (const auto& [id, wav] : speeches) {
      if (id != std::stoll(request.matches[1])) continue;
      response.status = 200;
      response.set_content(wav, "audio/wav");
    }
  });
  server.Post("/report", [this](const httplib::Request& request, httplib::Response& response) {
    const auto report = ParseReport(request.body);
    response.status = report ? 204 : 400;
    if (!report) return;
    const std::lock_guard lock(mutex);
    if (reports.size() < kMostReports) reports.push_back(*report);
  });
}

void ScreenServer::Impl::Attach(httplib::Response& response) {
  const auto client = std::make_shared<Client>();
  {
    const std::lock_guard lock(mutex);
    if (clients.size() >= static_cast<size_t>(options.max_pages)) {
      response.status = 503;
      response.set_content("too many pages are open\n", "text/plain");
      return;
    }
    for (const auto& [topic, event] : kept) client->queue.push_back(event);
    clients.push_back(client);
  }
  response.set_chunked_content_provider(
      "text/event-stream", [this, client](size_t, httplib::DataSink& sink) { return Feed(client, sink); },
      [this, client](bool) {
        const std::lock_guard lock(mutex);
        std::erase(clients, client);
      });
}

bool ScreenServer::Impl::Feed(const std::shared_ptr<Client>& client, httplib::DataSink& sink) {
  std::string out;
  {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, kBeat, [&] { return ending || client->cut || !client->queue.empty(); });
    if (ending || client->cut) return false;
    for (const std::string& event : client->queue) out += "data: " + event + "\n\n";
    client->queue.clear();
  }
  if (out.empty()) out = ":\n\n";  // shows whether the page is still there
  return sink.write(out.data(), out.size());
}

ScreenServer::ScreenServer(const VirtualRobotOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->server.new_task_queue = [pages = options.max_pages] {
    return new httplib::ThreadPool(static_cast<size_t>(pages) + 6);
  };
  impl_->server.set_payload_max_length(kLargestReport);
  impl_->server.set_keep_alive_timeout(2);
  impl_->server.set_write_timeout(5);
  impl_->server.set_tcp_nodelay(true);
  impl_->server.set_socket_options([](socket_t socket) {  // the library's default would let two servers share the port
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  impl_->Route();
  impl_->port = options.port == 0 ? impl_->server.bind_to_any_port(options.host)
                                  : (impl_->server.bind_to_port(options.host, options.port) ? options.port : -1);
  if (impl_->port <= 0) {
    throw std::runtime_error("virtual robot: can't listen at " + options.host + ":" + std::to_string(options.port) +
                             " (in use, or no such address)");
  }
  impl_->thread = std::thread([this] { impl_->server.listen_after_bind(); });
}

ScreenServer::~ScreenServer() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->ending = true;
  }
  impl_->changed.notify_all();
  while (!impl_->server.is_running() && impl_->thread.joinable()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // stop() before the listening began would be lost
  }
  impl_->server.stop();
  impl_->thread.join();
}

int ScreenServer::port() const { return impl_->port; }

std::string ScreenServer::url() const {
  const VirtualRobotOptions& options = impl_->options;
  const std::string host = options.host == "0.0.0.0" ? "127.0.0.1" : options.host;
  return "http://" + host + ":" + std::to_string(impl_->port) + "/" +
         (options.token.empty() ? "" : "?token=" + options.token);
}

void ScreenServer::Send(const std::string& topic, const std::string& json) {
  const std::lock_guard lock(impl_->mutex);
  if (!topic.empty()) {
    std::erase_if(impl_->kept, [&](const auto& entry) { return entry.first == topic; });
    impl_->kept.emplace_back(topic, json);
  }
  for (const auto& client : impl_->clients) {
    client->queue.push_back(json);
    client->cut |= client->queue.size() > kMostQueued;
  }
  impl_->changed.notify_all();
}

void ScreenServer::Drop(const std::string& topic) {
  const std::lock_guard lock(impl_->mutex);
  std::erase_if(impl_->kept, [&](const auto& entry) { return entry.first == topic; });
}

void ScreenServer::OfferSpeech(int64_t id, std::string wav) {
  const std::lock_guard lock(impl_->mutex);
  impl_->speeches.emplace_back(id, std::move(wav));
  if (impl_->speeches.size() > kMostSpeeches) impl_->speeches.pop_front();
}

std::vector<ScreenReport> ScreenServer::TakeReports() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->reports, {});
}

int ScreenServer::attached() const {
  const std::lock_guard lock(impl_->mutex);
  return static_cast<int>(impl_->clients.size());
}

}  // namespace coach
