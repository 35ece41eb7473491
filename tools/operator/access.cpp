#include "tools/operator/access.h"

namespace coach {
namespace {

/// "localhost:8080" -> "localhost", "[::1]:8080" -> "[::1]"
std::string WithoutPort(const std::string& host) {
  if (!host.empty() && host.front() == '[') return host.substr(0, host.find(']') + 1);
  return host.substr(0, host.find(':'));
}

bool IsOwnName(const std::string& host) {
  const std::string name = WithoutPort(host);
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

}  // namespace

bool IsLoopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.") || address.starts_with("::ffff:127.");
}

bool SameSecret(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (size_t k = 0; k < a.size(); ++k) difference |= static_cast<unsigned>(a[k] ^ b[k]);
  return difference == 0;
}

std::string WhyRefused(const RequestFacts& facts, const AccessRules& rules) {
  if (IsLoopback(facts.remote_address)) {
    if (!IsOwnName(facts.host)) return "open the page as http://localhost";
  } else {
    if (rules.token.empty()) return "the page is open to its own computer only";
    if (!SameSecret(facts.token, rules.token))
      return "the address must end with the token that the page was started with";
  }
  if (facts.changes_something) {
    if (!facts.marked) return "the request does not come from the page";
    if (!facts.origin.empty() && !facts.origin.ends_with("://" + facts.host))
      return "the request comes from a foreign page";
  }
  return "";
}

bool MaySeePictures(const RequestFacts& facts, const AccessRules& rules) {
  return IsLoopback(facts.remote_address) || rules.pictures_over_network;
}

}  // namespace coach
