#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/resample.hpp"

namespace veridyn::recording {

/// Channels of one sensor, which are late together.
struct DelayGroup {
  std::string name;  ///< "gps", the key of the study
  std::vector<std::string> channels;
};

/// How sensors are brought onto one clock. Study table `[delays]`.
struct DelayOptions {
  bool automatic = true;  ///< false: only what the study gives
  double max_delay_s = 0.3;
  double min_delay_s = 0.01;
  double band_Hz = 4.0;
  std::vector<std::pair<std::string, double>> given;  ///< by the name of the group [s]

  /// With a key for each of the groups.
  [[nodiscard]] static KeyTable<DelayOptions> keys(const std::vector<DelayGroup>& groups);
  [[nodiscard]] std::optional<double> given_for(std::string_view group) const;
};

/// A delay that is another by another comparison.
struct OtherDelay {
  std::string reference;
  double delay_s = 0.0;
  double sigma_s = 0.0;
};

/// What a comparison says of a delay.
enum class DelayFinding {
  kApplied,          ///< determined, and taken off
  kGiven,            ///< by the study, and taken off
  kSmall,            ///< determined, too small to matter
  kBeforeCause,      ///< determined, but an effect before its cause: left alone
  kOppositeSign,     ///< the group moves against what its reference implies; from here on it is not determined
  kWide,             ///< within a range in which it may matter or not
  kInDoubt,          ///< `delay_s` fits best, but more of the effect is unexplained than the cause explains
  kLittleExplained,  ///< the cause explains too little
  kNoneAsGood,       ///< no delay fits as well
  kNoOptimum,        ///< no lag inside the search is best
  kNoPeak,           ///< the cross-correlation has no peak: see `why`
  kAtEnd,            ///< it still rises at the end of the search
  kSlow,             ///< the group has fewer samples than kSlowestDelayed_Hz
  kInterrupted       ///< the search was
};

/// How late a group of channels is, against what.
struct DelayReport {
  std::string group;      ///< "attitude"
  std::string reference;  ///< "gyro"
  double delay_s = 0.0;   ///< positive: the group reports late
  double sigma_s = 0.0;
  double correlation = 0.0;
  DelayFinding finding = DelayFinding::kNoOptimum;
  std::string_view kind = "cause";  ///< of group, in sentences: "surface"
  std::string_view why = {};        ///< of kNoPeak, in words
  /// Groups that move together and were given one delay, this one among them; empty: it was searched alone.
  std::vector<std::string> together = {};
  /// A second comparison that determines it too, and differs by more than three standard errors of both.
  std::optional<OtherDelay> contradicted_by = {};

  /// Whether it was taken off the stamps, or is to be.
  [[nodiscard]] bool applied() const { return finding == DelayFinding::kApplied || finding == DelayFinding::kGiven; }
  /// Whether the comparison says how late the group is, be it not at all.
  [[nodiscard]] bool determined() const { return finding < DelayFinding::kOppositeSign; }
};

/// What was found, in words: "applied", or why not.
[[nodiscard]] std::string says(const DelayReport& report);

/// The longest part of a recording that is searched [s]. A delay is one number: the middle quarter of an hour of a
/// longer recording determines it.
inline constexpr double kLongestDelaySearch_s = 900.0;
/// The slowest sensor whose delay is searched [Hz]. The filter that its samples need grows with their distance.
inline constexpr double kSlowestDelayed_Hz = 0.5;

/// A delay that is not determined to this may bias what is estimated by several percent [s].
inline constexpr double kDelayMatters_s = 0.03;

/// Channels on one grid, low-passed at a band's edge, and their derivatives, all by zero-phase filters; NaN in holes.
class BandLimited {
 public:
  using Series = std::vector<double>;

  /// The middle of `reference` (see kLongestDelaySearch_s) at its rate; nothing where it is slower than four times
  /// the band or lasts less than 10 s: it can then be no clock for others.
  [[nodiscard]] static std::optional<BandLimited> around(const Channel& reference, double band_Hz);

  [[nodiscard]] Series raw(const Channel& channel) const;
  [[nodiscard]] Series smooth(const Channel& channel) const { return numerics::filter(raw(channel), smooth_); }
  [[nodiscard]] Series derivative(const Channel& channel) const {
    return numerics::filter(raw(channel), differentiate_);
  }
  /// The same for angles, which may jump by a turn.
  [[nodiscard]] Series smooth_angle(const Channel& channel) const;
  [[nodiscard]] Series angle_derivative(const Channel& channel) const;

  /// Variance of the white noise of a channel that is left in `smooth`, as its content above the band shows it.
  [[nodiscard]] double noise_variance(const Channel& channel) const;

  /// The low-pass and the differentiator for another band [Hz], for signals slower than the others.
  [[nodiscard]] std::pair<numerics::FirKernel, numerics::FirKernel> kernels(double band_Hz) const;

