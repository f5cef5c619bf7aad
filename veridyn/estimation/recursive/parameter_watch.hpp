#pragma once

#include <optional>

#include "veridyn/estimation/recursive/change_detection.hpp"

namespace veridyn::estimation {

/// How a parameter of a regression is watched for a change of some size.
struct ParameterWatchOptions {
  /// Change to be found, as a share of the parameter's value: to (1 + share) times, or its inverse. Less than half of
  /// it is no change: errors of the model by which the parameter seems to move a little raise no alarm, however many
  /// rows there are. 0: it is not watched.
  double share = 0.0;
  double block_s = 0.5;                     ///< rows are summed over so long: what correlation they have is in the sums
  double learn_s = 25.0;                    ///< after so much of excited driving it is watched [s]
  double memory_s = 200.0;                  ///< over which the noise of the sums is followed afterwards
  double settle_s = 10.0;                   ///< not watched for this long after an alarm
  double false_alarm_interval_s = 36000.0;  ///< stated, at least

  /// @throws InputError naming the option, its value and its rule.
  void validate() const;
};

/// What noise of the sensors does to a row [x, z] and its innovation e.
struct RowNoise {
  double regressor = 0.0;  ///< variance of x
  double shared = 0.0;     ///< covariance of x and e: with noise in x the two are not independent
};

/// Watches one parameter theta of a regression z = x theta + ... for a change by a given share, in the innovations e of
/// the estimate so far.
///
/// A change by d moves the mean of e to x d. Two sums of Page's (1954) kind, one for d = share theta and one for what
/// undoes it, add the logarithm of the likelihoods' ratio of a block of rows,
///
///     (d S - d^2 I/2)/s^2,  S = sum (x e - x^2 c/P),  I = sum x^2,
///
/// with the variance s^2 of S/sqrt(I) as unchanged blocks have it; c is the covariance of x and e by noise and P the
/// power of x over some seconds, so that x^2 c/P is what is expected of x e where x is known. While x is mostly noise
/// neither sum moves, and nothing is learned. Thresholds ln(N), N the blocks of a stated interval for each sum, are
/// passed by chance once in at least so many blocks on average (Lorden 1971, Ann Math Stat 42(6), theorem 2), where
/// blocks are independent and normal and s is known; what is not known of s is covered by what the bound leaves. No
/// single block raises an alarm.
class ParameterWatch {
 public:
  ParameterWatch(const ParameterWatchOptions& options, double rate_Hz);

  /// One row: its time [s], regressor, innovation, the parameter's estimate, and the row's noise. Does not allocate.
  /// @return the change when this row raises the alarm, its shift relative to the estimate
  std::optional<Change> update(double time_s, double x, double innovation, double theta, const RowNoise& noise);
  /// Not watched for `settle_s`, as after an alarm: the estimate is known to find itself.
  void pause();

  /// Larger of the sums over their threshold: 1 is an alarm.
  [[nodiscard]] double suspicion() const;
  [[nodiscard]] bool watching() const { return blocks_ >= learn_blocks_; }

 private:
  struct Sum {
    double value = 0.0;
    double since_s = 0.0;
    double S = 0.0, I = 0.0;  ///< since it last was zero
  };
  std::optional<Change> take_block(double theta);
  void add(Sum& sum, double d, double variance);
  void learn();

  ParameterWatchOptions options_;
  double rate_Hz_ = 1.0;
  double block_rows_ = 1.0;
  double learn_blocks_ = 1.0;
  double memory_blocks_ = 1.0;
  double threshold_ = 0.0;
  double rows_ = 0.0, S_ = 0.0, I_ = 0.0;
  double power_ = 0.0, noise_ = 0.0;  // of x, and of its noise, over some seconds
  double power_rows_ = 0.0;
  double began_s_ = 0.0, last_s_ = 0.0;
  double blocks_ = 0.0;                      // learned from
  double mean_square_ = 0.0, mean_I_ = 0.0;  // of S and of I
  Sum up_, down_;
  double settle_blocks_ = 0.0;
  double pause_blocks_ = 0.0;
};

}  // namespace veridyn::estimation
