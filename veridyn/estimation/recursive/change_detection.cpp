#include "veridyn/estimation/recursive/change_detection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/core/option_check.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

using Distribution = std::function<double(double)>;

// Run length from zero of S = max(0, S + v - reference), v of distribution F: states i D, i < count, and the alarm.
double chain_run_length(const Distribution& F, double reference, double threshold, int count) {
  const double step = 2.0 * threshold / (2.0 * count - 1.0);
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(count, count);
  std::vector<double> edge(at(2 * count));
  // F between states depends on their difference only.
  for (int d = -count; d < count; ++d) edge[d + count] = F(reference + (d + 0.5) * step);
  for (int i = 0; i < count; ++i) {
    A(i, 0) -= edge[-i + count];
    for (int j = 1; j < count; ++j) A(i, j) -= edge[j - i + count] - edge[j - i - 1 + count];
  }
  const Eigen::VectorXd length = numerics::solve_linear(A, Eigen::VectorXd(Eigen::VectorXd::Ones(count)));
  return length(0) > 0.0 ? length(0) : 1e15;
}

// The chain's error is of second order in its step.
double one_sided_run_length(const Distribution& F, double reference, double threshold) {
  constexpr int kStates = 75;
  const double coarse = chain_run_length(F, reference, threshold, kStates);
  const double fine = chain_run_length(F, reference, threshold, 2 * kStates);
  const double ratio = (4.0 * kStates - 1.0) / (2.0 * kStates - 1.0);
  const double square = ratio * ratio;
  const double extrapolated = std::exp((square * std::log(fine) - std::log(coarse)) / (square - 1.0));
  return std::max(1.0, extrapolated);
}

// Mean rate of alarms over what the learned mean and standard deviation may be off, both normal: Gauss-Hermite.
struct LearningError {
  double of_mean = 0.0;
  double of_sd = 0.0;  // relative
};

double mean_rate_of_mean(double reference, double threshold, const LearningError& error) {
  constexpr double kNode = 1.7320508075688772, kOuter = 1.0 / 6.0, kInner = 2.0 / 3.0;
  double rate = 0.0;
  for (const double node : {-kNode, 0.0, kNode}) {
    const double weight = node == 0.0 ? kInner : kOuter, sd = 1.0 / (1.0 + error.of_sd * node);
    rate += weight * (kInner / cusum_run_length(reference, threshold, 0.0, sd) +
                      2.0 * kOuter / cusum_run_length(reference, threshold, error.of_mean * kNode, sd));
  }
  return rate;
}

double mean_rate_of_spread(double reference, double threshold, const LearningError& error) {
  constexpr std::array<double, 5> kNode{-2.856970013872806, -1.355626179974266, 0.0, 1.355626179974266,
                                        2.856970013872806};
  constexpr std::array<double, 5> kWeight{0.011257411327720, 0.222075922005613, 0.533333333333333, 0.222075922005613,
                                          0.011257411327720};
  double rate = 0.0;
  for (std::size_t i = 0; i < kNode.size(); ++i)
    rate += kWeight[i] / spread_cusum_run_length(reference, threshold, 1.0 / (1.0 + error.of_sd * kNode[i]));
  return rate;
}

// Threshold where rate(threshold) is `rate`: log rate is nearly straight in the threshold, so the secant is quick.
double solve_threshold(const std::function<double(double)>& rate_of, double rate) {
  double low = 1.0, high = 4.0;
  while (rate_of(high) > rate && high < 1e3) {
    low = high;
    high *= 2.0;
  }
  double f_low = std::log(rate_of(low) / rate), f_high = std::log(rate_of(high) / rate);
  for (int k = 0; k < 30 && high - low > 1e-4 * high; ++k) {
    double next = low + (high - low) * f_low / (f_low - f_high);
    next = std::clamp(next, low + 0.02 * (high - low), high - 0.02 * (high - low));
    const double f = std::log(rate_of(next) / rate);
    if (std::abs(f) < 1e-3) return next;
    (f > 0.0 ? low : high) = next;
    (f > 0.0 ? f_low : f_high) = f;
  }
  return high;
}

}  // namespace

