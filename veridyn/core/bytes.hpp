#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace veridyn {

namespace internal {
/// The unsigned integer that holds the bits of a number, of an enumeration its number's.
template <typename T>
[[nodiscard]] constexpr auto bits_of(T value) {
  if constexpr (std::is_enum_v<T>) {
    return bits_of(static_cast<std::underlying_type_t<T>>(value));
  } else if constexpr (std::is_floating_point_v<T>) {
    static_assert(sizeof(T) == 4 || sizeof(T) == 8);
    return std::bit_cast<std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>(value);
  } else {
    return static_cast<std::make_unsigned_t<T>>(value);
  }
}
}  // namespace internal

/// Writes a number, or an enumeration's, least significant byte first, whatever the machine's own order. The caller
/// sees to it that it lies within.
template <typename T, typename Byte, std::size_t kExtent>
requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) constexpr void put_at(std::span<Byte, kExtent> bytes,
                                                                             std::size_t offset, T value) {
  auto rest = static_cast<std::uint64_t>(internal::bits_of(value));
  for (std::size_t i = 0; i < sizeof(T); ++i, rest >>= 8U) bytes[offset + i] = static_cast<Byte>(rest & 0xFFU);
}

/// The number at an offset, written as above. The caller has made sure that it lies within.
template <typename T, typename Byte>
requires std::is_arithmetic_v<T>
[[nodiscard]] constexpr T number_at(std::span<const Byte> bytes, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
    value |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(bytes[offset + i])) << (8U * i);
  using Bits = decltype(internal::bits_of(T{}));
  if constexpr (std::is_floating_point_v<T>) {
    return std::bit_cast<T>(static_cast<Bits>(value));
  } else {
    return static_cast<T>(static_cast<Bits>(value));
  }
}
/// The same of a text's bytes.
template <typename T>
[[nodiscard]] constexpr T number_at(std::string_view bytes, std::size_t offset) {
  return number_at<T>(std::span<const char>(bytes), offset);
}

/// The number that lies at `from`, aligned or not, as this machine stores numbers, or with its bytes in the opposite
/// order.
template <typename T>
requires std::is_arithmetic_v<T>
[[nodiscard]] T load_number(const char* from, bool swapped = false) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (swapped) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

/// Reads numbers (least significant byte first) and runs of bytes one after the other. Nothing is read past the end:
/// a number is then zero, a run what is left, and `failed()` says so from there on.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <typename T>
  T number() {
    if (rest_.size() < sizeof(T)) {
      failed_ = true;
      rest_ = {};
      return T{};
    }
    const T value = number_at<T>(rest_, 0);
    rest_.remove_prefix(sizeof(T));
    return value;
  }
  std::string_view bytes(std::uint64_t size) {
    if (size > rest_.size()) {
      failed_ = true;
      size = rest_.size();
    }
    const std::string_view part = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return part;
  }
  /// With its length before it.
  template <typename Length>
  std::string_view text() {
    return bytes(number<Length>());
  }
  [[nodiscard]] bool ended() const { return rest_.empty(); }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  std::string_view rest_;
  bool failed_ = false;
};

}  // namespace veridyn
