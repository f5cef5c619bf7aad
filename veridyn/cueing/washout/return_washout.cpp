#include "veridyn/cueing/washout/return_washout.hpp"

namespace veridyn::cueing {

std::vector<Knob> ReturnDesign::knobs() {
  std::vector<Knob> all = {
      {"onset", "rad/s", {&onset, 1}, "shorter pushes, and less travel", false, 0.3, 6.0},
      {"threshold", "m/s^2", {&threshold, 1}, "the platform returns to its rest position more often", false, 0.05, 0.5},
      {"home", "rad/s", {&home, 1}, "a platform that returns to neutral sooner", false, 0.5, 5.0},
      {"home_force", "m/s^2", {&home_force, 1}, "a faster return to neutral; above 0.17 it is felt"}};
  shared.add_to(all);
  return all;
}

std::unique_ptr<Washout> ReturnDesign::make(const Platform& platform) const {
  return std::make_unique<ReturnWashout>(*this, platform);
}

ReturnWashout::ReturnWashout(const ReturnDesign& d, const Platform& platform) : design_(checked(d)), shared_(d.shared) {
  for (Eigen::Index i = 0; i < 2; ++i) {
    const AxisLimits& axis = platform.limits[shift_axis(i)];
    if (axis.moves()) pairs_[i].reach = 0.8 * std::min(-axis.lowest, axis.highest);
  }
}

PairedOutput ReturnWashout::Pair::step(const PairedInput& now, const ReturnDesign& d, SampleStep step) {
  const double onset = d.onset, zeta = d.shared.zeta, home = d.home;
  // From one mode to the other over a third of the threshold, so that it does not matter when a sample is taken.
  const auto onset_share = [&](const PairedInput& u) {
    return std::clamp((std::abs(u(0)) / d.threshold - 1.0) / 0.3 + 0.5, 0.0, 1.0);
  };
  if (!step) {
    state.setZero();
    input.setZero();
  }
  // A speed back that half of the force can brake, critically damped close to neutral; more force only where the speed
  // would otherwise not end within reach.
  const auto back = [&](double off, double speed) {
    const double near = d.home_force / home;
    const double desired = std::copysign(std::sqrt(near * near + d.home_force * std::abs(off)) - near, -off);
    const double room = std::max(reach - std::copysign(1.0, speed) * off, 0.1 * reach);
    const double force = std::max(d.home_force, speed * speed / (2.0 * room));
    return std::clamp(2.0 * home * (desired - speed), -force, force);
  };
  const auto shift_acceleration = [&](const Eigen::Vector4d& x, const PairedInput& u) {
    if (reach == 0.0) return 0.0;
    const double share = onset_share(u), passed = u(1) - 2.0 * zeta * onset * x(3) - onset * onset * x(2);
    return share * (passed + back(x(0) - x(2), x(1) - x(3))) + (1.0 - share) * back(x(0), x(1));
  };
  const auto rate = [&](const Eigen::Vector4d& x, const PairedInput& u) {
    const double passed = u(1) - 2.0 * zeta * onset * x(3) - onset * onset * x(2);
    return Eigen::Vector4d(x(1), shift_acceleration(x, u), x(3), passed);
  };
  if (step) state = integrated(state, input, now, *step, rate);
  input = now;
  const double shifted = shift_acceleration(state, now);
  const ChannelOutput t = tilt.step(onset_share(now) * (now(0) - shifted), d.shared.tilt_rate, step);
  return {state(0), shifted, t.place, t.change};
}

PlatformCommand ReturnWashout::next(const VehicleMotion& motion, SampleStep step) {
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
