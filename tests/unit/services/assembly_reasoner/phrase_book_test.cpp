#include "services/assembly_reasoner/phrase_book.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/assembly/task_file.h"
#include "common/configuration/yaml_reader.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
const fs::path kProject(COACH_SOURCE_DIR);

std::vector<Task> ShippedTasks() {
  std::vector<Task> tasks;
  for (const auto& entry : fs::directory_iterator(kProject / "deploy" / "tasks")) {
    if (entry.path().extension() == ".yaml") tasks.push_back(LoadTask(entry.path(), {.read_meshes = false}));
  }
  return tasks;
}

TEST(PhraseBook, ShippedFilesHaveNoProblem) {
  const std::vector<Task> tasks = ShippedTasks();
  std::vector<const Task*> pointers;
  for (const Task& task : tasks) pointers.push_back(&task);
  for (const char* language : {"en", "el"}) {
    const PhraseBook book = PhraseBook::Load(kProject / "deploy" / "phrases" / (std::string(language) + ".yaml"));
    EXPECT_EQ(book.language(), language);
    EXPECT_THAT(book.Problems(pointers), testing::IsEmpty());
    for (const PhraseKind& kind : PhraseKinds()) {
      for (int w = 0; w < book.Wordings(kind.key); ++w) {
        for (const bool plural : {false, true}) {
          const std::string text = book.Render(tasks[0], kind.key, w, {0, 1, 2, 90}, plural);
          EXPECT_EQ(text.find_first_of("{}[]|"), std::string::npos) << text;
          EXPECT_EQ(text.find("  "), std::string::npos) << text;
        }
      }
    }
  }
}

TEST(PhraseBook, WordsAgreeInGenderCaseAndNumber) {
  const PhraseBook greek = PhraseBook::Load(kProject / "deploy" / "phrases" / "el.yaml");
  const Task car = LoadTask(kProject / "deploy" / "tasks" / "car.yaml", {.read_meshes = false});
  EXPECT_EQ(greek.Render(car, "step", 0, {0, 2}, false),
            "Ας ενώσουμε την κόκκινη βάση του αυτοκινήτου και την κίτρινη ρόδα.");
  EXPECT_EQ(greek.Render(car, "step", 5, {0, 2}, false),
            "Τα επόμενα δύο που πάνε μαζί είναι η κόκκινη βάση του αυτοκινήτου και η κίτρινη ρόδα.");
  const Task square = LoadTask(kProject / "deploy" / "tasks" / "square.yaml", {.read_meshes = false});
  EXPECT_EQ(greek.Render(square, "step", 1, {0, 1}, true),
            "Τώρα ενώστε το μακρύ μπλε τουβλάκι με το μεσαίο πράσινο τουβλάκι, παρακαλώ.");
  const PhraseBook english = PhraseBook::Load(kProject / "deploy" / "phrases" / "en.yaml");
  EXPECT_EQ(english.Render(square, "wrong", 0, {0, 0}, false),
            "Hm, the long blue brick and the other long blue brick don't go together like this. Try another pair.");
}

TEST(PhraseBook, MistakesInAFileAreFound) {
  const fs::path file = fs::path(testing::TempDir()) / "phrases.yaml";
  std::ifstream in(kProject / "deploy" / "phrases" / "en.yaml");
  const std::string good((std::istreambuf_iterator<char>(in)), {});
  const auto load_with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    std::ofstream(file) << text;
    return PhraseBook::Load(file);
  };
  EXPECT_THROW(load_with("  praise:", "  prise:"), ConfigurationError);
  EXPECT_THROW(load_with("noun: wheel", "noun: tyre"), ConfigurationError);
  EXPECT_THROW(load_with("size: long", "size: big"), ConfigurationError);
  const Task square = LoadTask(kProject / "deploy" / "tasks" / "square.yaml", {.read_meshes = false});
  const auto problems = [&](const std::string& from, const std::string& to) {
    return testing::PrintToString(load_with(from, to).Problems({&square}));
  };
  EXPECT_THAT(problems("\"Yes, that fits!\"", "\"Yes, {a.acc} fits!\""), testing::HasSubstr("placeholder {a.acc}"));
  EXPECT_THAT(problems("\"Yes, that fits!\"", "\"Yes, [that fits!\""), testing::HasSubstr("brackets"));
  EXPECT_THAT(problems("    - \"We skip this one.\"\n", ""), testing::HasSubstr("skipped: 5 wordings"));
  EXPECT_THAT(problems("  blue: blue\n", ""), testing::HasSubstr("the colour 'blue'"));
  EXPECT_THAT(problems("\"I wait here.\"", "\"" + std::string(401, 'x') + "\""), testing::HasSubstr("401 bytes"));
}

}  // namespace
}  // namespace coach
