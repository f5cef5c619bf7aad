#include "veridyn/cueing/washout/tilt_washout.hpp"

namespace veridyn::cueing {

std::vector<Knob> TiltDesign::knobs() {
  return {{"force_gain", "1", force_gain, "stronger lasting forces", true, 0.1, 1.2},
          {"tilt", "rad/s", {&tilt, 1}, "forces that come earlier, with more of a turn in them", false, 0.5, 20.0},
          {"zeta", "1", {&zeta, 1}, "softer beginnings and ends"},
          {"tilt_rate", "rad/s", {&tilt_rate, 1}, "forces that come earlier; above 3 deg/s the tilting is felt"}};
}

std::unique_ptr<Washout> TiltDesign::make(const Platform&) const { return std::make_unique<TiltWashout>(*this); }

TiltWashout::TiltWashout(const TiltDesign& d)
    : design_(checked(d)),
      low_pass_{numerics::CausalFilter(numerics::low_pass(d.tilt, d.zeta)),
                numerics::CausalFilter(numerics::low_pass(d.tilt, d.zeta))} {}

PlatformCommand TiltWashout::next(const VehicleMotion& motion, SampleStep step) {
  PlatformCommand command;
  const Eigen::Vector2d force = tilted_force(motion.force);
  for (std::size_t i = 0; i < 2; ++i) {
    const double lasting = cueing::next(low_pass_[i], design_.force_gain[1 - i] * force(i), step);
    const ChannelOutput t = tilt_[i].step(lasting, design_.tilt_rate, step);
    command.angle(i) = t.place;
    command.rate(i) = t.change;
  }
  return command;
}

}  // namespace veridyn::cueing
