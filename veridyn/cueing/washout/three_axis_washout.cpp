#include "veridyn/cueing/washout/three_axis_washout.hpp"

#include <algorithm>

namespace veridyn::cueing {

using numerics::CausalFilter;

std::vector<Knob> ThreeAxisDesign::knobs() {
  std::vector<Knob> all = {
      {"bound", "m/s^2", bound, "harder hits; below it small motions stay as they are"},
      {"instant", "1", {&instant, 1}, "braking and steering felt at once, with more of a turn in them", true, 0.0, 1.5},
      {"sustained", "1", {&sustained, 1}, "stronger lasting forces and slopes", true, 0.1, 1.5},
      {"onset", "rad/s", {&onset, 1}, "shorter onsets", false, 0.5, 10.0},
      {"onset_rate", "rad/s", {&onset_rate, 1}, "sharper onsets; above 3 deg/s the turning is felt"},
      {"tilt", "rad/s", {&tilt, 1}, "lasting forces that come earlier", false, 0.5, 12.0},
      {"heave_jerk", "m/s^3", {&heave_jerk, 1}, "harder bumps"}};
  shared.add_to(all);
  return all;
}

std::unique_ptr<Washout> ThreeAxisDesign::make(const Platform&) const {
  return std::make_unique<ThreeAxisWashout>(*this);
}

ThreeAxisWashout::ThreeAxisWashout(const ThreeAxisDesign& d)
    : design_(checked(d)),
      shared_(d.shared),
      high_pass_{CausalFilter(numerics::high_pass(d.onset, d.shared.zeta)),
                 CausalFilter(numerics::high_pass(d.onset, d.shared.zeta))},
      low_pass_{CausalFilter(numerics::low_pass(d.tilt, d.shared.zeta)),
                CausalFilter(numerics::low_pass(d.tilt, d.shared.zeta))} {}

PlatformCommand ThreeAxisWashout::next(const VehicleMotion& motion, SampleStep step) {
  PlatformCommand command;
  Eigen::Vector3d a = motion.acceleration;
  a.z() = std::clamp(a.z(), -design_.bound[2], design_.bound[2]);
  heave_ = step ? step_towards(heave_, a.z(), design_.heave_jerk * *step) : a.z();
  a.z() = heave_;
  shared_.add_to(command, a, motion.rate, step);
  const Eigen::Vector2d force = tilted_force(motion.force);
  for (std::size_t i = 0; i < 2; ++i) {
    const double most = design_.bound[1 - i];
    const double f = std::clamp(design_.shared.force_gain[1 - i] * force(i), -most, most);
    const ChannelOutput onset =
        onset_[i].step(cueing::next(high_pass_[i], design_.instant * f, step), design_.onset_rate, step);
    const ChannelOutput slope =
        slope_[i].step(cueing::next(low_pass_[i], design_.sustained * f, step), design_.shared.tilt_rate, step);
    command.angle(i) += onset.place + slope.place;
    command.rate(i) += onset.change + slope.change;
  }
  return command;
}

}  // namespace veridyn::cueing
