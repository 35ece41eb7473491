// Fuzzes the reader of task files. Meshes that a file names must exist; they are not read.
#include "common/assembly/task_file.h"
#include "common/configuration/yaml_reader.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const bool mesh = (ScratchFile("a.ply", data, 0), true);
  (void)mesh;
  try {
    coach::LoadTask(ScratchFile("task.yaml", data, size), {.read_meshes = false});
  } catch (const coach::ConfigurationError&) {
    // the only answer to a file that is wrong
  }
  return 0;
}
