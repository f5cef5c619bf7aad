#include "veridyn/cueing/washout/washout_channels.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::cueing {
namespace {

using numerics::TransferFunction;

TransferFunction recentred(const TransferFunction& t, double omega) {
  return omega > 0.0 ? t * numerics::high_pass(omega) : t;
}

/// The denominator of a filter of second order.
std::vector<double> second_order(double omega, double zeta) { return {1.0, 2.0 * zeta * omega, omega * omega}; }

}  // namespace

ShiftChannel::ShiftChannel(double omega, double zeta, double recentre)
    : place_(recentred({{1.0}, second_order(omega, zeta)}, recentre)),
      change_(recentred(numerics::high_pass(omega, zeta), recentre)) {}

TurnChannel::TurnChannel(double omega, double zeta)
    : place_(TransferFunction{{1.0, 0.0}, second_order(omega, zeta)}), change_(numerics::high_pass(omega, zeta)) {}

double step_towards(double from, double to, double most) { return from + std::clamp(to - from, -most, most); }

ChannelOutput TiltCoordination::step(double force, double most_rate, SampleStep step) {
  if (!step) {
    tilt_ = 0.0;
    return {};
  }
  const double before = tilt_;
  tilt_ = step_towards(before, std::asin(std::clamp(force / kGravity, -1.0, 1.0)), most_rate * *step);
  return {tilt_, *step > 0.0 ? (tilt_ - before) / *step : 0.0};
}

}  // namespace veridyn::cueing
