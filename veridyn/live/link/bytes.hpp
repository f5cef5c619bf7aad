#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace veridyn::live {

static_assert(std::endian::native == std::endian::little, "packets and recordings are little-endian");

/// The number at an offset. The caller has made sure that it lies within.
template <typename T>
requires std::is_trivially_copyable_v<T>
[[nodiscard]] T number_at(std::string_view bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Writes a number at an offset.
template <typename T>
requires std::is_trivially_copyable_v<T>
void put_at(std::span<char> bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

}  // namespace veridyn::live
