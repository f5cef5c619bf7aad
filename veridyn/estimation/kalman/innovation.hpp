#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace veridyn::estimation {

/// When a measurement is accepted.
struct InnovationGate {
  /// Largest |innovation| / sqrt(S) that is accepted: the root of the chi-square threshold with one degree of freedom.
  /// At 5 a sound Gaussian sensor loses one sample in 1.7 million, and linearisation errors of a turn still pass.
  double threshold = 5.0;
  /// A sensor whose samples were all refused for this long [s] (and at least `recovery_samples` of them) is taken
  /// back: from then on its variance is inflated until the innovation sits on the gate, so that the filter walks
  /// towards it instead of jumping. Without this rule a filter that was wrong once would never accept the sensor again.
  double recovery_s = 2.0;
  int recovery_samples = 5;
  /// A sensor that was refused for this much longer than it was accepted [s] does not correct the filter: what it
  /// measures is dead reckoning. See InnovationMonitor::lost.
  double dead_reckoning_s = 10.0;
};

/// What a sensor's innovations say about the filter, after Bar-Shalom, Li & Kirubarajan (2001), sections 5.4 and 11.6.
struct InnovationSummary {
  std::size_t count = 0;      ///< samples offered
  std::size_t rejected = 0;   ///< refused by the gate
  std::size_t recovered = 0;  ///< taken with inflated variance by the recovery rule
  double mean = 0.0;          ///< of the normalised innovations nu / sqrt(S): 0 when unbiased
  double nis = 0.0;           ///< mean of nu^2 / S: 1 when the assumed noise is right, above when it is too small
  /// In the sensor's unit, of the accepted samples: mean and root mean square of nu, and the root of the mean S, which
  /// is the root mean square that the filter expected.
  double mean_size = 0.0, rms_size = 0.0, expected_size = 0.0;
  /// 95 % of sound runs have their `nis` within 1 +- this: 1.96 sqrt(2 / n).
  double nis_bound95 = 0.0;
  double lag1 = 0.0;            ///< autocorrelation of the normalised innovations at lag 1: 0 when white
  double white_bound95 = 0.0;   ///< 1.96 / sqrt(n): band of `lag1` when white
  double ljung_box = 0.0;       ///< of the first 10 lags
  double ljung_box_p = 1.0;     ///< small: the innovations are autocorrelated
  double log_likelihood = 0.0;  ///< sum of -(ln 2 pi S + nu^2 / S) / 2 over the accepted samples
  double unsupported_s = 0.0;   ///< largest value of InnovationMonitor::unsupported_s
};

/// Gates the scalar innovations of one sensor and keeps their statistics. Does not allocate.
class InnovationMonitor {
 public:
  static constexpr std::size_t kLags = 10;

  /// What to do with one innovation.
  struct Verdict {
    bool accept = false;
    double extra_variance = 0.0;  ///< to be added to S and to the measurement's variance
  };

  InnovationMonitor() = default;
  explicit InnovationMonitor(const InnovationGate& gate) : gate_(gate) {}

  /// Judges the innovation `nu` of predicted variance `S` > 0 at time `t` [s]; times must not decrease. A `nu` that is
  /// not finite is refused.
  Verdict judge(double t, double nu, double S) noexcept;
  /// A break in the record: neither lags nor a run of refusals reach across it.
  void restart() noexcept;

  /// For how much longer the sensor was refused than accepted [s], by Page's cumulative sum (1954): time in which
  /// samples were beyond the gate (refused, or taken back with inflated variance) counts up, time in which they were
  /// inside counts down, never below 0. A sample stands for the time since the one before, at most `kLongestHold_s`, so
  /// that silence is no refusal. A short fault leaves it small, a contradiction that lasts lets it grow without bound
  /// also where the innovation crosses zero now and then.
  [[nodiscard]] double unsupported_s() const noexcept { return unsupported_; }
  /// When `unsupported_s` was last 0 [s].
  [[nodiscard]] double unsupported_since() const noexcept { return unsupported_since_; }
  /// Whether the filter is no longer corrected by this sensor: `unsupported_s` above the gate's `dead_reckoning_s`.
  [[nodiscard]] bool lost() const noexcept { return unsupported_ > gate_.dead_reckoning_s; }
  static constexpr double kLongestHold_s = 1.0;
  /// Time [s] of the last sample.
  [[nodiscard]] double last_time() const noexcept { return last_t_; }
  /// The largest innovation since `unsupported_since`, its predicted standard deviation, and its fastest growth over
  /// more than the recovery's time [1/s].
  [[nodiscard]] double largest_innovation() const noexcept { return largest_nu_; }
  [[nodiscard]] double largest_sigma() const noexcept { return largest_sigma_; }
  [[nodiscard]] double largest_rate() const noexcept { return largest_rate_; }

  [[nodiscard]] InnovationSummary summary() const;
  [[nodiscard]] double log_likelihood() const noexcept { return log_likelihood_; }

 private:
  void count_in(double nu, double S) noexcept;
  void count_time(double t, bool inside, double nu, double S) noexcept;

  InnovationGate gate_;
  std::size_t count_ = 0;
  std::size_t rejected_ = 0;
  std::size_t recovered_ = 0;
  std::size_t used_ = 0;
  double sum_ = 0.0;
  double sum_squares_ = 0.0;
  double sum_nu_ = 0.0, sum_nu_squares_ = 0.0, sum_variance_ = 0.0;
  double log_likelihood_ = 0.0;
  std::array<double, kLags> recent_{};
  std::array<double, kLags> products_{};
  std::size_t recent_count_ = 0;
  double refused_since_ = 0.0;
  double last_t_ = 0.0;
  double largest_nu_ = 0.0, largest_sigma_ = 0.0, largest_rate_ = 0.0;
  bool has_last_ = false;  ///< whether `last_t_` is the time of a sample since the last break
  double unsupported_ = 0.0, most_unsupported_ = 0.0, unsupported_since_ = 0.0;
  int run_ = 0;
  bool recovering_ = false;
};

}  // namespace veridyn::estimation
