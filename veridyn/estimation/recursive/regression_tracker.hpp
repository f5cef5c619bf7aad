#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/recursive/change_detection.hpp"
#include "veridyn/estimation/recursive/parameter_watch.hpp"
#include "veridyn/estimation/recursive/recursive_regression.hpp"

namespace veridyn::estimation {

/// How a regression is tracked on line. Study table `[track]`.
struct TrackerOptions {
  Method method = Method::kPcaGtls;
  double memory_s = 100.0;  ///< a sample counts 5 % after it; 0: the forgetting factor is given
  /// The noise is averaged over 500 n rows, so that a trigger lasts until the estimate has followed, and at least 33
  /// rows are remembered: fewer fit noise while no linear model holds, as in a stall.
  ForgettingOptions forgetting{.variable = true, .lambda_min = 0.97, .K_b = 500.0};
  double signal_to_noise = 1.0;
  bool detect_changes = true;
  ChangeDetectionOptions detection = {};
  /// Whether the innovations' mean and spread are watched. Not a key; domains choose.
  bool watch_innovations = true;
  /// The first parameter is watched for a change of its own; where the innovations are too, both share the rate of
  /// false alarms of `detection`. Its times of learning, memory and settling hold for both. Not a key; domains choose.
  ParameterWatchOptions watch = {};
  double watch_after_s = 0.0;  ///< rows before this are not watched: the estimate finds itself. Not a key
  double history_Hz = 5.0;     ///< of what is kept for the report

  [[nodiscard]] static const KeyTable<TrackerOptions>& keys();
  /// The forgetting factor at a rate of rows.
  [[nodiscard]] ForgettingOptions forgetting_at(double rate_Hz) const;
};

/// What became of a regression over time, thinned to `TrackerOptions::history_Hz`.
struct TrackHistory {
  std::vector<double> time;                          ///< [s]
  std::vector<std::vector<double>> value, sigma;     ///< a series per parameter; sigma infinite before it is usable
  std::vector<std::vector<double>> unexcited_share;  ///< a series per parameter, 0..1
  std::vector<std::vector<double>> singular_value;   ///< a series per direction, descending
  std::vector<double> threshold;
  std::vector<int> excited;        ///< directions above the threshold, exact ones included
  std::vector<double> lambda;      ///< least since the sample before
  std::vector<double> suspicion;   ///< of the change detector: 1 is an alarm
  std::vector<double> innovation;  ///< over its standard deviation, rms since the sample before
};

/// Weighted sums over the rows in memory, by which the tracked model is judged.
struct TrackedPower {
  double weight = 0.0;
  double mean = 0.0;        ///< of z
  double deviation = 0.0;   ///< sum of (z - mean)^2
  double innovation = 0.0;  ///< sum of the squares of innovations
  double lagged = 0.0;      ///< sum of products of neighbouring innovations

  void add(double z, double lambda);
  void add_innovation(double value, double previous, double lambda);
  /// Share of the variance of z that estimates explained before they saw the row.
  [[nodiscard]] double predicted_share() const { return deviation > 0.0 ? 1.0 - innovation / deviation : kNaN; }
  /// Correlation of neighbouring innovations.
  [[nodiscard]] double lag1() const { return innovation > 0.0 ? lagged / innovation : kNaN; }
};

/// How far estimates from separate parts of a recording scatter.
struct TrackedScatter {
  int parts = 0;       ///< that could be compared; less than 2: none
  double p = 1.0;      ///< of "they are estimates of the same parameters"
  double ratio = 1.0;  ///< chi-square over its degrees of freedom: Birge's factor on the variances
};

/// One linear regression z = x theta followed row by row, watched for changes, with its history.
class RegressionTracker {
 public:
  /// @param names of the parameters, 1 to 8
  /// @param error_covariance W of a row [x, z], (n + 1) x (n + 1)
  /// @param rate_Hz of rows
  RegressionTracker(std::vector<std::string> names, const Eigen::MatrixXd& error_covariance,
                    const TrackerOptions& options, double rate_Hz);

