// Who may see and do what. Pure functions of a request's facts.
#pragma once

#include <string>

namespace coach {

/// The facts of a request that decide about it.
struct RequestFacts {
  std::string remote_address;      ///< numeric
  std::string host;                ///< Host header, with port
  std::string origin;              ///< Origin header; empty if the browser sent none
  bool changes_something = false;  ///< POST
  bool marked = false;             ///< carries the header X-Coach, which no foreign page can send unasked
  std::string token;               ///< from the cookie or the address; empty if none
};

struct AccessRules {
  std::string token;                   ///< empty: this computer only
  bool pictures_over_network = false;  ///< camera pictures to other computers
};

bool IsLoopback(const std::string& address);

/// Empty if the request is allowed, else the reason, for the reader.
/// * From this computer: allowed if it was addressed by a name of this computer (a page of a foreign site whose name
///   resolves to 127.0.0.1 is not).
/// * From another one: only with the token.
/// * What changes something must come from our own page.
std::string WhyRefused(const RequestFacts& facts, const AccessRules& rules);

bool MaySeePictures(const RequestFacts& facts, const AccessRules& rules);

/// Compares in a time that does not depend on where the two differ.
bool SameSecret(const std::string& a, const std::string& b);

}  // namespace coach
