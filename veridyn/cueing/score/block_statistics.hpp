#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace veridyn::cueing {

/// A figure with its 95 % interval; ends NaN where there are too few blocks for one.
struct Measured {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// Agreement of two signals, from sums over blocks of the drive, so that the blocks may be resampled: x(t - lag)
/// against y(t) on an even grid. Neighbouring samples depend on each other; blocks of many seconds hardly do.
class BlockStatistics {
 public:
  static constexpr double kBlock = 10.0;                     ///< [s]
  static constexpr double kFirstLag = -0.5, kLastLag = 3.0;  ///< that are tried [s]
  static constexpr std::size_t kFewestBlocks = 4;            ///< for an interval

  /// Of no signals: no blocks, and figures that are NaN.
  BlockStatistics() = default;
  /// @param x what is to be rendered @param y what was @param step of the grid [s]
  /// @param noticed a deviation above it is counted
  BlockStatistics(std::span<const double> x, std::span<const double> y, double step, double noticed);

  [[nodiscard]] std::size_t blocks() const { return blocks_; }

  /// Figures of a choice of blocks, each with how often it is in it.
  struct Figures {
    double rmse = 0.0;
    double pearson = 0.0;  ///< of the signals as they are; NaN where one does not move
    double lag = 0.0;      ///< with the largest correlation [s]
    double at_lag = 0.0;   ///< that correlation
    double above = 0.0;    ///< share of time with a deviation above what is noticed
  };
  [[nodiscard]] Figures figures(std::span<const double> weights) const;
  [[nodiscard]] Figures figures() const;

 private:
  struct Sums {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  };
  [[nodiscard]] static double correlation(const Sums& s);

  std::size_t blocks_ = 0, lags_ = 0, no_lag_ = 0;
  double step_ = 0.0;
  std::vector<Sums> sums_;  ///< by block, then by lag
  std::vector<double> squares_, above_, samples_;
};

/// Figures of blocks resampled with replacement (Efron & Tibshirani 1993), the same draws for the same
/// number of blocks and seed: two algorithms on one drive are compared draw by draw.
/// @param figures puts `count` figures of a choice of blocks where it is told
/// @return NaN ends with fewer than `BlockStatistics::kFewestBlocks` blocks
[[nodiscard]] std::vector<Measured> bootstrapped(
    std::size_t blocks, std::uint64_t seed, std::size_t count,
    const std::function<void(std::span<const double> weights, std::span<double> figures)>& figures);

}  // namespace veridyn::cueing
