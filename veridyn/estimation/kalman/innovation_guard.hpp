#pragma once

#include <array>
#include <cstddef>

#include "veridyn/core/study.hpp"

namespace veridyn::estimation {

/// When the model of a filter is no longer trusted, and when it is trusted again.
struct GuardOptions {
  double window_s = 1.0;
  double false_alarms_per_hour = 0.1;
  double tolerance = 1.3;
  double return_after_s = 10.0;

  [[nodiscard]] static const KeyTable<GuardOptions>& keys();
};

/// Watches the normalised innovations squared (NIS, nu^2 / S) of a filter, sensor by sensor.
///
/// Of a filter with the right model they are independent and chi-square with one degree of freedom each (Bar-Shalom, Li
/// & Kirubarajan 2001, section 5.4). In windows that follow each other without overlap, the sum of n of a sensor's is
/// compared with tolerance times the chi-square quantile of n degrees of freedom at 1 - p, p = false_alarms_per_hour
/// window / sensors: with tolerance 1 a sound filter is distrusted that often, with more less often. One sensor above
/// its limit ends the trust. It returns after `return_after_s` in which every sensor stayed below tolerance times the
/// 99 % quantile: a lower limit, so that the verdict does not flutter.
///
/// A wrong model is noticed at the end of the first window that lies wholly after the change, hence within two windows.
/// Does not allocate.
class InnovationGuard {
 public:
  static constexpr std::size_t kMaxSensors = 12;
  /// A single sample counts at most this much, so that one outlier is not a wrong model.
  static constexpr double kLargestSample = 25.0;

  explicit InnovationGuard(const GuardOptions& options = {}) : options_(options) {}

  /// Starts, or starts again, at time `t` [s], with or without trust.
  void restart(double t, bool trusted) noexcept;
  /// A normalised squared innovation of a sensor (0 .. kMaxSensors - 1).
  void add(std::size_t sensor, double nis) noexcept;
  /// To time `t`: judges the window when it has ended. Returns whether a window was judged.
  bool advance(double t);

  [[nodiscard]] bool trusted() const noexcept { return trusted_; }
  /// Whether the last judged window was above a limit.
  [[nodiscard]] bool alarm() const noexcept { return alarm_; }
  /// Of the last judged window: the largest ratio of a sum to its limit, and whose it was.
  [[nodiscard]] double worst() const noexcept { return worst_; }
  [[nodiscard]] std::size_t worst_sensor() const noexcept { return worst_sensor_; }
  /// Changes from trust to distrust so far.
  [[nodiscard]] std::size_t reverts() const noexcept { return reverts_; }

 private:
  [[nodiscard]] double limit(double p, std::size_t n);

  struct Sum {
    double sum = 0.0;
    std::size_t count = 0;
  };
  struct Cached {
    double p = -1.0;
    std::size_t n = 0;
    double value = 0.0;
  };
  GuardOptions options_;
  std::array<Sum, kMaxSensors> sums_{};
  std::array<Cached, 16> cache_{};  ///< quantiles cost microseconds, and the sample counts hardly change
  std::size_t cache_next_ = 0;
  double window_end_ = 0.0;
  double sound_since_ = 0.0;
  bool trusted_ = true;
  bool alarm_ = false;
  double worst_ = 0.0;
  std::size_t worst_sensor_ = 0;
  std::size_t reverts_ = 0;
};

}  // namespace veridyn::estimation
