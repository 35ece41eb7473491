#include "services/robot_bridge/qi/codec.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace coach::qi {

const char* const kMetaObjectSignature =
    "({I(Issss[(ss)<MetaMethodParameter,name,description>]s)<MetaMethod,uid,returnSignature,name,parametersSignature,"
    "description,parameters,returnDescription>}{I(Iss)<MetaSignal,uid,name,signature>}{I(Iss)<MetaProperty,uid,name,"
    "signature>}s)<MetaObject,methods,signals,properties,description>";

namespace {

constexpr int kDeepest = 32;
constexpr size_t kMostElements = 1000000;

struct IntegerType {
  size_t bytes;
  bool is_signed;
};

/// Width of an integer letter; 0 bytes: it is none.
IntegerType IntegerOf(char kind) {
  switch (kind) {
    case 'c':
      return {1, true};
    case 'C':
      return {1, false};
    case 'w':
      return {2, true};
    case 'W':
      return {2, false};
    case 'i':
      return {4, true};
    case 'I':
      return {4, false};
    case 'l':
      return {8, true};
    case 'L':
      return {8, false};
    default:
      return {0, false};
  }
}

bool InRange(const IntegerType& type, int64_t value) {
  if (type.bytes == 8) return true;
  const int64_t span = int64_t{1} << (8 * type.bytes);
  return type.is_signed ? value >= -span / 2 && value < span / 2 : value >= 0 && value < span;
}

template <class T>
void Put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);  // little endian, as every machine of ours
}

void PutSize(std::string& out, size_t size) {
  if (size > std::numeric_limits<uint32_t>::max()) throw FormatError("value too large");
  Put(out, static_cast<uint32_t>(size));
}

[[noreturn]] void Misfit(const Signature& signature) {
  throw FormatError("a value does not fit the signature '" + signature.Text() + "'");
}

void EncodeInto(std::string& out, const Signature& signature, const Value& value);

void EncodeMembers(std::string& out, const Signature& signature, const List& members) {
  if (members.size() != signature.children.size()) Misfit(signature);
  for (size_t i = 0; i < members.size(); ++i) EncodeInto(out, signature.children[i], members[i]);
}

void EncodeInteger(std::string& out, const Signature& signature, const IntegerType& type, const Value& value) {
  const bool whole = value.As<int64_t>() != nullptr || value.As<bool>() != nullptr ||
                     (value.As<double>() != nullptr && value.Number() == std::floor(value.Number()));
  const int64_t number = value.Integer();
  if (!whole || !InRange(type, number)) Misfit(signature);
  out.append(reinterpret_cast<const char*>(&number), type.bytes);
}

void EncodeInto(std::string& out, const Signature& signature, const Value& value) {
  if (const IntegerType type = IntegerOf(signature.kind); type.bytes != 0) {
    EncodeInteger(out, signature, type, value);
    return;
  }
  switch (signature.kind) {
    case 'v':
      return;
    case 'b':
      if (value.As<bool>() == nullptr && value.As<int64_t>() == nullptr) Misfit(signature);
      Put<uint8_t>(out, value.Integer() != 0 ? 1 : 0);
      return;
    case 'f':
    case 'd':
      if (value.As<double>() == nullptr && value.As<int64_t>() == nullptr) Misfit(signature);
      if (signature.kind == 'f') {
        Put(out, static_cast<float>(value.Number()));
      } else {
        Put(out, value.Number());
      }
      return;
    case 's':
    case 'r':
      if (value.As<std::string>() == nullptr && value.As<Raw>() == nullptr) Misfit(signature);
      PutSize(out, value.Text().size());
      out += value.Text();
      return;
    case '[':
      if (value.As<List>() == nullptr) Misfit(signature);
      PutSize(out, value.Items().size());
      for (const Value& item : value.Items()) EncodeInto(out, signature.children[0], item);
      return;
    case '{': {
      const auto* map = value.As<Map>();
      if (map == nullptr) Misfit(signature);
      PutSize(out, map->items.size());
      for (const auto& [key, item] : map->items) {
        EncodeInto(out, signature.children[0], key);
        EncodeInto(out, signature.children[1], item);
      }
      return;
    }
    case '(':
      if (value.As<Tuple>() == nullptr) Misfit(signature);
      EncodeMembers(out, signature, value.Items());
      return;
    case '+':
      Put<uint8_t>(out, value.empty() ? 0 : 1);
      if (!value.empty()) EncodeInto(out, signature.children[0], value);
      return;
    case 'm': {
      const std::string natural = NaturalSignature(value);
      PutSize(out, natural.size());
      out += natural;
      EncodeInto(out, ParseSignature(natural), value);
      return;
    }
    default:
      Misfit(signature);
  }
}

