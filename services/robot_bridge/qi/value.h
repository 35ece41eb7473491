// A value of the qi type system, whatever its width on the wire.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace coach::qi {

struct Value;
using List = std::vector<Value>;

/// Ordered as on the wire.
struct Map {
  std::vector<std::pair<Value, Value>> items;
};
struct Tuple {
  List members;
};
/// A remote object handed over as a value: its address on the connection it came by, and its MetaObject.
struct Object {
  List meta_object;  ///< one value: the MetaObject's tuple
  uint32_t service = 0, object = 0;
};

/// Bytes that need not be text (`r`).
struct Raw {
  std::string bytes;
};

struct Value {
  /// monostate: void, or an empty optional. Integers of every width; unsigned 64-bit ones keep their bits.
  std::variant<std::monostate, bool, int64_t, double, std::string, Raw, List, Map, Tuple, Object> data;

  Value() = default;
  Value(bool value) : data(value) {}                      // NOLINT(google-explicit-constructor)
  Value(int value) : data(int64_t{value}) {}              // NOLINT(google-explicit-constructor)
  Value(int64_t value) : data(value) {}                   // NOLINT(google-explicit-constructor)
  Value(uint32_t value) : data(int64_t{value}) {}         // NOLINT(google-explicit-constructor)
  Value(double value) : data(value) {}                    // NOLINT(google-explicit-constructor)
  Value(const char* value) : data(std::string(value)) {}  // NOLINT(google-explicit-constructor)
  Value(std::string value) : data(std::move(value)) {}    // NOLINT(google-explicit-constructor)
  Value(Raw value) : data(std::move(value)) {}            // NOLINT(google-explicit-constructor)
  Value(List value) : data(std::move(value)) {}           // NOLINT(google-explicit-constructor)
  Value(Map value) : data(std::move(value)) {}            // NOLINT(google-explicit-constructor)
  Value(Tuple value) : data(std::move(value)) {}          // NOLINT(google-explicit-constructor)
  Value(Object value) : data(std::move(value)) {}         // NOLINT(google-explicit-constructor)

  template <class T>
  const T* As() const {
    return std::get_if<T>(&data);
  }
  bool empty() const { return data.index() == 0; }
  /// Any number or bool as double; otherwise `otherwise`.
  double Number(double otherwise = 0) const;
  int64_t Integer(int64_t otherwise = 0) const;
  /// Text of `s` or bytes of `r`; else empty.
  std::string Text() const;
  /// Members of a list or a tuple; else empty.
  const List& Items() const;
  /// Value of a text key of a map; else nothing.
  const Value* Find(const std::string& key) const;
};

}  // namespace coach::qi