double cusum_run_length(double reference, double threshold, double mean, double sd) {
  const double up =
      one_sided_run_length([&](double v) { return numerics::normal_cdf((v - mean) / sd); }, reference, threshold);
  if (mean == 0.0) return 0.5 * up;
  const double down =
      one_sided_run_length([&](double v) { return numerics::normal_cdf((v + mean) / sd); }, reference, threshold);
  return 1.0 / (1.0 / up + 1.0 / down);
}

double spread_cusum_run_length(double reference, double threshold, double sd) {
  return one_sided_run_length(
      [&](double v) { return v > 0.0 ? 2.0 * numerics::normal_cdf(std::sqrt(v) / sd) - 1.0 : 0.0; }, reference,
      threshold);
}

void ChangeDetectionOptions::validate() const {
  const OptionCheck require("change_detection");
  const auto check = [&](bool good, const char* name, double value, const char* rule) {
    require(good && std::isfinite(value), name, value, rule);
  };
  check(rate_Hz > 0.0, "rate_Hz", rate_Hz, "> 0");
  check(block_s > 0.0 && block_s * rate_Hz < 1e6, "block_s", block_s, "> 0 and less than a million samples");
  check(false_alarm_interval_s >= 20.0 * block_s, "false_alarm_interval_s", false_alarm_interval_s,
        "at least 20 blocks");
  check(mean_shift > 0.0, "mean_shift", mean_shift, "> 0");
  check(spread_factor == 0.0 || spread_factor > 1.0, "spread_factor", spread_factor, "0 or > 1");
  check(learn_s >= 50.0 * block_s, "learn_s", learn_s, "at least 50 blocks");
  check(settle_s >= 0.0, "settle_s", settle_s, ">= 0");
  check(memory_s >= learn_s, "memory_s", memory_s, "at least learn_s");
}

ChangeDetector::ChangeDetector(const ChangeDetectionOptions& options) : options_(options) {
  options_.validate();
  block_length_ = static_cast<std::uint64_t>(std::max(1.0, std::round(options_.block_s * options_.rate_Hz)));
  const double block_s = static_cast<double>(block_length_) / options_.rate_Hz;
  learn_blocks_ = std::ceil(options_.learn_s / block_s);
  memory_blocks_ = std::max(learn_blocks_, options_.memory_s / block_s);
  const bool spread = options_.spread_factor > 0.0;
  const double rate = block_s / options_.false_alarm_interval_s / (spread ? 2.0 : 1.0);
  const LearningError error{.of_mean = 1.0 / std::sqrt(learn_blocks_), .of_sd = 1.0 / std::sqrt(2.0 * learn_blocks_)};
  mean_reference_ = 0.5 * options_.mean_shift;
  mean_threshold_ = solve_threshold([&](double h) { return mean_rate_of_mean(mean_reference_, h, error); }, rate);
  if (!spread) return;
  const double f = options_.spread_factor;
  // Log-likelihood ratio of sd f against 1.
  spread_reference_ = 2.0 * std::log(f) / (1.0 - 1.0 / (f * f));
  spread_threshold_ = solve_threshold([&](double h) { return mean_rate_of_spread(spread_reference_, h, error); }, rate);
}

void ChangeDetector::Sum::add(double increment, double time_s) {
  if (value <= 0.0) {
    since_s = time_s;
    blocks = 0.0;
  }
  value = std::max(0.0, value + increment);
  blocks += 1.0;
}

bool ChangeDetector::watching() const { return blocks_ >= learn_blocks_; }

double ChangeDetector::correlation() const {
  return variance_ > 0.0 ? std::clamp(covariance_ / variance_, -0.99, 0.99) : 0.0;
}

