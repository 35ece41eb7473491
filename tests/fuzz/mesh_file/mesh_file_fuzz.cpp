// Fuzzes the reader of meshes (PLY); a mesh that is accepted is measured and sampled.
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "common/geometry/mesh.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const coach::TriangleMesh mesh = coach::ReadMesh(ScratchFile("a.ply", data, size), 0.001);
    if (!std::isfinite(coach::Extent(mesh).diameter) || !std::isfinite(coach::SignedVolume(mesh))) std::abort();
    for (const auto& point : coach::SampleSurface(mesh, 20)) {
      if (!point.p.allFinite() || !point.n.allFinite()) std::abort();
    }
  } catch (const std::runtime_error&) {
    // the only answer to a file that is wrong
  }
  return 0;
}
