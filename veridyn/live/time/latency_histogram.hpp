#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// How long something took, many times: counts in bins that grow by a twentieth of a decade (12 %) from 100 ns to 100
/// s. Nothing is allocated.
class LatencyHistogram {
 public:
  static constexpr int kPerDecade = 20;
  static constexpr std::size_t kBins =
      9 * kPerDecade + 2;  ///< the first holds what is shorter, the last what is longer

  /// Below zero counts as zero.
  void add(Nanoseconds time);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Nanoseconds largest() const { return largest_; }
  /// Mean [s]; NaN without any.
  [[nodiscard]] double mean() const;
  /// What this share of all does not exceed [s]: the upper edge of its bin, or the largest; NaN without any.
  /// @param share in (0, 1]
  [[nodiscard]] double quantile(double share) const;
  [[nodiscard]] const std::array<std::uint64_t, kBins>& bins() const { return bins_; }
  /// Upper edge of a bin [s]; infinite of the last.
  [[nodiscard]] static double upper_edge(std::size_t bin);

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  Nanoseconds largest_ = 0;
  double sum_ = 0.0;  ///< [s]
};

}  // namespace veridyn::live
