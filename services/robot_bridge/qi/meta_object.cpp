#include "services/robot_bridge/qi/meta_object.h"

#include <algorithm>

#include "services/robot_bridge/qi/codec.h"

namespace coach::qi {
namespace {

/// How well the arguments fit; 0: they don't.
int FitnessOf(const MetaMethod& method, const List& arguments) {
  const auto& parameters = method.parameters.children;
  if (method.parameters.kind != '(' || parameters.size() != arguments.size()) return 0;
  int sum = 1;
  for (size_t i = 0; i < arguments.size(); ++i) {
    const int fitness = Fitness(parameters[i], arguments[i]);
    if (fitness == 0) return 0;
    sum += fitness;
  }
  return sum;
}

std::optional<Signature> TryParse(const std::string& text) {
  try {
    return ParseSignature(text);
  } catch (const FormatError&) {
    return std::nullopt;
  }
}

const Value& Member(const Value& value, size_t index) {
  if (index >= value.Items().size()) throw FormatError("a MetaObject with members missing");
  return value.Items()[index];
}

}  // namespace

const MetaMethod* MetaObject::Resolve(const std::string& name, const List& arguments) const {
  const MetaMethod* best = nullptr;
  int best_fitness = 0;
  for (const MetaMethod& method : methods) {
    if (method.name != name) continue;
    const int fitness = FitnessOf(method, arguments);
    if (fitness > best_fitness || (fitness == best_fitness && best != nullptr && method.id < best->id)) {
      best = &method;
      best_fitness = fitness;
    }
  }
  return best;
}

const MetaSignal* MetaObject::FindSignal(const std::string& name) const {
  const auto found =
      std::find_if(signals.begin(), signals.end(), [&](const MetaSignal& signal) { return signal.name == name; });
  return found == signals.end() ? nullptr : &*found;
}

MetaObject MetaObjectOf(const Value& value) {
  MetaObject meta;
  if (const auto* methods = Member(value, 0).As<Map>()) {
    for (const auto& [key, item] : methods->items) {
      const auto returned = TryParse(Member(item, 1).Text());
      const auto parameters = TryParse(Member(item, 3).Text());
      if (!returned || !parameters) continue;
      meta.methods.push_back(
          {static_cast<uint32_t>(Member(item, 0).Integer()), Member(item, 2).Text(), *parameters, *returned});
    }
  }
  if (const auto* signals = Member(value, 1).As<Map>()) {
    for (const auto& [key, item] : signals->items) {
      const auto parameters = TryParse(Member(item, 2).Text());
      if (!parameters) continue;
      meta.signals.push_back({static_cast<uint32_t>(Member(item, 0).Integer()), Member(item, 1).Text(), *parameters});
    }
  }
  return meta;
}

ServiceInfo ServiceInfoOf(const Signature& signature, const Value& value) {
  const auto member = [&](const std::string& name, size_t otherwise) -> const Value& {
    // names[0] is the tuple's own.
    const auto found = std::find(signature.names.begin(), signature.names.end(), name);
    const bool named = found != signature.names.end() && found != signature.names.begin();
    return Member(value, named ? static_cast<size_t>(found - signature.names.begin()) - 1 : otherwise);
  };
  ServiceInfo info;
  info.id = static_cast<uint32_t>(member("serviceId", 1).Integer());
  for (const Value& endpoint : member("endpoints", 4).Items()) {
    info.endpoints.push_back(endpoint.Items().empty() ? endpoint.Text() : endpoint.Items()[0].Text());
  }
  return info;
}

}  // namespace coach::qi
