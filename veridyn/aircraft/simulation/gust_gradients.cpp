#include "veridyn/aircraft/simulation/gust_gradients.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_systems/washout.hpp"

namespace veridyn::aircraft {

double gust_roll_length(double span) { return 4.0 * span / kPi; }

double gust_roll_sigma(const DrydenSettings& settings, double span) {
  const double length = gust_roll_length(span);
  // The integral of the spectrum: that of 1/(1 + (l W)^2) is pi/(2 l).
  return settings.sigma_w * std::sqrt(0.4 * kPi / (settings.Lw * length) * std::cbrt(settings.Lw / length));
}

GustGradients::GustGradients(const DrydenSettings& settings, double span, numerics::RandomStream random)
    : roll_length_(gust_roll_length(span)),
      yaw_length_(3.0 * span / kPi),
      roll_sigma_(gust_roll_sigma(settings, span)),
      random_(random) {
  p_ = random_.normal();
}

void GustGradients::advance(double step, double Va, const std::array<double, 3>& before,
                            const std::array<double, 3>& after) {
  const double distance = step * std::max(Va, 0.0);
  const double theta = distance / roll_length_;
  p_ = std::exp(-theta) * p_ + std::sqrt(-std::expm1(-2.0 * theta)) * random_.normal();
  v_ = numerics::washed_out(v_, after[1] - before[1], distance / yaw_length_);
  w_ = numerics::washed_out(w_, after[2] - before[2], theta);
}

std::array<double, 3> GustGradients::rates() const { return {roll_sigma_ * p_, w_ / roll_length_, -v_ / yaw_length_}; }

}  // namespace veridyn::aircraft
