#pragma once

#include <cstddef>
#include <span>
#include <vector>

/// Fewer points that look the same: a screen is some 2000 pixels wide, an hour at 50 Hz is 180 000 samples.
namespace veridyn::report {

/// Points of a line that stand for all of them, in order.
struct Polyline {
  std::vector<double> x;
  std::vector<double> y;
};

/// Keeps first and last sample and, in each of equal buckets of samples, the smallest and the largest value, at their
/// own abscissae. A run of NaN inside becomes one NaN (a gap stays a gap, however short). Returned as it is when not
/// longer than `limit`; otherwise at most `limit` points, plus those of gaps when a line is mostly gaps.
/// Cost: one pass. `x` increasing, sizes equal, `limit` >= 8.
[[nodiscard]] Polyline decimate_line(std::span<const double> x, std::span<const double> y, std::size_t limit);

/// A band with fewer points, each the extremes of a bucket of samples.
struct DecimatedBand {
  std::vector<double> x;
  std::vector<double> low;
  std::vector<double> high;
};

/// The envelope of a band: per bucket of samples its lowest low and its highest high, at the bucket's middle and, so
/// that the ends meet those of the line, at the very first and last abscissa. Never narrower than the band. A bucket
/// with a gap ends the piece before it.
[[nodiscard]] DecimatedBand decimate_band(std::span<const double> x, std::span<const double> low,
                                          std::span<const double> high, std::size_t limit);

/// Points of a scatter, thinned to one per cell of a fine grid over their range (a marker covers several cells), with a
/// coarser grid until at most `limit` are left; the extremes in x and y are always kept. Points with a NaN go. In
/// order.
[[nodiscard]] Polyline thin_scatter(std::span<const double> x, std::span<const double> y, std::size_t limit);

}  // namespace veridyn::report
