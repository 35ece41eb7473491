#include "counted_new.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<int64_t> calls{0}, bytes{0};

void* Counted(size_t n, size_t alignment) {
  ++calls;
  bytes += static_cast<int64_t>(n);
  const size_t whole = (std::max<size_t>(n, 1) + alignment - 1) / alignment * alignment;
  if (void* p = std::aligned_alloc(alignment, whole)) return p;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(size_t n) { return Counted(n, alignof(std::max_align_t)); }
void* operator new(size_t n, std::align_val_t alignment) { return Counted(n, static_cast<size_t>(alignment)); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, size_t, std::align_val_t) noexcept { std::free(p); }

namespace coach {

CountedNew NewSoFar() { return {calls, bytes}; }

}  // namespace coach
