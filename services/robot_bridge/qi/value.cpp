#include "services/robot_bridge/qi/value.h"

namespace coach::qi {

double Value::Number(double otherwise) const {
  if (const auto* value = As<double>()) return *value;
  if (const auto* value = As<int64_t>()) return static_cast<double>(*value);
  if (const auto* value = As<bool>()) return *value ? 1 : 0;
  return otherwise;
}

int64_t Value::Integer(int64_t otherwise) const {
  if (const auto* value = As<int64_t>()) return *value;
  if (const auto* value = As<bool>()) return *value ? 1 : 0;
  if (const auto* value = As<double>(); value && *value > -9e18 && *value < 9e18) return static_cast<int64_t>(*value);
  return otherwise;
}

std::string Value::Text() const {
  if (const auto* value = As<std::string>()) return *value;
  if (const auto* value = As<Raw>()) return value->bytes;
  return "";
}

const List& Value::Items() const {
  static const List kNone;
  if (const auto* list = As<List>()) return *list;
  if (const auto* tuple = As<Tuple>()) return tuple->members;
  return kNone;
}

const Value* Value::Find(const std::string& key) const {
  if (const auto* map = As<Map>()) {
    for (const auto& [name, value] : map->items) {
      if (name.Text() == key) return &value;
    }
  }
  return nullptr;
}

}  // namespace coach::qi
