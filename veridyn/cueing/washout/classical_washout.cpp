#include "veridyn/cueing/washout/classical_washout.hpp"

namespace veridyn::cueing {

using numerics::CausalFilter;

std::vector<Knob> ClassicalDesign::knobs() {
  return {
      {"force_gain", "1", force_gain, "stronger pushes, and sooner at the platform's limits", true, 0.1, 1.2},
      {"rate_gain", "1", rate_gain, "the vehicle's own roll, pitch and yaw more like the real ones", true, 0.0, 1.2},
      {"onset", "rad/s", onset, "shorter pushes that end sooner, and less travel", false, 0.3, 6.0},
      {"recentre", "rad/s", recentre, "a platform that comes back to its middle by itself", true},
      {"tilt", "rad/s", {&tilt, 1}, "lasting forces that come earlier, with more of a turn in them", false, 0.5, 12.0},
      {"tilt_rate", "rad/s", {&tilt_rate, 1}, "lasting forces that come earlier; above 3 deg/s the tilting is felt"},
      {"turn", "rad/s", turn, "shorter turns that come back sooner", false, 0.3, 6.0},
      {"zeta", "1", {&zeta, 1}, "softer ends of pushes and turns; below 0.7 they swing back"},
  };
}

std::unique_ptr<Washout> ClassicalDesign::make(const Platform&) const {
  return std::make_unique<ClassicalWashout>(*this);
}
std::unique_ptr<WashoutDesign> ClassicalDesign::clone() const { return std::make_unique<ClassicalDesign>(*this); }

ClassicalWashout::ClassicalWashout(const ClassicalDesign& d)
    : design_(checked(d)),
      shift_{ShiftChannel(d.onset[0], d.zeta, d.recentre[0]), ShiftChannel(d.onset[1], d.zeta, d.recentre[1]),
             ShiftChannel(d.onset[2], d.zeta, d.recentre[2])},
      turn_{TurnChannel(d.turn[0], d.zeta), TurnChannel(d.turn[1], d.zeta), TurnChannel(d.turn[2], d.zeta)},
      low_pass_{CausalFilter(numerics::low_pass(d.tilt, d.zeta)), CausalFilter(numerics::low_pass(d.tilt, d.zeta))} {}

PlatformCommand ClassicalWashout::next(const VehicleMotion& motion, SampleStep step) {
  const Eigen::Vector3d& a = motion.acceleration;
  Eigen::Vector3d shift, change;
  PlatformCommand command;
  for (std::size_t i = 0; i < 3; ++i) {
    const ChannelOutput s = shift_[i].step(design_.force_gain[i] * a(i), step);
    shift(i) = s.place;
    change(i) = s.change;
    const ChannelOutput t = turn_[i].step(design_.rate_gain[i] * motion.rate(i), step);
    command.angle(i) = t.place;
    command.rate(i) = t.change;
  }
  command.shift = shift_from_frd(shift);
  command.acceleration = shift_from_frd(change);
  const Eigen::Vector2d force = tilted_force(motion.force);
  for (std::size_t i = 0; i < 2; ++i) {
    const double gain = design_.force_gain[1 - i];
    const double lasting = cueing::next(low_pass_[i], gain * force(i), step);
    const ChannelOutput t = tilt_[i].step(lasting, design_.tilt_rate, step);
    command.angle(i) += t.place;
    command.rate(i) += t.change;
  }
  return command;
}

}  // namespace veridyn::cueing
