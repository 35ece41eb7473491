// Values to and from bytes, as a signature tells.
#pragma once

#include <string>
#include <string_view>

#include "services/robot_bridge/qi/signature.h"
#include "services/robot_bridge/qi/value.h"

namespace coach::qi {

/// The MetaObject's signature, as it stands before an object's address.
extern const char* const kMetaObjectSignature;

/// The value as `signature` wants it; numbers change their width, texts become raw where that is asked for.
/// @throws FormatError if it can't be that.
std::string Encode(const Signature& signature, const Value& value);

/// Whether, and how well, a value can become what the signature says: 0 not at all, else the more the closer.
int Fitness(const Signature& signature, const Value& value);

/// The value of the signature that the bytes begin with; they must hold nothing more.
/// Bounded: nesting 32, a million elements in all, never more elements than bytes could hold.
/// @throws FormatError
Value Decode(const Signature& signature, std::string_view bytes);

/// What a value is called inside a dynamic value: lists of equal elements are typed, floats are 32 bit.
std::string NaturalSignature(const Value& value);

}  // namespace coach::qi
