#include "common/configuration/yaml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>

namespace coach {
namespace {

std::string ErrorOf(const std::function<void()>& f) {
  try {
    f();
  } catch (const ConfigurationError& e) {
    return e.what();
  }
  return "no error";
}

TEST(YamlReader, ReadsValuesAndDefaults) {
  const YamlNode root = YamlNode::Parse("a: 1\nb: {c: [1.5, 2], d: yes}\ne: text\n", "f");
  EXPECT_EQ(root.Get<int>("a"), 1);
  EXPECT_EQ(root.Get<std::string>("e"), "text");
  EXPECT_EQ(root.Get<int64_t>("missing", 7), 7);
  EXPECT_THAT(root.At("b").Get<std::vector<double>>("c"), testing::ElementsAre(1.5, 2.0));
  EXPECT_TRUE(root.At("b").Get<bool>("d"));
  EXPECT_NO_THROW(root.RejectUnknownKeys());
  EXPECT_NO_THROW(root.At("b").RejectUnknownKeys());
}

TEST(YamlReader, NamesFileLineKeyFoundExpected) {
  const YamlNode root = YamlNode::Parse("a: 1\nb:\n  c: [1, x]\n  d: .nan\n", "task.yaml");
  EXPECT_EQ(ErrorOf([&] { root.At("b").Get<std::vector<double>>("c"); }),
            "task.yaml:3: b.c[1]: found 'x', expected a finite number");
  EXPECT_EQ(ErrorOf([&] { root.At("b").Get<double>("d"); }),
            "task.yaml:4: b.d: found '.nan', expected a finite number");
  EXPECT_EQ(ErrorOf([&] { root.Get<int>("z"); }), "task.yaml:1: z: found nothing, expected this key");
  EXPECT_EQ(ErrorOf([&] { root.Get<int>("b"); }),
            "task.yaml:3: b: found {c: [1, x], d: .nan}, expected a whole number");
  EXPECT_EQ(ErrorOf([&] { root.GetChoice("a", "x", {"x", "y"}); }), "task.yaml:1: a: found '1', expected one of x, y");
  EXPECT_EQ(ErrorOf([&] { root.GetInRange("a", 0, 2, 3); }),
            "task.yaml:1: a: found '1', expected a number from 2 to 3");
}

TEST(YamlReader, UnknownAndDoubleKeysAreErrors) {
  const YamlNode root = YamlNode::Parse("a: 1\ncolor: red\n", "f");
  root.Get<int>("a");
  EXPECT_EQ(ErrorOf([&] { root.RejectUnknownKeys(); }), "f:2: color: found an unknown key, expected one of a");
  EXPECT_THAT(ErrorOf([] { YamlNode::Parse("a: 1\na: 2\n", "f").Get<int>("a"); }),
              testing::HasSubstr("the key 'a' twice"));
}

TEST(YamlReader, UnreadableFilesAreErrors) {
  EXPECT_EQ(ErrorOf([] { YamlNode::Load("/nowhere/x.yaml"); }), "/nowhere/x.yaml: can't be opened");
  EXPECT_THAT(ErrorOf([] { YamlNode::Load("/tmp"); }), testing::HasSubstr("is a folder"));
  EXPECT_THAT(ErrorOf([] { YamlNode::Parse("a: [1, 2\nb: }", "f"); }), testing::StartsWith("f:2: no YAML: "));
  EXPECT_THAT(ErrorOf([] { YamlNode::Parse("- 1\n", "f").Get<int>("a"); }), testing::HasSubstr("a map of keys"));
}

}  // namespace
}  // namespace coach
