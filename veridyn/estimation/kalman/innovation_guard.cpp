#include "veridyn/estimation/kalman/innovation_guard.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

const KeyTable<GuardOptions>& GuardOptions::keys() {
  using O = GuardOptions;
  static const auto table =
      KeyTable<O>("guard", "When the model of a guarded filter is no longer trusted, and when it is again.")
          .number("window", &O::window_s, "s", kPositive, "over which squared innovations are summed")
          .number("false_alarms_per_hour", &O::false_alarms_per_hour, "1", kPositive,
                  "of a sound model: sets the chi-square limit")
          .number("tolerance", &O::tolerance, "1", {.low = 1.0},
                  "on the limit: no model is exact, and a variance 30 % too large does no harm")
          .number("return_after", &O::return_after_s, "s", kPositive,
                  "of sound windows in a row before the model is trusted again")
          .check([](const StudyTable& t, O& o) {
            if (!(o.false_alarms_per_hour * o.window_s < 360.0))
              t.fail("false_alarms_per_hour", "asks for an alarm in more than a tenth of the windows");
          });
  return table;
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
