#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace veridyn::estimation {

/// How a recursive estimator forgets. One meaning everywhere: squares are weighted by lambda per sample, so a sample
/// that is t seconds old counts lambda^(t rate) as much as a fresh one.
struct ForgettingOptions {
  /// Constant forgetting, and the largest value of variable forgetting, in (0, 1]; 1 forgets nothing. The default at
  /// 100 Hz has forgotten to 5 % after 99.8 s.
  double lambda = 0.9997;
  /// Forget faster while the a-priori residual is larger than its noise (Paleologu, Benesty & Ciochina 2008).
  bool variable = false;
  /// Variable forgetting never goes below this: without it the first trigger, true or false, wipes the memory.
  /// The default keeps 10 samples: an abrupt change of the past is forgotten before its trigger ends.
  double lambda_min = 0.9;
  /// Windows of the powers of residual and noise [multiples of the number of parameters]; K_b > K_a >= 2. The
  /// published K_a = 2 triggers on noise alone (see `false_trigger_rate`).
  double K_a = 10.0;
  double K_b = 50.0;
  /// The residual's standard deviation must exceed gamma times the noise's to trigger; in (1, 2). 1.5 or more for few
  /// false triggers.
  double gamma = 1.5;
  /// Weights rows, not squares, by lambda: squares by lambda^2, so the memory is half as long. Only to reproduce
  /// recursive SVDs that were published so.
  bool row_weight = false;

  /// Weight of squares per sample when nothing triggers: lambda, or lambda^2 with `row_weight`.
  [[nodiscard]] double square_weight() const { return row_weight ? lambda * lambda : lambda; }
  /// @throws InputError naming the option, its value and its rule.
  void validate() const;
};

/// Time [s] after which a sample's square counts `weight`: ln(weight)/(ln(lambda) rate). Infinite for lambda = 1.
/// Check: cut_off_time(0.9997, 100) = 99.84 s.
[[nodiscard]] double cut_off_time(double lambda, double rate_Hz, double weight = 0.05);

/// Expected number of triggers per second of variable forgetting on white normal noise [1/s] with `parameters`
/// parameters at `rate_Hz`.
///
/// Counted on `samples` simulated samples of white noise from a fixed seed: onsets, that is samples where the trigger
/// holds and did not at the sample before. A count of c has a relative standard error of at least 1/sqrt(c); when none
/// occurs the value is the 95 % bound 3/samples and `bound` is set. 1e6 samples take about 10 ms.
struct FalseTriggerRate {
  double per_second = 0.0;
  bool bound = false;  ///< none seen: `per_second` is an upper 95 % bound
};
/// Counts the false triggers of these options; see FalseTriggerRate.
[[nodiscard]] FalseTriggerRate false_trigger_rate(const ForgettingOptions& options, Eigen::Index parameters,
                                                  double rate_Hz, std::uint64_t samples = 4'000'000);

/// Variable forgetting factor of Paleologu, Benesty & Ciochina, IEEE Signal Processing Letters 15 (2008) 597.
///
/// From the a-priori residual r_k and q_k = x_k P x_k' (P the inverse of the weighted normal matrix, unit noise), three
/// running powers: s_r^2 and s_q^2 over a window of K_a n samples, the noise s_e^2 = power of r over the longer K_b n.
///     lambda = lambda_max                                           when s_r <= gamma s_e,
///     lambda = max(lambda_min, min(s_q s_e/(xi + s_r - s_e), lambda_max))  otherwise (a trigger).
/// While a window is still filling it averages what there is, and nothing triggers before the longer one is full.
class VariableForgetting {
 public:
  VariableForgetting(const ForgettingOptions& options, Eigen::Index parameters);

  /// Takes one sample and returns lambda for it (weight of squares). Does not allocate. Values must be finite.
  double update(double residual, double q);

  [[nodiscard]] bool triggered() const { return triggered_; }
  /// Onsets of a trigger so far.
  [[nodiscard]] std::uint64_t triggers() const { return triggers_; }
  [[nodiscard]] double residual_sd() const;
  [[nodiscard]] double noise_sd() const;

 private:
  ForgettingOptions options_;
  double window_short_;
  double window_long_;
  double residual_power_ = 0.0;
  double q_power_ = 0.0;
  double noise_power_ = 0.0;
  double samples_ = 0.0;
  std::uint64_t triggers_ = 0;
  bool triggered_ = false;
};

}  // namespace veridyn::estimation
