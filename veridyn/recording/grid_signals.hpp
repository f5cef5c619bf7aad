#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/resample.hpp"
#include "veridyn/recording/channel_map.hpp"

namespace veridyn::recording {

/// Where a signal's error comes from.
enum class ErrorKind {
  kExact,      ///< no error worth naming
  kClassical,  ///< measured = true + error, error independent of the true value: biases least squares, belongs into W
  kBerkson,    ///< true = estimate + error, error independent of the estimate: widens the residual, biases nothing
};

/// One signal on the common grid.
struct GridSignal {
  std::vector<double> value;  ///< NaN where missing; empty when the recording has none
  double sigma = 0.0;         ///< standard deviation of the error of one sample
  double rate_Hz = 0.0;       ///< of the sensor: slower than the grid, its noise is not white there; 0: not known
  ErrorKind error = ErrorKind::kExact;
  std::string origin;  ///< "filtered vane", "steering_wheel / 16"
  [[nodiscard]] bool available() const { return !value.empty(); }
};

/// The signals of a domain (an enumeration of `kCount` values from 0) on one uniform grid.
template <typename Signal, std::size_t kCount>
struct GridSignals {
  numerics::UniformGrid grid;
  EnumArray<Signal, GridSignal, kCount> signals;
  std::vector<std::string> notes;  ///< what was assumed or taken off, in words

  [[nodiscard]] const GridSignal& operator[](Signal s) const { return signals[s]; }
  [[nodiscard]] GridSignal& operator[](Signal s) { return signals[s]; }
  [[nodiscard]] std::size_t size() const { return grid.count; }
  /// First and one-past-last grid index inside a span.
  [[nodiscard]] std::pair<std::size_t, std::size_t> indices(const TimeSpan& span) const;
};

/// First and one-past-last index of the grid's moments inside a span; a moment on its border (to a millionth of a step)
/// is inside.
[[nodiscard]] std::pair<std::size_t, std::size_t> grid_indices(const numerics::UniformGrid& grid, const TimeSpan& span);

template <typename Signal, std::size_t kCount>
std::pair<std::size_t, std::size_t> GridSignals<Signal, kCount>::indices(const TimeSpan& span) const {
  return grid_indices(grid, span);
}

/// The highest rate of a grid where none is given [Hz]; rigid-body motion needs no more.
inline constexpr double kHighestGridRate_Hz = 100.0;
/// The most moments of a grid: more than 27 h at 100 Hz. A recording that needs more has its stamps in another unit.
inline constexpr std::size_t kLongestGrid = 10'000'000;

/// The rate of the grid for a channel: `chosen_Hz` where it is > 0, else that of the channel, rounded to whole Hz, at
/// most kHighestGridRate_Hz.
[[nodiscard]] double grid_rate(const Channel& reference, double chosen_Hz = 0.0);

/// The grid over the whole of a channel.
/// @param place names the recording in messages
/// @throws InputError when it would have more than kLongestGrid moments: naming the duration and the key
/// `[data.time] unit`.
[[nodiscard]] numerics::UniformGrid grid_over(const Channel& reference, double rate_Hz, std::string_view place);

/// From which distance on neighbouring samples leave a hole between them.
enum class Holes {
  kOfTheSensor,    ///< more than 5 median intervals
  kOfHalfASecond,  ///< more than 0.5 s, or 3 median intervals of a sensor slower than 6 Hz
};

/// A channel on a grid; NaN in its holes.
[[nodiscard]] std::vector<double> on_grid(const Channel& channel, const numerics::UniformGrid& grid,
                                          Holes holes = Holes::kOfHalfASecond,
                                          numerics::Interpolation interpolation = numerics::Interpolation::kPchip);

/// A channel of angles [rad], which may jump by a turn: unwrapped before it is interpolated.
[[nodiscard]] std::vector<double> angle_on_grid(const Channel& channel, const numerics::UniformGrid& grid,
                                                Holes holes = Holes::kOfHalfASecond);

/// Standard deviation of the white noise of one sample, without the tail of the signal itself, which falls at least
/// with the square of the frequency (as turbulence does): the mean of A/f^2 from f to the Nyquist frequency N is
/// A/(f N), so the levels S above two frequencies, one twice the other, give the floor, 2 S(2 f) - S(f). Noise that is
/// not white but falls towards high frequencies would come out negative: the lower of the two levels then.
/// Uses what lies above 0.2 of `rate_Hz`; 0 for fewer than 32 samples in a row.
[[nodiscard]] double noise_floor(std::span<const double> values, double rate_Hz);

/// The same for a channel, of its samples as recorded: interpolated ones have less noise. Where rows are lost all over,
/// by differences of those that follow each other. 0 for a channel without a rate.
[[nodiscard]] double noise_floor(const Channel& channel);

/// Standard deviations of white noise per sample that the user gives, by standard channel name. Table
/// `[signals.noise]`.
using GivenNoise = std::vector<std::pair<std::string, double>>;

/// Reads one standard deviation for each of `channels` that the table names.
/// @throws InputError for values that are not > 0 or of another kind of unit.
[[nodiscard]] GivenNoise read_noise(const StudyTable& table, std::span<const StandardChannel> channels);

/// The key `noise` of a table `[signals]`, of which `read_noise` reads what it holds.
[[nodiscard]] StudyKey noise_key(std::string otherwise);

/// What was given for a channel, if anything.
[[nodiscard]] std::optional<double> given_noise(const GivenNoise& given, std::string_view channel);

}  // namespace veridyn::recording
