#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "veridyn/numerics/random.hpp"

namespace veridyn::live::testing {

/// A line that flips each byte with the same probability, one byte independent of the other: to any other value, or in
/// one bit only.
class FlippedBytes {
 public:
  FlippedBytes(double probability, std::uint64_t seed, bool single_bits = false)
      : probability_(probability), single_bits_(single_bits), random_(seed, "line") {
    next_ = gap();
  }

  /// @return how many were flipped
  std::size_t damage(std::span<std::uint8_t> bytes) {
    std::size_t flipped = 0;
    while (next_ < bytes.size()) {
      bytes[next_] ^= static_cast<std::uint8_t>(single_bits_ ? 1U << random_.index(8) : 1 + random_.index(255));
      ++flipped;
      next_ += 1 + gap();
    }
    next_ -= bytes.size();
    return flipped;
  }

 private:
  /// Bytes left whole before the next flipped one: geometrically distributed.
  std::size_t gap() { return static_cast<std::size_t>(std::log1p(-random_.uniform()) / std::log1p(-probability_)); }

  double probability_;
  bool single_bits_;
  numerics::RandomStream random_;
  std::size_t next_ = 0;
};

}  // namespace veridyn::live::testing
