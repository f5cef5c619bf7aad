#pragma once

namespace veridyn::test {

/// Whether this is built with the address sanitizer: everything takes some twenty times as long, and memory says in a
/// tenth of the steps what it says in all.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace veridyn::test
