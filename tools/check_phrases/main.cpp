// coach-check-phrases: every key, placeholder, number and length of phrase files, rendered for the given tasks.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/phrase_book.h"

int main(int argc, char** argv) {
  CLI::App app("Checks phrase files: all kinds, enough wordings, placeholders, singular and plural, length");
  std::vector<std::string> files, task_files;
  int least = 6;
  bool print = false;
  app.add_option("files", files, "phrase files")->required()->check(CLI::ExistingFile);
  app.add_option("--task", task_files, "task files whose parts are named")->check(CLI::ExistingFile);
  app.add_option("--least", least, "wordings a kind")->check(CLI::Range(1, 100));
  app.add_flag("--print", print, "print every wording as it is said about the first task's first connection");
  CLI11_PARSE(app, argc, argv);
  int problems = 0;
  try {
    std::vector<coach::Task> tasks;
    std::vector<const coach::Task*> pointers;
    for (const std::string& file : task_files) tasks.push_back(coach::LoadTask(file, {.read_meshes = false}));
    for (const coach::Task& task : tasks) pointers.push_back(&task);
    for (const std::string& file : files) {
      const coach::PhraseBook book = coach::PhraseBook::Load(file);
      for (const std::string& problem : book.Problems(pointers, least)) {
        std::printf("%s: %s\n", file.c_str(), problem.c_str());
        ++problems;
      }
      if (!print || tasks.empty() || tasks[0].connections.empty()) continue;
      const coach::Connection& c = tasks[0].connections[0];
      const coach::PhraseValues values{tasks[0].slots[c.slot_a].type, tasks[0].slots[c.slot_b].type, 3, 90};
      for (const coach::PhraseKind& kind : coach::PhraseKinds()) {
        std::printf("\n%s\n", kind.key.c_str());
        for (int w = 0; w < book.Wordings(kind.key); ++w) {
          for (const bool plural : {false, true})
            std::printf("  %s %s\n", plural ? "*" : "1", book.Render(tasks[0], kind.key, w, values, plural).c_str());
        }
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "coach-check-phrases: %s\n", error.what());
    return 2;
  }
  if (problems == 0) std::printf("%zu phrase files: no problem\n", files.size());
  return problems == 0 ? 0 : 1;
}
