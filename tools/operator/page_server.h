// The web server of the teacher's page.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/operator/access.h"
#include "tools/operator/annotations.h"
#include "tools/operator/command_outbox.h"
#include "tools/operator/lesson.h"
#include "tools/operator/page_json.h"

namespace coach {

/// Serves the page's files, the state (server-sent events), poses and pictures (one binary stream), and takes commands
/// and annotations. See page/app.js for the other side.
///
/// GET  /api/events   text/event-stream of StateJson, at most 5 a second; 1 a second if nothing changes
/// GET  /api/live     records: u32 length, ViewJson, u32 length, JPEG (may be empty); little endian; an empty ViewJson
///                    once a second if there is nothing new
/// GET  /api/task     TaskView::json
/// GET  /metrics      PrometheusText
/// POST /api/command     {"kind": "start", "argument": ""} -> {"id": 1}
/// POST /api/annotation  {"kind", "subject", "value", "annotator", "utime", "replaces_id"} -> {"id": 1}
/// POST needs the header X-Coach. Refusals are {"error": "..."} with status 400, 403, 413, 500 or 503.
class PageServer {
 public:
  /// What further pages (set-up, new tasks) answer. An exception is a refusal with its text: ConfigurationError and
  /// std::invalid_argument are the asker's fault (400), any other ours (500).
  struct Request {
    std::string body;
    std::string name;  ///< of the address' query
  };
  struct Answer {
    std::string body;
    std::string type = "application/json";
  };
  using Handler = std::function<Answer(const Request&)>;
  struct Route {
    std::string path;  ///< /api/...
    bool post = false;
    Handler handler;
    size_t largest_body = 64 * 1024;  ///< bytes
  };
  struct Options {
    std::string address = "127.0.0.1";
    int port = 8080;  ///< 0: any that is free
    AccessRules access;
    std::string folder;    ///< page's files from this folder instead of those built in; for those who change the page
    int max_streams = 24;  ///< open streams (two a page); more are told to come back later
  };
  struct Sources {
    Lesson* lesson = nullptr;
    CommandOutbox* outbox = nullptr;
    AnnotationBook* annotations = nullptr;
    std::string station;
    std::function<StationFacts()> facts;
    // Called from the server's threads:
    std::function<void(const Annotation&)> publish;
    std::function<void()> command_waits;  ///< the outbox has something new
    std::vector<Route> routes{};          ///< of further pages
  };

  /// @throws std::runtime_error if the address can't be listened on or would be open to the network without a token.
  PageServer(const Options& options, const Sources& sources);
  /// Closes every page's streams and returns within two seconds.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  int port() const;
  std::string Url() const;  ///< with the token, if there is one

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Looks up one of the page's built-in files. Null if there is none of that name.
const std::string* BuiltInFile(const std::string& name);

}  // namespace coach
