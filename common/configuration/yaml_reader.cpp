#include "common/configuration/yaml_reader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <type_traits>

namespace coach {

struct YamlNode::Impl {
  YAML::Node node;
  std::string file;
  std::string key;                                        ///< from the root: parts[0].hsv.low
  std::set<std::string> asked;                            ///< keys of this map that were asked for
  std::map<std::string, std::shared_ptr<Impl>> children;  ///< so that every view of a map shares `asked`

  std::string Place() const {
    const YAML::Mark mark = node.Mark();
    return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
  }
  std::string Name() const { return key.empty() ? "the document" : key; }
  std::shared_ptr<Impl> Child(const std::string& name, const YAML::Node& child) {
    std::shared_ptr<Impl>& entry = children[name];
    if (!entry) entry = std::make_shared<Impl>(Impl{child, file, name, {}, {}});
    return entry;
  }
};

namespace {

std::string Shorten(std::string text) {
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

void RejectDuplicateKeys(const YAML::Node& map, const std::string& place, const std::string& key) {
  std::set<std::string> seen;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) throw ConfigurationError(place + ": " + key + ": found a key that is no plain text");
    if (!seen.insert(entry.first.Scalar()).second)
      throw ConfigurationError(place + ": " + key + ": found the key '" + entry.first.Scalar() +
                               "' twice, expected it once");
  }
}

template <class T>
const char* Expected() {
  if constexpr (std::is_same_v<T, bool>) return "true or false";
  if constexpr (std::is_same_v<T, double>) return "a finite number";
  if constexpr (std::is_integral_v<T>) return "a whole number";
  return "a text";
}

template <class T>
bool IsGood(const T& value) {
  if constexpr (std::is_same_v<T, double>) return std::isfinite(value);
  return true;
}

}  // namespace

YamlNode YamlNode::Load(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw ConfigurationError(file.string() + ": is a folder, not a file");
  std::ifstream in(file);
  if (!in) throw ConfigurationError(file.string() + ": can't be opened");
  std::stringstream text;
  text << in.rdbuf();
  return Parse(text.str(), file.string());
}

YamlNode YamlNode::Parse(const std::string& text, const std::string& name) {
  try {
    const YAML::Node node = YAML::Load(text);
    return YamlNode(std::make_shared<Impl>(Impl{node, name, "", {}, {}}));
  } catch (const YAML::Exception& e) {
    throw ConfigurationError(name + ":" + std::to_string(e.mark.line + 1) + ": no YAML: " + e.msg);
  }
}

template <class T>
T YamlNode::As() const {
  if (!impl_->node.IsScalar()) Fail(Expected<T>());
  try {
    T value = impl_->node.as<T>();
    if (IsGood(value)) return value;
  } catch (const YAML::Exception&) {
  }
  Fail(Expected<T>());
}
template bool YamlNode::As<bool>() const;
template int YamlNode::As<int>() const;
template int64_t YamlNode::As<int64_t>() const;
template double YamlNode::As<double>() const;
template std::string YamlNode::As<std::string>() const;

namespace {
template <class T>
std::vector<T> ListOf(const YamlNode& node) {
  std::vector<T> out;
  for (const YamlNode& item : node.Items()) out.push_back(item.As<T>());
  return out;
}
}  // namespace
template <>
std::vector<int> YamlNode::As() const {
  return ListOf<int>(*this);
}
template <>
std::vector<double> YamlNode::As() const {
  return ListOf<double>(*this);
}
template <>
std::vector<std::string> YamlNode::As() const {
  return ListOf<std::string>(*this);
}

double YamlNode::GetInRange(const std::string& key, double otherwise, double low, double high) const {
  const double value = Get<double>(key, otherwise);
  if (!(value >= low && value <= high)) {
    std::ostringstream expected;
    expected << "a number from " << low << " to " << high;
    At(key).Fail(expected.str());
  }
  return value;
}

