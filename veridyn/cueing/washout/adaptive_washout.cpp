#include "veridyn/cueing/washout/adaptive_washout.hpp"

namespace veridyn::cueing {

std::vector<Knob> AdaptiveDesign::knobs() {
  std::vector<Knob> all = {
      {"onset", "rad/s", {&onset, 1}, "shorter pushes, and less travel", false, 0.3, 6.0},
      {"tilt", "rad/s", {&tilt, 1}, "lasting forces that come earlier, with more of a turn in them", false, 0.5, 12.0},
      {"adaptation", "1/s", {&adaptation, 1}, "gains that follow sooner; too far up they pump", false, 0.2, 10.0},
      {"shift_weight", "1", {&shift_weight, 1}, "less travel", true, 0.1, 100.0},
      {"speed_weight", "1", {&speed_weight, 1}, "a calmer platform", true, 0.1, 100.0},
      {"gain_weight", "1", {&gain_weight, 1}, "gains that stay closer to nominal", false, 0.1, 100.0},
      {"most_gain", "1", {&most_gain, 1}, "small motions made larger than they are"}};
  shared.add_to(all);
  return all;
}

std::unique_ptr<Washout> AdaptiveDesign::make(const Platform& platform) const {
  return std::make_unique<AdaptiveWashout>(*this, platform);
}

AdaptiveWashout::AdaptiveWashout(const AdaptiveDesign& d, const Platform& platform)
    : design_(checked(d)), shared_(d.shared) {
  for (Eigen::Index i = 0; i < 2; ++i) {
    const AxisLimits& limits = platform.limits[shift_axis(i)];
    pairs_[i].range = 0.5 * (limits.highest - limits.lowest);
  }
}

std::array<Eigen::Vector2d, 2> AdaptiveWashout::gains() const {
  return {pairs_[0].state.segment<2>(kShiftGain), pairs_[1].state.segment<2>(kShiftGain)};
}

double AdaptiveWashout::Pair::shift_acceleration(const State& x, const PairedInput& u, const AdaptiveDesign& d) const {
  if (range == 0.0) return 0.0;
  return std::clamp(x(kShiftGain), 0.0, d.most_gain) * u(1) - 2.0 * d.onset * x(kSpeed) - d.onset * d.onset * x(kShift);
}

AdaptiveWashout::State AdaptiveWashout::Pair::rate(const State& x, const PairedInput& u,
                                                   const AdaptiveDesign& d) const {
  const double p2 = std::clamp(x(kTiltGain), 0.0, d.most_gain);
  const double acceleration = shift_acceleration(x, u, d);
  const double off = std::asin(std::clamp(u(0) / kGravity, -1.0, 1.0)) - x(kTilt);
  const double desired = p2 * d.tilt * off, limit = d.shared.tilt_rate;
  const bool limited = std::abs(desired) > limit;
  const double error = u(0) - acceleration - kGravity * std::sin(x(kTilt));
  // de/dp1, de/dp2
  const double along_shift =
      range == 0.0 ? 0.0 : -(u(1) - 2.0 * d.onset * x(kSpeedAlong) - d.onset * d.onset * x(kShiftAlong));
  const double along_tilt = -kGravity * std::cos(x(kTilt)) * x(kTiltAlong);
  const double over = range > 0.0 ? 1.0 / (range * range) : 0.0;
  const double gradient_1 = error * along_shift + d.shift_weight * over * x(kShift) * x(kShiftAlong) +
                            d.speed_weight * over * x(kSpeed) * x(kSpeedAlong) + d.gain_weight * (x(kShiftGain) - 1.0);
  const double gradient_2 = error * along_tilt + d.gain_weight * (x(kTiltGain) - 1.0);
  const double travel =
      over * (d.shift_weight * x(kShiftAlong) * x(kShiftAlong) + d.speed_weight * x(kSpeedAlong) * x(kSpeedAlong));
  State rate;
  rate(kShift) = x(kSpeed);
  rate(kSpeed) = acceleration;
  rate(kTilt) = std::clamp(desired, -limit, limit);
  rate(kShiftGain) = -d.adaptation * gradient_1 / (1.0 + along_shift * along_shift + travel);
  rate(kTiltGain) = -d.adaptation * gradient_2 / (1.0 + along_tilt * along_tilt);
  rate(kShiftAlong) = x(kSpeedAlong);
  rate(kSpeedAlong) = -along_shift;
  // Where the rate is limited the gain changes nothing, and what it has changed is corrected like any deviation.
  rate(kTiltAlong) = (limited ? 0.0 : d.tilt * off) - d.tilt * std::max(p2, 0.1) * x(kTiltAlong);
  return rate;
}

PairedOutput AdaptiveWashout::Pair::step(const PairedInput& now, const AdaptiveDesign& d, SampleStep step) {
  const double before = state(kTilt);
  if (step) {
    state = integrated(state, input, now, *step, [&](const State& x, const PairedInput& u) { return rate(x, u, d); });
  } else {
    state.setZero();
    state(kShiftGain) = state(kTiltGain) = 1.0;
  }
  for (const Eigen::Index gain : {kShiftGain, kTiltGain}) state(gain) = std::clamp(state(gain), 0.0, d.most_gain);
  input = now;
  return {state(kShift), shift_acceleration(state, now, d), state(kTilt),
          step && *step > 0.0 ? (state(kTilt) - before) / *step : 0.0};
}

PlatformCommand AdaptiveWashout::next(const VehicleMotion& motion, SampleStep step) {
  PlatformCommand command;
  const Eigen::Vector3d& a = motion.acceleration;
  shared_.add_to(command, a, motion.rate, step);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto pair = static_cast<std::size_t>(i);
    const PairedInput now = design_.shared.force_gain[1 - pair] * paired_input(motion.force, a, i);
    add_paired(command, pairs_[pair].step(now, design_, step), i);
  }
  return command;
}

}  // namespace veridyn::cueing
