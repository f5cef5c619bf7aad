#include "veridyn/estimation/recursive/forgetting.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/option_check.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {

void ForgettingOptions::validate() const {
  const OptionCheck check("forgetting");
  check(lambda > 0.0 && lambda <= 1.0, "lambda", lambda, "in (0, 1]");
  check(lambda_min > 0.0 && lambda_min <= lambda, "lambda_min", lambda_min, "in (0, lambda]");
  check(K_a >= 2.0 && std::isfinite(K_a), "K_a", K_a, "at least 2");
  check(K_b > K_a && std::isfinite(K_b), "K_b", K_b, "above K_a");
  check(gamma > 1.0 && gamma < 2.0, "gamma", gamma, "in (1, 2)");
}

double cut_off_time(double lambda, double rate_Hz, double weight) {
  if (!(lambda < 1.0)) return kInfinity;
  return std::log(weight) / (std::log(lambda) * rate_Hz);
}

VariableForgetting::VariableForgetting(const ForgettingOptions& options, Eigen::Index parameters)
    : options_(options),
      window_short_(options.K_a * static_cast<double>(parameters)),
      window_long_(options.K_b * static_cast<double>(parameters)) {}

double VariableForgetting::update(double residual, double q) {
  constexpr double kXi = 1e-12;  // keeps the quotient finite; relative to the noise
  samples_ += 1.0;
  const double a = 1.0 / std::min(samples_, window_short_);
  const double b = 1.0 / std::min(samples_, window_long_);
  // Squares beyond 1e280 would make every later sample look quiet.
  const double square = std::min(residual * residual, 1e280);
  residual_power_ += a * (square - residual_power_);
  q_power_ += a * (std::min(q * q, 1e280) - q_power_);
  noise_power_ += b * (square - noise_power_);
  const double s_r = std::sqrt(residual_power_), s_e = std::sqrt(noise_power_);
  const bool before = triggered_;
  triggered_ = samples_ >= window_long_ && s_r > options_.gamma * s_e;
  double lambda = options_.lambda;
  if (triggered_) {
    if (!before) ++triggers_;
    lambda = std::min(std::sqrt(q_power_) * s_e / (kXi * s_e + (s_r - s_e)), options_.lambda);
    lambda = std::max(lambda, options_.lambda_min);
  }
  return options_.row_weight ? lambda * lambda : lambda;
}

double VariableForgetting::residual_sd() const { return std::sqrt(residual_power_); }
double VariableForgetting::noise_sd() const { return std::sqrt(noise_power_); }

FalseTriggerRate false_trigger_rate(const ForgettingOptions& options, Eigen::Index parameters, double rate_Hz,
                                    std::uint64_t samples) {
  VariableForgetting forgetting(options, parameters);
  numerics::RandomStream noise(1, "false triggers of variable forgetting");
  // Whether a sample triggers does not depend on q.
  for (std::uint64_t k = 0; k < samples; ++k) (void)forgetting.update(noise.normal(), 0.0);
  const auto count = static_cast<double>(forgetting.triggers());
  const double time_s = static_cast<double>(samples) / rate_Hz;
  if (forgetting.triggers() == 0) return {.per_second = 3.0 / time_s, .bound = true};
  return {.per_second = count / time_s, .bound = false};
}

}  // namespace veridyn::estimation
