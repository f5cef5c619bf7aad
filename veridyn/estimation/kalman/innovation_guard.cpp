#include "veridyn/estimation/kalman/innovation_guard.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

GuardOptions GuardOptions::read(const StudyTable& table) {
  GuardOptions o;
  o.window_s = table.positive_or("window", "s", o.window_s);
  o.false_alarms_per_hour = table.positive_or("false_alarms_per_hour", "1", o.false_alarms_per_hour);
  o.tolerance = table.positive_or("tolerance", "1", o.tolerance);
  if (!(o.tolerance >= 1.0)) table.fail("tolerance", "must be >= 1");
  if (!(o.false_alarms_per_hour * o.window_s < 360.0)) {
    table.fail("false_alarms_per_hour", "asks for an alarm in more than a tenth of the windows");
  }
  o.return_after_s = table.positive_or("return_after", "s", o.return_after_s);
  return o;
}

void InnovationGuard::restart(double t, bool trusted) noexcept {
  sums_.fill({});
  window_end_ = t + options_.window_s;
  sound_since_ = t;
  if (trusted_ && !trusted) ++reverts_;
  trusted_ = trusted;
  alarm_ = false;
}

void InnovationGuard::add(std::size_t sensor, double nis) noexcept {
  sums_[sensor].sum += nis < kLargestSample ? nis : kLargestSample;  // NaN counts as the largest
  ++sums_[sensor].count;
}

double InnovationGuard::limit(double p, std::size_t n) {
  for (const Cached& c : cache_) {
    if (c.n == n && c.p == p) return c.value;
  }
  Cached& c = cache_[cache_next_++ % cache_.size()];
  c = {p, n, options_.tolerance * numerics::chi_square_quantile(1.0 - p, static_cast<double>(n))};
  return c.value;
}

bool InnovationGuard::advance(double t) {
  if (t < window_end_) return false;
  std::size_t sensors = 0;
  for (const Sum& s : sums_) sensors += s.count > 0 ? 1 : 0;
  const double p = std::min(0.1, options_.false_alarms_per_hour / 3600.0 * options_.window_s) /
                   static_cast<double>(std::max<std::size_t>(sensors, 1));
  constexpr double kSound = 0.01;
  alarm_ = false;
  worst_ = 0.0;
  bool sound = sensors > 0;  // silence is no proof
  for (std::size_t i = 0; i < kMaxSensors; ++i) {
    const Sum& s = sums_[i];
    if (s.count == 0) continue;
    const double ratio = s.sum / limit(p, s.count);
    if (ratio > worst_) {
      worst_ = ratio;
      worst_sensor_ = i;
    }
    alarm_ = alarm_ || ratio > 1.0;
    sound = sound && s.sum <= limit(kSound / static_cast<double>(sensors), s.count);
  }
  sums_.fill({});
  window_end_ += options_.window_s;
  if (!(window_end_ > t)) window_end_ = t + options_.window_s;  // after a gap
  if (alarm_) {
    if (trusted_) ++reverts_;
    trusted_ = false;
  }
  if (!sound) {
    sound_since_ = t;
  } else if (!trusted_ && t - sound_since_ >= options_.return_after_s) {
    trusted_ = true;
  }
  return true;
}

}  // namespace veridyn::estimation
