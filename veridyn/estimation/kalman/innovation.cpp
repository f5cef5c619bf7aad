#include "veridyn/estimation/kalman/innovation.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

InnovationMonitor::Verdict InnovationMonitor::judge(double t, double nu, double S) noexcept {
  ++count_;
  const double limit = gate_.threshold * gate_.threshold * S;
  const double square = nu * nu;
  const bool inside = square <= limit;  // false for NaN too
  count_time(t, inside, nu, S);
  if (inside) {
    run_ = 0;
    recovering_ = false;
    count_in(nu, S);
    return {true, 0.0};
  }
  if (run_ == 0) refused_since_ = t;
  ++run_;
  if (std::isfinite(square) &&
      (recovering_ || (run_ >= gate_.recovery_samples && t - refused_since_ >= gate_.recovery_s))) {
    recovering_ = true;
    ++recovered_;
    return {true, square / (gate_.threshold * gate_.threshold) - S};
  }
  ++rejected_;
  recent_count_ = 0;
  return {false, 0.0};
}

void InnovationMonitor::count_time(double t, bool inside, double nu, double S) noexcept {
  const double held = has_last_ ? std::min(t - last_t_, kLongestHold_s) : 0.0;
  last_t_ = t;
  has_last_ = true;
  if (inside) {
    unsupported_ = std::max(0.0, unsupported_ - held);
  } else {
    if (unsupported_ == 0.0) {
      unsupported_since_ = t - held;
      largest_nu_ = largest_sigma_ = largest_rate_ = 0.0;
    }
    unsupported_ += held;
    most_unsupported_ = std::max(most_unsupported_, unsupported_);
    const double size = std::abs(nu), passed = t - unsupported_since_;
    if (std::isfinite(size) && size > std::abs(largest_nu_)) {
      largest_nu_ = nu;
      largest_sigma_ = std::sqrt(S);
    }
    if (std::isfinite(size) && passed > gate_.recovery_s) largest_rate_ = std::max(largest_rate_, size / passed);
  }
}

void InnovationMonitor::count_in(double nu, double S) noexcept {
  const double e = nu / std::sqrt(S);
  ++used_;
  sum_ += e;
  sum_squares_ += e * e;
  sum_nu_ += nu;
  sum_nu_squares_ += nu * nu;
  sum_variance_ += S;
  constexpr double kLog2Pi = 1.8378770664093453;
  log_likelihood_ -= 0.5 * (kLog2Pi + std::log(S) + e * e);
  for (std::size_t lag = 0; lag < recent_count_; ++lag) products_[lag] += e * recent_[lag];
  for (std::size_t lag = kLags - 1; lag > 0; --lag) recent_[lag] = recent_[lag - 1];
  recent_[0] = e;
  recent_count_ = std::min(recent_count_ + 1, kLags);
}

void InnovationMonitor::restart() noexcept {
  recent_count_ = 0;
  run_ = 0;
  recovering_ = false;
  has_last_ = false;
  unsupported_ = 0.0;
}

InnovationSummary InnovationMonitor::summary() const {
  InnovationSummary s;
  s.count = count_;
  s.rejected = rejected_;
  s.recovered = recovered_;
  s.log_likelihood = log_likelihood_;
  s.unsupported_s = most_unsupported_;
  if (used_ == 0) return s;
  const double n = static_cast<double>(used_);
  s.mean = sum_ / n;
  s.nis = sum_squares_ / n;
  s.mean_size = sum_nu_ / n;
  s.rms_size = std::sqrt(sum_nu_squares_ / n);
  s.expected_size = std::sqrt(sum_variance_ / n);
  s.nis_bound95 = numerics::kNormal95 * std::sqrt(2.0 / n);
  s.white_bound95 = numerics::kNormal95 / std::sqrt(n);
  if (used_ > kLags + 1 && sum_squares_ > 0.0) {
    s.lag1 = products_[0] / sum_squares_;
    for (std::size_t lag = 0; lag < kLags; ++lag) {
      const double r = products_[lag] / sum_squares_;
      s.ljung_box += n * (n + 2.0) * r * r / (n - static_cast<double>(lag + 1));
    }
    s.ljung_box_p = numerics::chi_square_upper_p(s.ljung_box, static_cast<double>(kLags));
  }
  return s;
}

}  // namespace veridyn::estimation
