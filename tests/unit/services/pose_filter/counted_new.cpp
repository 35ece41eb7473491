#include "counted_new.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<int64_t> calls{0}, bytes{0};

void* Counted(size_t n, size_t alignment) noexcept {
  ++calls;
  bytes += static_cast<int64_t>(n);
  const size_t whole = (std::max<size_t>(n, 1) + alignment - 1) / alignment * alignment;
  return std::aligned_alloc(alignment, whole);
}

void* CountedOrThrow(size_t n, size_t alignment) {
  if (void* p = Counted(n, alignment)) return p;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(size_t n) { return CountedOrThrow(n, alignof(std::max_align_t)); }
void* operator new(size_t n, const std::nothrow_t&) noexcept { return Counted(n, alignof(std::max_align_t)); }
void* operator new(size_t n, std::align_val_t alignment) { return CountedOrThrow(n, static_cast<size_t>(alignment)); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, size_t, std::align_val_t) noexcept { std::free(p); }

namespace coach {

CountedNew NewSoFar() { return {calls, bytes}; }

}  // namespace coach
