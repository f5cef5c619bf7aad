#include "veridyn/cueing/washout/moving_origin_washout.hpp"

#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"

namespace veridyn::cueing {

std::vector<Knob> MovingOriginDesign::knobs() {
  std::vector<Knob> all = {
      {"onset", "rad/s", {&onset, 1}, "shorter pushes, and less travel", false, 0.3, 6.0},
      {"tilt", "rad/s", {&tilt, 1}, "lasting forces that come earlier, with more of a turn in them", false, 0.5, 12.0},
      {"fades", "s", {&fades, 1}, "room made for longer pushes", false, 0.3, 5.0},
      {"use", "1", {&use, 1}, "less room kept at the ends"},
      {"origin_force", "m/s^2", {&origin_force, 1}, "room made sooner; above 0.17 it is felt"}};
  shared.add_to(all);
  return all;
}

std::unique_ptr<Washout> MovingOriginDesign::make(const Platform& platform) const {
  return std::make_unique<MovingOriginWashout>(*this, platform);
}

MovingOriginWashout::Pair MovingOriginWashout::pair_of(const MovingOriginDesign& d, const Platform& platform,
                                                       Eigen::Index pair) {
  const AxisLimits& limits = platform.limits[shift_axis(pair)];
  return {.range = 0.5 * (limits.highest - limits.lowest),
          .low_pass = numerics::CausalFilter(numerics::low_pass(d.tilt, d.shared.zeta)),
          .tilt = {}};
}

MovingOriginWashout::MovingOriginWashout(const MovingOriginDesign& d, const Platform& platform)
    : design_(checked(d)), shared_(d.shared), pairs_{pair_of(d, platform, 0), pair_of(d, platform, 1)} {
  Eigen::Matrix3d fading;
  fading << 0.0, 1.0, 0.0, -d.onset * d.onset, -2.0 * d.shared.zeta * d.onset, 1.0, 0.0, 0.0, -1.0 / d.fades;
  for (int k = 0; k < kMoments; ++k) {
    const double t = 3.0 / d.onset * (k + 1) / kMoments;
    foreseen_[k] = numerics::matrix_exponential(Eigen::MatrixXd(t * fading)).row(0);
  }
}

double MovingOriginWashout::excess(const Pair& pair, double acceleration) const {
  const Eigen::Vector3d now(pair.state(0) - pair.state(2), pair.state(1) - pair.state(3), acceleration);
  double lowest = now(0), highest = now(0);
  for (const auto& row : foreseen_) {
    const double then = row * now;
    lowest = std::min(lowest, then);
    highest = std::max(highest, then);
  }
  const double most = design_.use * pair.range;
  return std::max(highest - most, 0.0) + std::min(lowest + most, 0.0);
}

PairedOutput MovingOriginWashout::Pair::step(const PairedInput& now, const MovingOriginWashout& of, SampleStep step) {
  const MovingOriginDesign& d = of.design_;
  const double w = d.onset, zeta = d.shared.zeta;
  const auto acceleration = [&](const Eigen::Vector4d& x, double a) {
    return range > 0.0 ? a - 2.0 * zeta * w * (x(1) - x(3)) - w * w * (x(0) - x(2)) : 0.0;
  };
  if (!step) {
    state.setZero();
  } else if (range > 0.0) {
    constexpr double kHome = 0.7;  // [rad/s]
    const double target = std::clamp(-of.excess(*this, now(1)), -0.5 * range, 0.5 * range);
    state = integrated(state, input, now(1), *step, [&](const Eigen::Vector4d& x, double a) {
      const double origin =
          std::clamp(-2.0 * kHome * x(3) - kHome * kHome * (x(2) - target), -d.origin_force, d.origin_force);
      return Eigen::Vector4d(x(1), acceleration(x, a), x(3), origin);
    });
  }
  input = now(1);
  const ChannelOutput t = tilt.step(cueing::next(low_pass, now(0), step), d.shared.tilt_rate, step);
  return {state(0), acceleration(state, now(1)), t.place, t.change};
}

PlatformCommand MovingOriginWashout::next(const VehicleMotion& motion, SampleStep step) {
  PlatformCommand command;
  shared_.add_to(command, motion.acceleration, motion.rate, step);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto pair = static_cast<std::size_t>(i);
    const PairedInput now = design_.shared.force_gain[1 - pair] * paired_input(motion.force, motion.acceleration, i);
    add_paired(command, pairs_[pair].step(now, *this, step), i);
  }
  return command;
}

}  // namespace veridyn::cueing
