#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace veridyn::numerics {

/// A reproducible stream of random numbers: same seed and name, same numbers, on every machine and compiler.
///
/// Streams of different names (or numbers) under one seed are independent for all practical purposes, so that every
/// sensor, task or thread has one to itself: switching one off, or another number of threads, leaves the others
/// unchanged. The engine is the 64-bit Mersenne twister, whose output the C++ standard fixes; distributions are
/// Boost's, because those of the standard library differ between implementations.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);
  RandomStream(std::uint64_t seed, std::uint64_t number);

  /// From the standard normal distribution.
  [[nodiscard]] double normal();
  /// From the uniform distribution on [0, 1).
  [[nodiscard]] double uniform();
  /// From the uniform distribution on [low, high).
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// A whole number from 0 to count - 1, each equally likely; count >= 1.
  [[nodiscard]] std::uint64_t index(std::uint64_t count);

 private:
  std::mt19937_64 engine_;
};

}  // namespace veridyn::numerics
