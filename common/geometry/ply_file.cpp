#include "common/geometry/ply_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace coach {
namespace {

[[noreturn]] void Refuse(const std::string& what) { throw std::runtime_error(what); }

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

Scalar ScalarNamed(const std::string& name) {
  static const std::map<std::string, Scalar> names{
      {"char", Scalar::kInt8},     {"int8", Scalar::kInt8},     {"uchar", Scalar::kUint8},
      {"uint8", Scalar::kUint8},   {"short", Scalar::kInt16},   {"int16", Scalar::kInt16},
      {"ushort", Scalar::kUint16}, {"uint16", Scalar::kUint16}, {"int", Scalar::kInt32},
      {"int32", Scalar::kInt32},   {"uint", Scalar::kUint32},   {"uint32", Scalar::kUint32},
      {"float", Scalar::kFloat},   {"float32", Scalar::kFloat}, {"double", Scalar::kDouble},
      {"float64", Scalar::kDouble}};
  const auto found = names.find(name);
  if (found == names.end()) Refuse("unknown type '" + name + "'");
  return found->second;
}

struct Property {
  std::string name;
  Scalar type = Scalar::kFloat;
  bool is_list = false;
  Scalar count_type = Scalar::kUint8;  ///< of a list
};

struct Element {
  std::string name;
  size_t count = 0;
  std::vector<Property> properties;
};

/// The numbers of the file's body, one after the other.
class Body {
 public:
  enum class Format { kAscii, kLittleEndian, kBigEndian };
  Body(Format format, const std::string& text, size_t begin) : format_(format), text_(text), at_(begin) {}

  size_t rest() const { return text_.size() - at_; }

  double Next(Scalar type) {
    if (format_ == Format::kAscii) return NextWord();
    switch (type) {
      case Scalar::kInt8:
        return Binary<int8_t>();
      case Scalar::kUint8:
        return Binary<uint8_t>();
      case Scalar::kInt16:
        return Binary<int16_t>();
      case Scalar::kUint16:
        return Binary<uint16_t>();
      case Scalar::kInt32:
        return Binary<int32_t>();
      case Scalar::kUint32:
        return Binary<uint32_t>();
      case Scalar::kFloat:
        return Binary<float>();
      case Scalar::kDouble:
        return Binary<double>();
    }
    Refuse("unknown type");
  }

  /// A whole number in [0, limit].
  size_t NextCount(Scalar type, size_t limit, const char* what) {
    const double value = Next(type);
    if (!(value >= 0 && value <= static_cast<double>(limit)) || value != std::floor(value)) Refuse(what);
    return static_cast<size_t>(value);
  }

 private:
  double NextWord() {
    static constexpr char kSpace[] = " \t\r\n\v\f";
    const size_t begin = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
    at_ = std::min(text_.find_first_of(kSpace, begin), text_.size());
    if (begin == at_) Refuse("the file is cut off");
    const size_t digits = begin + (text_[begin] == '+' ? 1 : 0);
    double value = 0;
    const auto [end, error] = std::from_chars(text_.data() + digits, text_.data() + at_, value);
    if (error != std::errc() || end != text_.data() + at_)
      Refuse("'" + text_.substr(begin, std::min<size_t>(at_ - begin, 20)) + "' is no number");
    return value;
  }

  template <class T>
  T Binary() {
    if (rest() < sizeof(T)) Refuse("the file is cut off");
    uint8_t bytes[sizeof(T)];
    std::memcpy(bytes, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if ((format_ == Format::kBigEndian) != (std::endian::native == std::endian::big))
      std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  Format format_;
  const std::string& text_;
  size_t at_;
};

Property ParseProperty(std::istringstream& words) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    property.is_list = true;
    words >> type;
    property.count_type = ScalarNamed(type);
    words >> type;
  }
  property.type = ScalarNamed(type);
  words >> property.name;
  return property;
}

struct Header {
  Body::Format format = Body::Format::kAscii;
  std::vector<Element> elements;
  size_t end = 0;  ///< where the body begins
};

Body::Format FormatNamed(const std::string& name) {
  if (name == "ascii") return Body::Format::kAscii;
  if (name == "binary_little_endian") return Body::Format::kLittleEndian;
  if (name == "binary_big_endian") return Body::Format::kBigEndian;
  Refuse("unknown format '" + name + "'");
}

Header ParseHeader(const std::string& text) {
  Header header;
  for (size_t at = 0; header.end == 0;) {
    const size_t end = text.find('\n', at);
    if (end == std::string::npos) Refuse("no PLY file, or its header is cut off");
    std::istringstream words(text.substr(at, end - at));
    std::string key, name;
    words >> key;
    if (at == 0 && key != "ply") Refuse("no PLY file");
    at = end + 1;
    if (key == "format") {
      words >> name;
      header.format = FormatNamed(name);
    } else if (key == "element") {
      Element& element = header.elements.emplace_back();
      words >> element.name >> element.count;
      // Every one of an element's instances takes a byte or more.
      if (!words || element.count > text.size()) Refuse("more elements '" + element.name + "' than the file can hold");
    } else if (key == "property") {
      if (header.elements.empty()) Refuse("a property without element");
      header.elements.back().properties.push_back(ParseProperty(words));
    } else if (key == "end_header") {
      header.end = at;
    }
  }
  return header;
}

void ReadVertex(Body& body, const Element& element, TriangleMesh& mesh) {
  Vector3 v = Vector3::Zero();
  for (const Property& property : element.properties) {
    if (property.is_list) Refuse("a list in a vertex");
    const double value = body.Next(property.type);
    if (property.name == "x") v.x() = value;
    if (property.name == "y") v.y() = value;
    if (property.name == "z") v.z() = value;
  }
  mesh.vertices.push_back(v);
}

void ReadOther(Body& body, const Element& element, TriangleMesh& mesh) {
  for (const Property& property : element.properties) {
    const size_t count =
        property.is_list ? body.NextCount(property.count_type, body.rest(), "a list is longer than the file") : 1;
    const bool face = element.name == "face" && property.is_list &&
                      (property.name == "vertex_indices" || property.name == "vertex_index");
    std::vector<int> polygon;
    for (size_t i = 0; i < count; ++i) {
      if (face) {
        if (mesh.vertices.empty()) Refuse("a face before the vertices");
        polygon.push_back(static_cast<int>(
            body.NextCount(property.type, mesh.vertices.size() - 1, "a face names a vertex that does not exist")));
      } else {
        body.Next(property.type);
      }
    }
    for (size_t i = 2; i < polygon.size(); ++i) mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
}

}  // namespace

TriangleMesh ReadPly(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  if (!in) Refuse("can't be read");
  const std::string text = bytes.str();
  const Header header = ParseHeader(text);
  Body body(header.format, text, header.end);
  TriangleMesh mesh;
  for (const Element& element : header.elements) {
    if (element.properties.empty() && element.count > 0) Refuse("element '" + element.name + "' without properties");
    for (size_t i = 0; i < element.count; ++i) {
      if (element.name == "vertex") {
        ReadVertex(body, element, mesh);
      } else {
        ReadOther(body, element, mesh);
      }
    }
  }
  return mesh;
}

}  // namespace coach
