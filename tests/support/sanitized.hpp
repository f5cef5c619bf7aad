#pragma once

namespace veridyn::test {

/// Whether this is built with the sanitizers (VERIDYN_SANITIZE): everything takes some twenty times as long, and memory
/// says in a tenth of the steps what it says in all.
#ifdef VERIDYN_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace veridyn::test