std::string YamlNode::GetChoice(const std::string& key, const std::string& otherwise,
                                const std::vector<std::string>& choices) const {
  std::string value = Get<std::string>(key, otherwise);
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
    std::string expected;
    for (const std::string& choice : choices) expected += (expected.empty() ? "" : ", ") + choice;
    At(key).Fail("one of " + expected);
  }
  return value;
}

bool YamlNode::Has(const std::string& key) const { return Find(key).has_value(); }

YamlNode YamlNode::At(const std::string& key) const {
  const std::optional<YamlNode> node = Find(key);
  if (node) return *node;
  const std::string full = impl_->key.empty() ? key : impl_->key + "." + key;
  throw ConfigurationError(Place() + ": " + full + ": found nothing, expected this key");
}

std::optional<YamlNode> YamlNode::Find(const std::string& key) const {
  if (!impl_->node.IsMap()) Fail("a map of keys and values");
  if (impl_->asked.empty()) RejectDuplicateKeys(impl_->node, Place(), impl_->Name());
  impl_->asked.insert(key);
  const YAML::Node& constant = impl_->node;  // operator[] of a non-const node would insert
  const YAML::Node child = constant[key];
  if (!child.IsDefined()) return std::nullopt;
  return YamlNode(impl_->Child(impl_->key.empty() ? key : impl_->key + "." + key, child));
}

std::vector<YamlNode> YamlNode::Items() const {
  std::vector<YamlNode> out;
  if (impl_->node.IsNull()) return out;
  if (!impl_->node.IsSequence()) Fail("a list");
  for (size_t i = 0; i < impl_->node.size(); ++i)
    out.push_back(YamlNode(impl_->Child(impl_->key + "[" + std::to_string(i) + "]", impl_->node[i])));
  return out;
}

std::vector<std::pair<std::string, YamlNode>> YamlNode::Entries() const {
  if (!impl_->node.IsMap()) Fail("a map of keys and values");
  RejectDuplicateKeys(impl_->node, Place(), impl_->Name());
  std::vector<std::pair<std::string, YamlNode>> out;
  for (const auto& entry : impl_->node) {
    const std::string& key = entry.first.Scalar();
    impl_->asked.insert(key);
    out.emplace_back(key, YamlNode(impl_->Child(impl_->key.empty() ? key : impl_->key + "." + key, entry.second)));
  }
  return out;
}

bool YamlNode::IsMap() const { return impl_->node.IsMap(); }
bool YamlNode::IsScalar() const { return impl_->node.IsScalar(); }
bool YamlNode::IsNull() const { return impl_->node.IsNull(); }

void YamlNode::RejectUnknownKeys() const {
  if (!impl_->node.IsMap()) Fail("a map of keys and values");
  for (const auto& entry : impl_->node) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    if (impl_->asked.contains(key)) continue;
    std::string expected;
    for (const std::string& known : impl_->asked) expected += (expected.empty() ? "" : ", ") + known;
    const std::string full = impl_->key.empty() ? key : impl_->key + "." + key;
    throw ConfigurationError(impl_->file + ":" + std::to_string(entry.first.Mark().line + 1) + ": " + full +
                             ": found an unknown key, expected one of " + expected);
  }
}

std::string YamlNode::Place() const { return impl_->Place(); }

std::string YamlNode::Text() const {
  if (impl_->node.IsNull()) return "nothing";
  if (impl_->node.IsScalar()) return std::string("'").append(Shorten(impl_->node.Scalar())).append("'");
  YAML::Emitter out;
  out.SetMapFormat(YAML::Flow);
  out.SetSeqFormat(YAML::Flow);
  out << impl_->node;
  return Shorten(out.c_str());
}

void YamlNode::Fail(const std::string& found, const std::string& expected) const {
  throw ConfigurationError(Place() + ": " + impl_->Name() + ": found " + found + ", expected " + expected);
}

}  // namespace coach
