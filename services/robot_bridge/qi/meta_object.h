// What a remote object can do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/robot_bridge/qi/signature.h"
#include "services/robot_bridge/qi/value.h"

namespace coach::qi {

struct MetaMethod {
  uint32_t id = 0;
  std::string name;
  Signature parameters;  ///< a tuple
  Signature returned;
};
struct MetaSignal {
  uint32_t id = 0;
  std::string name;
  Signature parameters;
};

struct MetaObject {
  std::vector<MetaMethod> methods;
  std::vector<MetaSignal> signals;

  /// The overload that these arguments fit best; of equals the one with the lower id. Nothing: none fits.
  const MetaMethod* Resolve(const std::string& name, const List& arguments) const;
  const MetaSignal* FindSignal(const std::string& name) const;
};

/// From its value on the wire. Members of unreadable signatures are left out. @throws FormatError
MetaObject MetaObjectOf(const Value& value);

/// What the service directory tells of a service.
struct ServiceInfo {
  uint32_t id = 0;
  std::vector<std::string> endpoints;  ///< tcp://host:port, tcps://host:port
};
/// @param signature the return signature that the directory advertises, with the members' names or without: six
/// members in NAOqi 2, seven later. @throws FormatError
ServiceInfo ServiceInfoOf(const Signature& signature, const Value& value);

}  // namespace coach::qi