  [[nodiscard]] std::size_t size() const { return grid_.count; }
  [[nodiscard]] double step() const { return grid_.step; }
  [[nodiscard]] double rate_Hz() const { return grid_.rate_Hz(); }

 private:
  BandLimited(const numerics::UniformGrid& grid, double band_Hz);

  numerics::UniformGrid grid_;
  numerics::FirKernel smooth_;
  numerics::FirKernel differentiate_;
};

/// Two signals that are the same but for a delay (and noise).
struct DelayPair {
  std::vector<double> expected;
  std::vector<double> observed;
  /// Variance of the white noise in `observed`, where what differs beyond it is a disturbance that `expected` answers,
  /// as an aircraft answers the gusts that a vane shows; without it all that differs is noise.
  std::optional<double> noise_variance = {};
  /// What was expected if a quantity that it was computed from were one standard deviation off; empty: none is in
  /// doubt.
  std::vector<double> doubted = {};
};

/// The delay that several pairs share, by cross-correlation (numerics::estimate_delay). It is to be taken off
/// where it is determined, of the right sign and larger than `min_delay_s` and three standard errors.
///
/// `sigma_s` holds the noise, the change with what is in doubt, and the bias by a disturbance that is answered. With
/// expected k = m + R g and observed k + g (g the disturbance, R g its answer) cross-correlation is off by
/// g.(R g)'/|k'|^2, at most |g|^2/(w |k|^2) for motion of the bandwidth w and an answer no larger than g. Twice that is
/// taken for a standard deviation, with what noise leaves unexplained for g: in simulated flights of four aircraft,
/// calm to twice light turbulence, delays were off by 0.1 to 0.6 times it, those of x8's badly damped Dutch roll by up
/// to 1.9.
[[nodiscard]] DelayReport shared_delay(std::string group, std::string reference, const std::vector<DelayPair>& pairs,
                                       double rate_Hz, const DelayOptions& options);

/// Of a delay below `least_s`, from which on it would be taken off: kSmall, or kWide where the range is so wide that it
/// holds `kDelayMatters_s`.
[[nodiscard]] DelayFinding finding_of_small(double least_s, const DelayOptions& options);

/// What an effect is explained by: a series, and the variance of the noise in it, which would weaken its coefficient
/// and so bias the delay of a cause that moves with it.
struct Explanatory {
  std::vector<double> value;
  double noise_variance = 0.0;
};

/// How much later `effect` answers `cause` when it is a linear function of the cause and of `others`: the lag at which
/// least squares, corrected for the noise of both (Fuller 1987, sec. 2.2), leaves least, from -max to max.
/// `delay_s` is positive when the effect is late; `correlation` is the multiple correlation. Taken off as above; never
/// for a negative delay, an effect before its cause. `sigma_s` is the jackknife's, by tenths of the recording: it needs
/// no white residual; never less than half a step, between which a cause may jump.
/// Stops early, undetermined, when `progress` is interrupted. `kind` is what messages call the cause.
[[nodiscard]] DelayReport effect_delay(std::string cause_name, std::string effect_name,
                                       const std::vector<double>& effect, const Explanatory& cause,
                                       const std::vector<Explanatory>& others, double step_s,
                                       const DelayOptions& options, const Progress& progress,
                                       std::string_view kind = "cause");

/// What causes that are late together bring about, with what else does.
struct DelayedEffect {
  std::vector<double> effect;
  std::vector<Explanatory> causes, others;
  std::vector<Explanatory> late_others;  ///< as late as the causes: where what is late is the effect's sensor
};

/// The same for causes that move together, of which single delays cannot be distinguished: the one lag of all of them
/// that explains most of all effects (mean of the shares).
[[nodiscard]] DelayReport common_effect_delay(std::string cause_name, std::string effect_name,
                                              const std::vector<DelayedEffect>& effects, double step_s,
                                              const DelayOptions& options, const Progress& progress,
                                              std::string_view kind = "cause");

/// Correlation beyond which two causes move together: two thirds of the one's variance is the other's, and a delay that
/// is searched for one alone is pulled by the effect of the other.
inline constexpr double kMoveTogether = 0.8;

/// Correlation of two series where both are finite; 0 where there is no content.
[[nodiscard]] double correlation_of(const std::vector<double>& a, const std::vector<double>& b);

/// Takes a delay off the stamps of those of the channels that are there. Says whether there was one.
bool take_off_delay(Recording& recording, const std::vector<std::string>& channels, double delay_s);

/// The delay that the study gives for a group, taken off; nothing where it gives none or the channels are missing.
[[nodiscard]] std::optional<DelayReport> take_off_given(Recording& recording, const DelayGroup& group,
                                                        const DelayOptions& options);

}  // namespace veridyn::recording