double ChangeDetector::suspicion() const {
  double largest = std::max(up_.value, down_.value) / mean_threshold_;
  if (spread_threshold_ > 0.0) largest = std::max(largest, spread_.value / spread_threshold_);
  return largest;
}

void ChangeDetector::start_again() {
  up_ = down_ = spread_ = {};
  blocks_ = mean_ = variance_ = covariance_ = 0.0;
  has_previous_ = false;
}

void ChangeDetector::pause_after_alarm() {
  const bool again = alarms_ > 1 && since_alarm_ < learn_blocks_;
  since_alarm_ = 0.0;
  if (again) return start_again();
  pause();
}

void ChangeDetector::pause() {
  up_ = down_ = spread_ = {};
  pause_blocks_ = options_.settle_s * options_.rate_Hz / static_cast<double>(block_length_);
}

void ChangeDetector::learn(double mean) {
  blocks_ += 1.0;
  const double share = 1.0 / std::min(blocks_, memory_blocks_);
  const double before = mean - mean_;
  mean_ += share * before;
  const double after = mean - mean_;
  variance_ += share * (before * after - variance_);
  if (has_previous_) covariance_ += share * ((previous_ - mean_) * after - covariance_);
}

std::optional<Change> ChangeDetector::take_block(double mean) {
  std::optional<Change> change;
  if (pause_blocks_ > 0.0) {
    pause_blocks_ -= 1.0;
    previous_ = mean;
    has_previous_ = true;
    return change;
  }
  since_alarm_ += 1.0;
  if (watching() && variance_ > 0.0) {
    const double a = has_previous_ ? correlation() : 0.0;
    const double s = std::sqrt(variance_ * (1.0 - a * a));
    const double u = (mean - mean_ - (has_previous_ ? a * (previous_ - mean_) : 0.0)) / s;
    up_.add(u - mean_reference_, block_began_s_);
    down_.add(-u - mean_reference_, block_began_s_);
    if (spread_threshold_ > 0.0) spread_.add(u * u - spread_reference_, block_began_s_);
    const Sum& side = up_.value >= down_.value ? up_ : down_;
    if (side.value > mean_threshold_) {
      const double shift = side.value / side.blocks + mean_reference_;
      change = Change{.kind = ChangeKind::kMean,
                      .detected_s = last_s_,
                      .began_s = side.since_s,
                      .shift = &side == &up_ ? shift : -shift};
    } else if (spread_threshold_ > 0.0 && spread_.value > spread_threshold_) {
      change = Change{.kind = ChangeKind::kSpread,
                      .detected_s = last_s_,
                      .began_s = spread_.since_s,
                      .shift = std::sqrt(spread_.value / spread_.blocks + spread_reference_)};
    }
  }
  if (change) {
    ++alarms_;
    pause_after_alarm();
    return change;
  }
  learn(mean);
  previous_ = mean;
  has_previous_ = true;
  return change;
}

std::optional<Change> ChangeDetector::update(double time_s, double normalised_innovation) {
  if (!std::isfinite(normalised_innovation) || !std::isfinite(time_s)) return std::nullopt;
  // After a gap, or a jump back in time, the block before is no neighbour any more.
  const double gap_s = 0.5 * static_cast<double>(block_length_) / options_.rate_Hz + 1.5 / options_.rate_Hz;
  if (last_s_ != 0.0 && !(std::abs(time_s - last_s_) <= gap_s)) {
    has_previous_ = false;
    block_filled_ = 0;
    block_sum_ = 0.0;
  }
  if (block_filled_ == 0) block_began_s_ = time_s;
  last_s_ = time_s;
  // One absurd sample must not be the whole block.
  block_sum_ += std::clamp(normalised_innovation, -20.0, 20.0);
  if (++block_filled_ < block_length_) return std::nullopt;
  const double mean = block_sum_ / static_cast<double>(block_length_);
  block_filled_ = 0;
  block_sum_ = 0.0;
  return take_block(mean);
}

}  // namespace veridyn::estimation
