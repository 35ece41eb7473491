// Signatures: the text that says what type a value has on the wire.
//
//   b bool; c C w W i I l L integers of 1, 2, 4, 8 bytes (signed lower case); f d floats; s string; r raw; v void;
//   m dynamic; o object; X unknown; [t] list; {kv} map; (..) tuple; +t optional; #t ~t the rest of the arguments.
//   <...> after a tuple names it and its members.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace coach::qi {

/// Bytes or a signature from the other side that can't be what they claim to be.
class FormatError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Signature {
  char kind = 'v';                  ///< one of the letters above, or the opening bracket
  std::vector<Signature> children;  ///< of [ { ( + # ~
  std::vector<std::string> names;   ///< of an annotated tuple: its own name, then its members'

  /// Without annotations.
  std::string Text() const;
};

/// One complete signature. @throws FormatError if it is malformed, longer than 64 kB or nested deeper than 32.
Signature ParseSignature(std::string_view text);

}  // namespace coach::qi
