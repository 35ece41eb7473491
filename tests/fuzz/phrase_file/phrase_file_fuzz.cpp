// Fuzzes the reader of phrase files; every wording of a file that is accepted is spoken.
#include "common/configuration/yaml_reader.h"
#include "services/assembly_reasoner/phrase_book.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  coach::Task task;
  task.types.emplace_back();
  task.types.back().name = "long";
  task.types.back().colour = "blue";
  try {
    const auto book = coach::PhraseBook::Load(ScratchFile("phrases.yaml", data, size));
    book.Problems({&task});
    for (const auto& kind : coach::PhraseKinds()) {
      for (int wording = 0; wording < book.Wordings(kind.key); ++wording) {
        for (const bool plural : {false, true}) book.Render(task, kind.key, wording, {0, 0, 2, 90}, plural);
      }
    }
  } catch (const coach::ConfigurationError&) {
    // the only answer to a file that is wrong
  }
  return 0;
}
