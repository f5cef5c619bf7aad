#pragma once

// Both are in every program that is linked with the address or the thread sanitizer.
extern "C" [[gnu::weak]] void __asan_init();  // NOLINT
extern "C" [[gnu::weak]] void __tsan_init();  // NOLINT

namespace veridyn::test {

/// Whether this runs under the sanitizers: what they look at takes some twenty times as long, and memory says in a
/// tenth of the steps what it says in all. Tests of readers are the same objects with and without them
/// (veridyn_sanitized_tests).
inline const bool kSanitized = __asan_init != nullptr || __tsan_init != nullptr;

}  // namespace veridyn::test
