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
};

/// What a sensor's innovations say about the filter, after Bar-Shalom, Li & Kirubarajan (2001), sections 5.4 and 11.6.
struct InnovationSummary {
  std::size_t count = 0;      ///< samples offered
  std::size_t rejected = 0;   ///< refused by the gate
  std::size_t recovered = 0;  ///< taken with inflated variance by the recovery rule
  double mean = 0.0;          ///< of the normalised innovations nu / sqrt(S): 0 when unbiased
  double nis = 0.0;           ///< mean of nu^2 / S: 1 when the assumed noise is right, above when it is too small
  /// 95 % of sound runs have their `nis` within 1 +- this: 1.96 sqrt(2 / n).
  double nis_bound95 = 0.0;
  double lag1 = 0.0;            ///< autocorrelation of the normalised innovations at lag 1: 0 when white
  double white_bound95 = 0.0;   ///< 1.96 / sqrt(n): band of `lag1` when white
  double ljung_box = 0.0;       ///< of the first 10 lags
  double ljung_box_p = 1.0;     ///< small: the innovations are autocorrelated
  double log_likelihood = 0.0;  ///< sum of -(ln 2 pi S + nu^2 / S) / 2 over the accepted samples
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

  [[nodiscard]] InnovationSummary summary() const;
  [[nodiscard]] double log_likelihood() const noexcept { return log_likelihood_; }
  /// Whether the last sample was refused.
  [[nodiscard]] bool rejecting() const noexcept { return run_ > 0; }

 private:
  void count_in(double nu, double S) noexcept;

  InnovationGate gate_;
  std::size_t count_ = 0;
  std::size_t rejected_ = 0;
  std::size_t recovered_ = 0;
  std::size_t used_ = 0;
  double sum_ = 0.0;
  double sum_squares_ = 0.0;
  double log_likelihood_ = 0.0;
  std::array<double, kLags> recent_{};
  std::array<double, kLags> products_{};
  std::size_t recent_count_ = 0;
  double refused_since_ = 0.0;
  int run_ = 0;
  bool recovering_ = false;
};

}  // namespace veridyn::estimation
