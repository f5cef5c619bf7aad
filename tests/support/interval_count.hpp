#pragma once

#include <cstddef>
#include <vector>

#include "veridyn/estimation/result/parameter.hpp"

namespace veridyn::test {

/// What became of many intervals of 95 % whose truth is known.
class IntervalCount {
 public:
  /// Whether the interval holds the truth.
  bool add(const estimation::Parameter& parameter, double truth);

  [[nodiscard]] std::size_t intervals() const { return ranks_.size(); }
  [[nodiscard]] std::size_t held() const { return held_; }
  [[nodiscard]] std::size_t identified() const { return identified_; }
  /// Identified, more than 10 % off and outside of the interval.
  [[nodiscard]] std::size_t wrong() const { return wrong_; }
  /// Share of intervals that hold the truth.
  [[nodiscard]] double coverage() const;
  /// Medians, as shares of a truth that is not 0.
  [[nodiscard]] double median_error() const;
  [[nodiscard]] double median_half_width() const;
  /// Chi-square of the ranks in ten equal bins, nine degrees of freedom if parameters were independent. Ranks are those
  /// of the normal distribution that the interval of 95 % belongs to.
  [[nodiscard]] double rank_chi_square() const;

 private:
  std::size_t held_ = 0, identified_ = 0, wrong_ = 0;
  std::vector<double> ranks_, widths_, errors_;
};

}  // namespace veridyn::test
