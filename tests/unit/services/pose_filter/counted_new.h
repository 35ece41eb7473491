// Counts every operator new of the executable it is linked into.
#pragma once

#include <cstdint>

namespace coach {

struct CountedNew {
  int64_t calls = 0;
  int64_t bytes = 0;
};
CountedNew NewSoFar();

}  // namespace coach
