#include "tools/operator/page_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <chrono>
#include <future>
#include <nlohmann/json.hpp>

namespace coach {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

const httplib::Headers kOwnPage{{"X-Coach", "1"}};

class PageServerTest : public testing::Test {
 protected:
  PageServerTest() { Start(Options()); }

  static PageServer::Options Options() {
    PageServer::Options options;
    options.port = 0;
    return options;
  }

  void Start(const PageServer::Options& options) {
    server_.reset();
    server_ = std::make_unique<PageServer>(
        options, PageServer::Sources{&lesson_, &outbox_, &annotations_, "T1",
                                     [] {
                                       return StationFacts{{"rectangle"}, {"en", "el"}};
                                     },
                                     [this](const Annotation& a) { published_.push_back(a); }, [this] { ++woken_; }});
    client_ = std::make_unique<httplib::Client>("localhost", server_->port());
    client_->set_read_timeout(5);
  }

  Json Post(const std::string& path, const std::string& body, int status) {
    const auto answer = client_->Post(path, kOwnPage, body, "application/json");
    EXPECT_TRUE(answer);
    if (!answer) return {};
    EXPECT_EQ(answer->status, status) << answer->body;
    return Json::parse(answer->body);
  }

  /// The first `size` bytes of a stream.
  std::string Head(const std::string& path, size_t size) {
    std::string bytes;
    client_->Get(path, [&](const char* data, size_t length) {
      bytes.append(data, length);
      return bytes.size() < size;
    });
    return bytes;
  }

  Lesson lesson_{{}};
  CommandOutbox outbox_{{}, "T1"};
  AnnotationBook annotations_{""};
  std::vector<Annotation> published_;
  std::atomic<int> woken_{0};
  std::unique_ptr<PageServer> server_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_F(PageServerTest, ServesThePageWithItsPiecesAndNothingElse) {
  const auto page = client_->Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->get_header_value("Content-Type"), HasSubstr("text/html"));
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'self'"));
  EXPECT_THAT(page->body, HasSubstr("app.js"));
  EXPECT_THAT(client_->Get("/app.js")->get_header_value("Content-Type"), HasSubstr("text/javascript"));
  EXPECT_EQ(client_->Get("/nothing.js")->status, 404);
  EXPECT_EQ(client_->Get("/..%2f..%2fetc%2fpasswd")->status, 404);
}

TEST_F(PageServerTest, ACommandGoesIntoTheOutbox) {
  const Json answer = Post("/api/command", R"({"kind": "say", "argument": "Γεια"})", 200);
  const auto entries = outbox_.Recent();
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].command.kind, OperatorKind::kSay);
  EXPECT_EQ(entries[0].command.argument, "Γεια");
  EXPECT_EQ(entries[0].command.id, answer["id"]);
  EXPECT_EQ(woken_, 1);
}

