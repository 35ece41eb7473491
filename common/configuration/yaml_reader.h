// Checked reading of YAML: every mistake is reported as "file:line: key: found X, expected Y", unknown keys included.
//
//   const YamlNode root = YamlNode::Load("station.yaml");
//   options.rate = root.Get<double>("rate", 30.0);         // optional
//   options.name = root.Get<std::string>("name");          // required
//   for (const YamlNode& item : root.At("parts").Items()) ...
//   root.RejectUnknownKeys();                              // after all keys have been asked for
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace coach {

/// A configuration file that can't be used; what() is the whole message.
class ConfigurationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One place in a YAML document. Cheap to copy; every copy of a node shares the list of keys that were asked for.
/// Every function throws ConfigurationError.
class YamlNode {
 public:
  static YamlNode Load(const std::filesystem::path& file);
  /// @param name what to call the text in messages
  static YamlNode Parse(const std::string& text, const std::string& name);

  /// The value. T is bool, int, int64_t, double (finite), std::string, or a vector of int, double or std::string.
  template <class T>
  T As() const;

  /// The value of a key of this map.
  template <class T>
  T Get(const std::string& key) const {
    return At(key).As<T>();
  }
  /// The same, `otherwise` if the key is missing.
  template <class T>
  T Get(const std::string& key, const T& otherwise) const {
    const std::optional<YamlNode> node = Find(key);
    return node ? node->As<T>() : otherwise;
  }
  /// A number that must lie in [low, high].
  double GetInRange(const std::string& key, double otherwise, double low, double high) const;
  /// A text that must be one of `choices`.
  std::string GetChoice(const std::string& key, const std::string& otherwise,
                        const std::vector<std::string>& choices) const;

  bool Has(const std::string& key) const;
  YamlNode At(const std::string& key) const;
  std::optional<YamlNode> Find(const std::string& key) const;
  std::vector<YamlNode> Items() const;                            ///< of a list; an empty value is an empty list
  std::vector<std::pair<std::string, YamlNode>> Entries() const;  ///< of a map, in the file's order
  bool IsMap() const;
  bool IsScalar() const;
  bool IsNull() const;  ///< an empty document or value

  /// @throws if this map has a key that was never asked for by Get, At, Find or Has.
  void RejectUnknownKeys() const;

  /// "file:line"
  std::string Place() const;
  /// The node as it stands in the file, shortened to 60 characters.
  std::string Text() const;
  /// @throws ConfigurationError "file:line: key: found FOUND, expected EXPECTED"
  [[noreturn]] void Fail(const std::string& found, const std::string& expected) const;
  /// The same with the node's own text as what was found.
  [[noreturn]] void Fail(const std::string& expected) const { Fail(Text(), expected); }

 private:
  struct Impl;
  explicit YamlNode(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<Impl> impl_;
};

}  // namespace coach
