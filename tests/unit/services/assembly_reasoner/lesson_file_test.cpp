#include "services/assembly_reasoner/lesson_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "services/assembly_reasoner/lesson_configuration.h"

namespace coach {
namespace {

TEST(LessonFile, MemoryReturnsAsItWas) {
  LessonMemory m;
  m.session = 1234567890123;
  m.task = std::string(3, 'c');
  m.language = std::string(2, 'e');
  m.begun = true;
  m.assembly.variant = 1;
  m.assembly.joints.push_back({0, 2, 1, 3, -1, 10, 20, true});
  m.policy.phase = Phase::kIdle;
  m.policy.idle_level = 2;
  m.policy.corrections[{1, 0, 2}] = 3;
  m.skipped = {4};
  m.last_event = 77;
  m.last_command = 9;
  const LessonMemory back = LessonMemoryFromJson(ToJson(m));
  EXPECT_EQ(ToJson(back), ToJson(m));
  EXPECT_EQ(back.assembly.joints[0].connection, 3);
  EXPECT_EQ(back.policy.corrections.at({1, 0, 2}), 3);
}

TEST(LessonFile, DamagedMemoryIsAnErrorNotACrash) {
  for (const char* text : {"", "{", "[]", "{}", R"({"version": 2})", R"({"version": 1, "session": "x"})"})
    EXPECT_THROW(LessonMemoryFromJson(text), std::invalid_argument) << text;
}

TEST(LessonFile, WritesTheWholeFileOrNone) {
  const auto file = std::filesystem::path(testing::TempDir()) / "lesson_state.json";
  EXPECT_FALSE(ReadText(file.string() + ".missing"));
  WriteAtomically(file, "one");
  WriteAtomically(file, "two");
  EXPECT_EQ(*ReadText(file), "two");
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
  EXPECT_THROW(WriteAtomically("/nowhere/x", "three"), std::runtime_error);
}

TEST(LessonFile, EventsAreOneLineEach) {
  GuidanceEvent e;
  e.kind = "say";
  e.reason = "line\nbreak \xff";
  EXPECT_EQ(ToJsonLine(e).find('\n'), std::string::npos);
}

TEST(LessonConfiguration, ReadsAndRefuses) {
  const auto read = [](const std::string& text) {
    return ReadLessonConfiguration(YamlNode::Parse(text, "station.yaml"), "/station");
  };
  const auto c = read(
      "language: el\ngroup: true\nphrases: words\nresponses: {correct_hold: 3}\nspeech: {pause: 1}\n"
      "connections: {model: paper, undo_hold: 0.3}\n");
  EXPECT_EQ(c.options.language, "el");
  EXPECT_EQ(c.phrases, "/station/words");
  EXPECT_EQ(c.options.response.correct_hold, 3);
  EXPECT_TRUE(c.options.reasoner.paper);
  EXPECT_THROW(read("langauge: el\n"), ConfigurationError);
  EXPECT_THROW(read("responses: {correct_hold: -1}\n"), ConfigurationError);
  EXPECT_THROW(read("responses: {idle: [25, 20, 70, 100]}\n"), ConfigurationError);
  EXPECT_THROW(LoadPhraseBooks("/nowhere"), ConfigurationError);
  EXPECT_EQ(LoadPhraseBooks(ShippedPhrases()).size(), 2u);
}

}  // namespace
}  // namespace coach
