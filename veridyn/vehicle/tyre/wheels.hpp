#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace veridyn::vehicle {

/// The four wheels in the order of every per-wheel array: front left, front right, rear left, rear right.
enum Wheel : std::size_t { kFrontLeft, kFrontRight, kRearLeft, kRearRight };
/// How many wheels there are.
inline constexpr std::size_t kWheels = 4;
/// Front left, front right, rear left, rear right.
inline constexpr std::array<std::string_view, kWheels> kWheelNames{"fl", "fr", "rl", "rr"};

/// One for each wheel.
template <typename T>
using PerWheel = std::array<T, kWheels>;

/// Whether a wheel is of the front axle.
[[nodiscard]] constexpr bool is_front(std::size_t wheel) { return wheel < 2; }
/// Whether a wheel is on the left.
[[nodiscard]] constexpr bool is_left(std::size_t wheel) { return wheel % 2 == 0; }

/// The wheel opposite on the same axle.
[[nodiscard]] constexpr std::size_t mirrored(std::size_t wheel) { return wheel ^ 1U; }

}  // namespace veridyn::vehicle
