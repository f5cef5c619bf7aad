#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

// Replaces operator new of the whole program by one that counts its calls: for one file of a test binary only. Under
// the thread sanitizer, which has its own, nothing is counted: `make tsan` leaves those tests out.
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define VERIDYN_NOT_COUNTED
#endif
#endif

namespace {
std::atomic<long> allocations{0};
}

#ifndef VERIDYN_NOT_COUNTED
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size > 0 ? size : 1)) return p;
  throw std::bad_alloc();
}
// The standard library's temporary buffers ask for memory this way and give it back to the operator delete below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size > 0 ? size : 1);
}
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // both are replaced
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#pragma GCC diagnostic pop
#endif
