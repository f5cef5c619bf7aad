#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace veridyn::live {

/// Keeps crashes and landings off the platform: each component follows what comes in at no more than a rate of change.
/// What changes more slowly passes as it is; a lasting change of so much is late by that much over the rate, which
/// bounds the delay; of a spike passes what the rate allows in its duration. Nothing is allocated.
class SpikeFilter {
 public:
  /// @param rate most change of a component, above 0 [unit/s]; infinite: everything passes
  explicit SpikeFilter(double rate) : rate_(rate) {}

  void reset() { last_.reset(); }
  /// @param step since the last one [s]; not above 0 or not finite: none
  Eigen::Vector3d step(const Eigen::Vector3d& value, double step) {
    if (!value.allFinite()) return last_.value_or(value);
    if (!last_) return *(last_ = value);
    if (!(step > 0.0) || !std::isfinite(step)) return *last_;
    const double most = rate_ * step;
    for (int i = 0; i < 3; ++i) {
      const double off = value(i) - (*last_)(i);
      (*last_)(i) = std::abs(off) > most ? (*last_)(i) + std::copysign(most, off) : value(i);
    }
    return *last_;
  }

 private:
  double rate_;
  std::optional<Eigen::Vector3d> last_;
};

}  // namespace veridyn::live
