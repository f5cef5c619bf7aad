#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

namespace veridyn {

/// A value for each enumerator of an enumeration that counts from 0 to below `kCount`: an array that takes the
/// enumerator, or its number in loops over all.
template <typename Enum, typename T, std::size_t kCount>
requires std::is_enum_v<Enum>
struct EnumArray : std::array<T, kCount> {
  using std::array<T, kCount>::operator[];
  [[nodiscard]] constexpr T& operator[](Enum which) { return (*this)[static_cast<std::size_t>(which)]; }
  [[nodiscard]] constexpr const T& operator[](Enum which) const { return (*this)[static_cast<std::size_t>(which)]; }
};

/// The enumerators of an enumeration that counts from 0 to below `kCount`, in order, for loops over all of them:
/// `for (const Axis axis : enumerators<Axis, kAxes>())`.
template <typename Enum, std::size_t kCount>
requires std::is_enum_v<Enum>
[[nodiscard]] constexpr std::array<Enum, kCount> enumerators() {
  std::array<Enum, kCount> all{};
  for (std::size_t i = 0; i < kCount; ++i) all[i] = static_cast<Enum>(i);
  return all;
}

}  // namespace veridyn
