#include "veridyn/estimation/recursive/parameter_watch.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/option_check.hpp"

namespace veridyn::estimation {
namespace {

/// No block adds more of a threshold than this.
constexpr double kMostOfThreshold = 0.6;
/// Times the power of the regressor's noise from which driving is excited.
constexpr double kExcited = 10.0;
/// Over which its power is known [s].
constexpr double kPowerMemory = 5.0;
/// Standard deviations of S beyond which a block counts as one of so many.
constexpr double kLargest = 3.0;

}  // namespace

void ParameterWatchOptions::validate() const {
  const OptionCheck require("parameter_watch");
  const auto check = [&](bool good, const char* name, double value, const char* rule) {
    require(good && std::isfinite(value), name, value, rule);
  };
  check(share >= 0.0, "share", share, ">= 0");
  check(block_s > 0.0, "block_s", block_s, "> 0");
  check(learn_s >= 10.0 * block_s, "learn_s", learn_s, "at least 10 blocks");
  check(memory_s >= learn_s, "memory_s", memory_s, "at least learn_s");
  check(settle_s >= 0.0, "settle_s", settle_s, ">= 0");
  check(false_alarm_interval_s >= 20.0 * block_s, "false_alarm_interval_s", false_alarm_interval_s,
        "at least 20 blocks");
}

ParameterWatch::ParameterWatch(const ParameterWatchOptions& options, double rate_Hz)
    : options_(options), rate_Hz_(rate_Hz) {
  options_.validate();
  block_rows_ = std::max(1.0, std::round(options_.block_s * rate_Hz));
  const double block_s = block_rows_ / rate_Hz;
  learn_blocks_ = std::ceil(options_.learn_s / block_s);
  memory_blocks_ = options_.memory_s / block_s;
  settle_blocks_ = std::ceil(options_.settle_s / block_s);
  constexpr double kSums = 2.0;
  threshold_ = std::log(kSums * options_.false_alarm_interval_s / block_s);
}

double ParameterWatch::suspicion() const { return std::max(up_.value, down_.value) / threshold_; }

void ParameterWatch::add(Sum& sum, double d, double variance) {
  if (sum.value <= 0.0) sum = {.since_s = began_s_};
  const double ratio = (d * S_ - 0.5 * d * d * I_) / variance;
  sum.value = std::max(0.0, sum.value + std::min(ratio, kMostOfThreshold * threshold_));
  sum.S += S_;
  sum.I += I_;
}

/// The variance of S is taken as proportional to I.
void ParameterWatch::learn() {
  blocks_ += 1.0;
  const double share = 1.0 / std::min(blocks_, memory_blocks_);
  double square = S_ * S_;
  // A change that is not found yet is no noise.
  if (watching()) square = std::min(square, kLargest * kLargest * mean_square_ / mean_I_ * I_);
  mean_square_ += share * (square - mean_square_);
  mean_I_ += share * (I_ - mean_I_);
}

std::optional<Change> ParameterWatch::take_block(double theta) {
  if (pause_blocks_ > 0.0) {
    pause_blocks_ -= 1.0;
    return std::nullopt;
  }
  // The block too: where lively driving ends the power is still that of before.
  if (!(std::min(power_, I_ / rows_) > kExcited * noise_)) return std::nullopt;
  std::optional<Change> change;
  if (watching() && mean_square_ > 0.0) {
    const double variance = mean_square_ / mean_I_;
    add(up_, options_.share * theta, variance);
    add(down_, -options_.share / (1.0 + options_.share) * theta, variance);
    const Sum& larger = up_.value >= down_.value ? up_ : down_;
    if (larger.value > threshold_)
      change = Change{.kind = ChangeKind::kParameter,
                      .detected_s = last_s_,
                      .began_s = larger.since_s,
                      .shift = larger.S / (larger.I * theta)};
  }
  if (change) {
    pause();
    return change;
  }
  learn();
  return change;
}

void ParameterWatch::pause() {
  up_ = down_ = {};
  pause_blocks_ = settle_blocks_;
}

std::optional<Change> ParameterWatch::update(double time_s, double x, double innovation, double theta,
                                             const RowNoise& noise) {
  if (!std::isfinite(time_s) || !std::isfinite(x) || !std::isfinite(innovation) || !std::isfinite(theta))
    return std::nullopt;
  // A block does not go over a hole.
  if (rows_ > 0.0 && !(std::abs(time_s - last_s_) <= 1.5 / rate_Hz_)) rows_ = S_ = I_ = 0.0;
  if (rows_ == 0.0) began_s_ = time_s;
  last_s_ = time_s;
  rows_ += 1.0;
  power_rows_ = std::min(power_rows_ + 1.0, kPowerMemory * rate_Hz_);
  power_ += (x * x - power_) / power_rows_;
  noise_ += (noise.regressor - noise_) / power_rows_;
  S_ += x * innovation - (power_ > 0.0 ? noise.shared * x * x / power_ : 0.0);
  I_ += x * x;
  if (rows_ < block_rows_) return std::nullopt;
  const std::optional<Change> change = take_block(theta);
  rows_ = S_ = I_ = 0.0;
  return change;
}

}  // namespace veridyn::estimation
