#include "tools/operator/access.h"

#include <gtest/gtest.h>

namespace coach {
namespace {

RequestFacts From(const std::string& address, const std::string& host, const std::string& token) {
  RequestFacts facts;
  facts.remote_address = address;
  facts.host = host;
  facts.token = token;
  return facts;
}
RequestFacts Local() { return From("127.0.0.1", "localhost:8080", ""); }
RequestFacts Remote(const std::string& token) { return From("192.168.1.7", "192.168.1.2:8080", token); }
const AccessRules kOpen{"a-long-secret", false};
const AccessRules kLocalOnly{};

TEST(Access, ThisComputerNeedsNoToken) {
  EXPECT_EQ(WhyRefused(Local(), kLocalOnly), "");
  EXPECT_EQ(WhyRefused(Local(), kOpen), "");
}

TEST(Access, AForeignNameThatLeadsHereIsRefused) {
  RequestFacts facts = Local();
  facts.host = "evil.example:8080";
  EXPECT_NE(WhyRefused(facts, kLocalOnly), "");
  facts.host = "localhost.evil.example";
  EXPECT_NE(WhyRefused(facts, kLocalOnly), "");
  facts.host = "[::1]:8080";
  facts.remote_address = "::1";
  EXPECT_EQ(WhyRefused(facts, kLocalOnly), "");
}

TEST(Access, OtherComputersNeedTheToken) {
  EXPECT_NE(WhyRefused(Remote("a-long-secret"), kLocalOnly), "");
  EXPECT_NE(WhyRefused(Remote(""), kOpen), "");
  EXPECT_NE(WhyRefused(Remote("a-long-secreT"), kOpen), "");
  EXPECT_NE(WhyRefused(Remote("a-long"), kOpen), "");
  EXPECT_EQ(WhyRefused(Remote("a-long-secret"), kOpen), "");
}

TEST(Access, OnlyOurOwnPageMayChangeSomething) {
  RequestFacts facts = Local();
  facts.changes_something = true;
  EXPECT_NE(WhyRefused(facts, kLocalOnly), "");
  facts.marked = true;
  EXPECT_EQ(WhyRefused(facts, kLocalOnly), "");
  facts.origin = "http://localhost:8080";
  EXPECT_EQ(WhyRefused(facts, kLocalOnly), "");
  facts.origin = "http://localhost:9999";
  EXPECT_NE(WhyRefused(facts, kLocalOnly), "");
  facts.origin = "https://evil.example";
  EXPECT_NE(WhyRefused(facts, kLocalOnly), "");
}

TEST(Access, PicturesStayHereUnlessAskedFor) {
  EXPECT_TRUE(MaySeePictures(Local(), kOpen));
  EXPECT_FALSE(MaySeePictures(Remote("a-long-secret"), kOpen));
  EXPECT_TRUE(MaySeePictures(Remote("a-long-secret"), {"a-long-secret", true}));
}

TEST(Access, Loopback) {
  for (const char* address : {"127.0.0.1", "127.5.5.5", "::1", "::ffff:127.0.0.1"}) EXPECT_TRUE(IsLoopback(address));
  for (const char* address : {"0.0.0.0", "::", "10.0.0.1", "128.127.0.1", ""}) EXPECT_FALSE(IsLoopback(address));
}

}  // namespace
}  // namespace coach
