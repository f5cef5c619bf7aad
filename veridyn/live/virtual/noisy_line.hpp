#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "veridyn/live/serial/little_endian.hpp"
#include "veridyn/live/time/clock.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {

/// A line that flips each byte with the same probability, one byte independent of the other: to any other value, or in
/// one bit only.
class FlippedBytes {
 public:
  /// @param probability above 0 and below 1
  FlippedBytes(double probability, std::uint64_t seed, bool single_bits = false);

  /// @return how many were flipped
  std::size_t damage(std::span<std::uint8_t> bytes);

 private:
  /// Bytes left whole before the next flipped one: geometrically distributed.
  [[nodiscard]] std::size_t gap();

  double probability_;
  bool single_bits_;
  numerics::RandomStream random_;
  std::size_t next_ = 0;
};

/// One direction of a serial line, on a time that is given: ten bits a byte, one byte after the other, some flipped.
class NoisyLine {
 public:
  /// @param flipped share of the bytes; 0: none @param baud [bit/s]
  NoisyLine(double flipped, std::uint64_t seed, int baud = 250'000);

  void send(Bytes bytes, Nanoseconds now);
  /// What has arrived by then, each byte once.
  [[nodiscard]] std::vector<std::uint8_t> arrived(Nanoseconds now);
  /// When the last byte that is on its way arrives; nothing where none is.
  [[nodiscard]] std::optional<Nanoseconds> last_arrival() const;

  bool cut = false;       ///< nothing that is sent arrives
  Nanoseconds delay = 0;  ///< beyond the time that the bits take

 private:
  double flipped_;
  Nanoseconds byte_;
  FlippedBytes damage_;
  Nanoseconds free_at_ = 0, last_arrival_ = 0;
  std::deque<std::pair<Nanoseconds, std::uint8_t>> on_the_way_;
};

}  // namespace veridyn::live