class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : bytes_(bytes) {}

  Value Read(const Signature& signature, int depth) {
    if (depth > kDeepest) throw FormatError("values nested too deeply");
    if (++elements_ > kMostElements) throw FormatError("too many values");
    if (const IntegerType type = IntegerOf(signature.kind); type.bytes != 0) return ReadInteger(type);
    switch (signature.kind) {
      case 'v':
        return {};
      case 'b':
        return Get<uint8_t>() != 0;
      case 'f':
        return static_cast<double>(Get<float>());
      case 'd':
        return Get<double>();
      case 's':
        return std::string(Take(Get<uint32_t>()));
      case 'r':
        return Raw{std::string(Take(Get<uint32_t>()))};
      case '[':
      case '#':
      case '~':
        return ReadList(signature.children[0], depth);
      case '{':
        return ReadMap(signature, depth);
      case '(': {
        Tuple tuple;
        for (const Signature& child : signature.children) tuple.members.push_back(Read(child, depth + 1));
        return tuple;
      }
      case '+':
        return Get<uint8_t>() != 0 ? Read(signature.children[0], depth + 1) : Value();
      case 'm':
        return Read(ParseSignature(Take(Get<uint32_t>())), depth + 1);
      case 'o': {
        static const Signature kMetaObject = ParseSignature(kMetaObjectSignature);
        Object object;
        object.meta_object.push_back(Read(kMetaObject, depth + 1));
        object.service = Get<uint32_t>();
        object.object = Get<uint32_t>();
        return object;
      }
      default:
        throw FormatError(std::string("a value of the unreadable type '") + signature.kind + "'");
    }
  }
  bool finished() const { return bytes_.empty(); }

 private:
  std::string_view Take(size_t size) {
    if (size > bytes_.size()) throw FormatError("the payload ends too early");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  template <class T>
  T Get() {
    T value;
    std::memcpy(&value, Take(sizeof value).data(), sizeof value);
    return value;
  }
  Value ReadInteger(const IntegerType& type) {
    uint64_t bits = 0;
    std::memcpy(&bits, Take(type.bytes).data(), type.bytes);
    const size_t unused = 64 - 8 * type.bytes;
    if (type.is_signed) return static_cast<int64_t>(bits << unused) >> unused;
    return static_cast<int64_t>(bits);
  }
  Value ReadList(const Signature& element, int depth) {
    List list;
    for (auto count = Get<uint32_t>(); count > 0; --count) list.push_back(Read(element, depth + 1));
    return list;
  }
  Value ReadMap(const Signature& signature, int depth) {
    Map map;
    for (auto count = Get<uint32_t>(); count > 0; --count) {
      Value key = Read(signature.children[0], depth + 1);
      map.items.emplace_back(std::move(key), Read(signature.children[1], depth + 1));
    }
    return map;
  }

  std::string_view bytes_;
  size_t elements_ = 0;
};

int FitnessOfNumber(const Signature& signature, const Value& value) {
  const IntegerType type = IntegerOf(signature.kind);
  if (value.As<double>() != nullptr) return signature.kind == 'f' || signature.kind == 'd' ? 8 : 0;
  if (value.As<bool>() != nullptr) return signature.kind == 'b' ? 8 : (type.bytes != 0 ? 2 : 0);
  if (type.bytes != 0) return InRange(type, value.Integer()) ? 8 : 0;
  return signature.kind == 'f' || signature.kind == 'd' ? 4 : (signature.kind == 'b' ? 2 : 0);
}

int FitnessOfAll(const Signature& element, const List& items, int best) {
  for (const Value& item : items) best = std::min(best, Fitness(element, item));
  return best;
}

}  // namespace

std::string Encode(const Signature& signature, const Value& value) {
  std::string out;
  EncodeInto(out, signature, value);
  return out;
}

int Fitness(const Signature& signature, const Value& value) {
  if (signature.kind == 'm') return 1;
  if (signature.kind == '+') return value.empty() ? 8 : Fitness(signature.children[0], value);
  if (value.As<bool>() || value.As<int64_t>() || value.As<double>()) return FitnessOfNumber(signature, value);
  if (value.As<std::string>()) return signature.kind == 's' ? 8 : (signature.kind == 'r' ? 2 : 0);
  if (value.As<Raw>()) return signature.kind == 'r' ? 8 : (signature.kind == 's' ? 2 : 0);
  if (const auto* list = value.As<List>()) {
    return signature.kind == '[' ? FitnessOfAll(signature.children[0], *list, 8) : 0;
  }
  if (const auto* map = value.As<Map>()) {
    if (signature.kind != '{') return 0;
    int best = 8;
    for (const auto& [key, item] : map->items) {
      best = std::min({best, Fitness(signature.children[0], key), Fitness(signature.children[1], item)});
    }
    return best;
  }
  if (const auto* tuple = value.As<Tuple>()) {
    if (signature.kind != '(' || signature.children.size() != tuple->members.size()) return 0;
    int best = 8;
    for (size_t i = 0; i < tuple->members.size(); ++i) {
      best = std::min(best, Fitness(signature.children[i], tuple->members[i]));
    }
    return best;
  }
  return signature.kind == 'v' && value.empty() ? 8 : 0;
}

Value Decode(const Signature& signature, std::string_view bytes) {
  Decoder decoder(bytes);
  Value value = decoder.Read(signature, 0);
  if (!decoder.finished())
    throw FormatError("bytes left over after a value of '" + signature.Text().substr(0, 80) + "'");
  return value;
}

std::string NaturalSignature(const Value& value) {
  const auto common = [](const List& items) {
    if (items.empty()) return std::string("m");
    const std::string first = NaturalSignature(items.front());
    const bool equal =
        std::all_of(items.begin(), items.end(), [&](const Value& item) { return NaturalSignature(item) == first; });
    return equal ? first : std::string("m");
  };
  if (value.As<bool>()) return "b";
  if (const auto* number = value.As<int64_t>()) return InRange({4, true}, *number) ? "i" : "l";
  if (value.As<double>()) return "f";
  if (value.As<std::string>()) return "s";
  if (value.As<Raw>()) return "r";
  if (const auto* list = value.As<List>()) return std::string("[").append(common(*list)).append("]");
  if (const auto* map = value.As<Map>()) {
    List keys, items;
    for (const auto& [key, item] : map->items) {
      keys.push_back(key);
      items.push_back(item);
    }
    return std::string("{").append(common(keys)).append(common(items)).append("}");
  }
  if (const auto* tuple = value.As<Tuple>()) {
    std::string text = "(";
    for (const Value& member : tuple->members) text += NaturalSignature(member);
    return text + ")";
  }
  if (value.As<Object>()) throw FormatError("objects can't be sent");
  return "v";
}

}  // namespace coach::qi