  /// Hybrid start; see RecursiveRegression::start.
  void start(const Eigen::VectorXd& theta_0, const Eigen::MatrixXd& P_0, double rows, double residual_sd);

  /// Forgets the rows so far: theta stays, with standard deviations `sigma` (as a hybrid start). History, changes and
  /// what watches goes on, after the time of settling. For a change that is known to have happened.
  void restart(const Eigen::VectorXd& sigma);

  /// What the residual shows beyond W, or less than it, becomes variance of z alone: an error of the equation (Fuller
  /// 1987, sec. 2.2), as turbulence and terms that the model lacks leave it. Taken for noise of the regressors, as GTLS
  /// does otherwise, it would bias the estimate. A difference that may be chance changes nothing. Allocates: to be
  /// called every few seconds, not every row.
  void fit_equation_error();
  /// Variance of z beyond the W that was given.
  [[nodiscard]] double equation_error() const { return regression_.equation_error(); }

  /// Takes a row [x, z] of time `t` [s]. Beyond the history, and a copy of the estimate once a memory, nothing is
  /// allocated.
  /// @param row_W error covariance of this row where it is known: errors that grow with the signal (a coefficient has
  /// those of the dynamic pressure) are then not taken for a change. Null: W.
  /// @return the change that the row reveals
  std::optional<Change> update(double t, std::span<const double> x, double z, const Eigen::MatrixXd* row_W = nullptr);

  [[nodiscard]] const std::vector<std::string>& names() const { return regression_.names(); }
  [[nodiscard]] const RecursiveRegression& regression() const { return regression_; }
  [[nodiscard]] const TrackHistory& history() const { return history_; }
  [[nodiscard]] const std::vector<Change>& changes() const { return changes_; }
  /// Of all that watches: 1 is an alarm.
  [[nodiscard]] double suspicion() const;
  [[nodiscard]] double rate_Hz() const { return rate_Hz_; }
  [[nodiscard]] const TrackerOptions& options() const { return options_; }
  [[nodiscard]] const TrackedPower& power() const { return power_; }
  /// Variance of the residual over that which the given W explains, equation error not among it; NaN before it is
  /// known and for OLS.
  [[nodiscard]] double error_ratio() const;
  /// Estimates that stood a memory apart (a sample counts 5 %: they hardly share data) against each other, since the
  /// last change. None where nothing is ever forgotten, or directions were held.
  [[nodiscard]] TrackedScatter scatter() const;
  /// The estimate as it stands, its intervals widened where the parts of the recording scatter beyond their error bars.
  [[nodiscard]] RegressionEstimate estimate() const;

 private:
  /// An estimate as it stood.
  struct Part {
    Eigen::VectorXd theta;
    Eigen::MatrixXd covariance;
    double degrees_of_freedom = 0.0;
  };
  [[nodiscard]] static std::optional<Part> part_of(const RecursiveRegression& regression);
  void keep_part(double t);
  void forget_parts();
  void remember(double t);
  [[nodiscard]] bool moves_held_direction(std::span<const double> x) const;
  [[nodiscard]] double noise_ratio(const Eigen::MatrixXd& row_W) const;
  [[nodiscard]] double variance_of(const SmallMatrix& W) const;
  [[nodiscard]] RowNoise row_noise(const Eigen::MatrixXd* row_W) const;

  TrackerOptions options_;
  double rate_Hz_;
  SmallMatrix W_;
  double least_noise_;
  RecursiveRegression regression_;
  ChangeDetector detector_;
  std::optional<ParameterWatch> watch_;
  std::vector<Change> changes_;
  TrackHistory history_;
  double next_s_ = 0.0;
  bool first_ = true;
  bool watching_ = false;  ///< every direction was excited once
  TrackedPower power_;
  double last_innovation_ = 0.0;
  std::vector<Part> parts_;
  double next_part_s_ = kNaN;
  double least_lambda_ = 1.0;
  double innovation_power_ = 0.0;
  std::uint64_t innovations_ = 0;
};

}  // namespace veridyn::estimation