TEST_F(PageServerTest, WhatIsNotUnderstoodIsRefusedAndChangesNothing) {
  for (const char* body : {"", "{", "[]", "7", R"({"kind": 3})", R"({"kind": "explode"})", R"({"argument": "x"})"}) {
    EXPECT_THAT(Post("/api/command", body, 400), testing::Contains(testing::_)) << body;
  }
  Post("/api/command", Json{{"kind", "say"}, {"argument", std::string(401, 'x')}}.dump(), 400);
  const auto huge = client_->Post("/api/command", kOwnPage, std::string(200'000, 'x'), "application/json");
  EXPECT_TRUE(!huge || huge->status == 413);
  EXPECT_TRUE(outbox_.Recent().empty());
}

TEST_F(PageServerTest, AForeignPageCantGiveCommands) {
  const std::string stop = R"({"kind": "stop"})";
  EXPECT_EQ(client_->Post("/api/command", stop, "application/json")->status, 403);
  httplib::Headers foreign = kOwnPage;
  foreign.emplace("Origin", "https://evil.example");
  EXPECT_EQ(client_->Post("/api/command", foreign, stop, "application/json")->status, 403);
  EXPECT_EQ(client_->Get("/", {{"Host", "evil.example"}})->status, 403);
  EXPECT_TRUE(outbox_.Recent().empty());
}

TEST_F(PageServerTest, AnAnnotationIsKeptAndPublished) {
  Post("/api/annotation", R"({"kind": "connect", "subject": "c1", "annotator": "M", "utime": 12})", 200);
  ASSERT_EQ(published_.size(), 1u);
  EXPECT_EQ(published_[0].utime, 12);
  EXPECT_EQ(annotations_.Current(5).size(), 1u);
  Post("/api/annotation", R"({"kind": "nonsense"})", 400);
  EXPECT_EQ(annotations_.Current(5).size(), 1u);
}

TEST_F(PageServerTest, StateComesAsEventsWithNamesLeftAsTheyAre) {
  AssemblyState state;
  state.session = 4;
  state.phase = Phase::kWait;
  state.events = {{1, 10, 10, "say", "<script>alert(1)</script>", -1, -1, 0, "broken \xff text"}};
  lesson_.OnState(state, 0);
  const std::string text = Head("/api/events", 10);
  ASSERT_TRUE(text.starts_with("data: ")) << text;
  const Json json = Json::parse(text.substr(6, text.find("\n\n") - 6));
  EXPECT_EQ(json["station"], "T1");
  EXPECT_EQ(json["lesson"]["session"], 4);
  EXPECT_EQ(json["events"][0]["subject"], "<script>alert(1)</script>");
  EXPECT_EQ(json["languages"].size(), 2u);
}

TEST_F(PageServerTest, TheLiveStreamCarriesPosesAndPicture) {
  lesson_.OnPicture({77, {640, 480, 500, 500, 320, 240, {}}, {0xff, 0xd8, 1, 2, 3}});
  PartPoses poses;
  poses.utime = 77;
  lesson_.OnPoses(poses);
  const std::string bytes = Head("/api/live", 60);
  const auto length = [&](size_t at) {
    return static_cast<size_t>(static_cast<uint8_t>(bytes[at])) |
           static_cast<size_t>(static_cast<uint8_t>(bytes[at + 1])) << 8;
  };
  const size_t size = length(0);
  ASSERT_GT(bytes.size(), size + 8);
  EXPECT_EQ(Json::parse(bytes.substr(4, size))["utime"], 77);
  EXPECT_EQ(length(4 + size), 5u);
  EXPECT_EQ(bytes.substr(8 + size, 5), "\xff\xd8\x01\x02\x03");
}

TEST_F(PageServerTest, MetricsInPrometheusText) {
  ServiceReport report;
  report.service = "cap\"ture";
  report.dropped = 7;
  lesson_.OnHealth(report);
  const auto metrics = client_->Get("/metrics");
  EXPECT_THAT(metrics->body, HasSubstr("coach_dropped_total{station=\"T1\",service=\"cap\\\"ture\"} 7\n"));
  EXPECT_THAT(metrics->body, HasSubstr("# TYPE coach_up gauge\n"));
}

TEST_F(PageServerTest, TooManyOpenPagesAreToldSo) {
  PageServer::Options options = Options();
  options.max_streams = 0;
  Start(options);
  EXPECT_EQ(client_->Get("/api/live")->status, 503);
  EXPECT_EQ(client_->Get("/")->status, 200) << "the rest still answers";
}

TEST_F(PageServerTest, EndsWithinTwoSecondsThoughPagesAreOpen) {
  auto page = std::async(std::launch::async, [port = server_->port()] {
    httplib::Client client("localhost", port);
    size_t bytes = 0;
    client.Get("/api/events", [&](const char*, size_t size) { return bytes += size, true; });
    return bytes;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto start = std::chrono::steady_clock::now();
  server_.reset();
  EXPECT_GT(page.get(), 0u);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

TEST_F(PageServerTest, ATakenPortAndAnOpenNetworkAreOneClearErrorEach) {
  const auto why = [&](const PageServer::Options& options) -> std::string {
    try {
      PageServer second(options, {&lesson_, &outbox_, &annotations_, "T1", {}, {}, {}});
      return "";
    } catch (const std::runtime_error& e) {
      return e.what();
    }
  };
  PageServer::Options options;
  options.port = server_->port();
  EXPECT_THAT(why(options), HasSubstr("127.0.0.1:" + std::to_string(server_->port())));
  options.address = "0.0.0.0";
  options.port = 0;
  EXPECT_THAT(why(options), HasSubstr("token"));
}

}  // namespace
}  // namespace coach
