#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace veridyn::vehicle {

/// The four wheels in the order of every per-wheel array: front left, front right, rear left, rear right.
enum Wheel : std::size_t { kFrontLeft, kFrontRight, kRearLeft, kRearRight };
inline constexpr std::size_t kWheels = 4;
inline constexpr std::array<std::string_view, kWheels> kWheelNames{"fl", "fr", "rl", "rr"};

template <typename T>
using PerWheel = std::array<T, kWheels>;

[[nodiscard]] constexpr bool is_front(std::size_t wheel) { return wheel < 2; }
[[nodiscard]] constexpr bool is_left(std::size_t wheel) { return wheel % 2 == 0; }

/// The wheel opposite on the same axle.
[[nodiscard]] constexpr std::size_t mirrored(std::size_t wheel) { return wheel ^ 1U; }

}  // namespace veridyn::vehicle
