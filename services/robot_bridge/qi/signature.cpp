#include "services/robot_bridge/qi/signature.h"

namespace coach::qi {
namespace {

constexpr size_t kLongest = 65536;
constexpr int kDeepest = 32;
constexpr std::string_view kPlain = "bcCwWiIlLfdsrvmoX";

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Signature Parse() {
    Signature signature = ParseOne(0);
    if (at_ != text_.size()) Fail("more after its end");
    return signature;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw FormatError("signature '" + std::string(text_.substr(0, 80)) + "': " + what);
  }
  char Next() {
    if (at_ >= text_.size()) Fail("ends too early");
    return text_[at_++];
  }
  bool Peek(char c) const { return at_ < text_.size() && text_[at_] == c; }

  Signature ParseOne(int depth) {
    if (depth > kDeepest) Fail("nested too deeply");
    Signature signature;
    signature.kind = Next();
    switch (signature.kind) {
      case '[':
        signature.children.push_back(ParseOne(depth + 1));
        Close(']');
        break;
      case '{':
        signature.children.push_back(ParseOne(depth + 1));
        signature.children.push_back(ParseOne(depth + 1));
        Close('}');
        break;
      case '(':
        while (!Peek(')')) signature.children.push_back(ParseOne(depth + 1));
        Close(')');
        break;
      case '+':
      case '#':
      case '~':
        signature.children.push_back(ParseOne(depth + 1));
        break;
      default:
        if (kPlain.find(signature.kind) == std::string_view::npos) Fail("unknown type");
    }
    if (Peek('<')) ParseAnnotation(signature);
    return signature;
  }

  void Close(char bracket) {
    if (Next() != bracket) Fail(std::string("no '") + bracket + "'");
  }

  void ParseAnnotation(Signature& signature) {
    std::string name;
    int open = 0;
    for (;;) {
      const char c = Next();
      if (c == '<' && ++open == 1) continue;
      if (c == '>' && --open == 0) break;
      if (c == ',' && open == 1) {
        signature.names.push_back(name);
        name.clear();
      } else {
        name += c;
      }
    }
    signature.names.push_back(name);
  }

  std::string_view text_;
  size_t at_ = 0;
};

}  // namespace

Signature ParseSignature(std::string_view text) {
  if (text.size() > kLongest) throw FormatError("signature of " + std::to_string(text.size()) + " bytes");
  return Parser(text).Parse();
}

std::string Signature::Text() const {
  std::string text(1, kind);
  for (const Signature& child : children) text += child.Text();
  if (kind == '[') text += ']';
  if (kind == '{') text += '}';
  if (kind == '(') text += ')';
  return text;
}

}  // namespace coach::qi
