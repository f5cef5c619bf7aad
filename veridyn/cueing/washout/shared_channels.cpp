#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

void SharedKnobs::add_to(std::vector<Knob>& knobs) {
  knobs.push_back(
      {"force_gain", "1", force_gain, "stronger pushes, and sooner at the platform's limits", true, 0.1, 1.2});
  knobs.push_back(
      {"rate_gain", "1", rate_gain, "the vehicle's own roll, pitch and yaw more like the real ones", true, 0.0, 1.2});
  knobs.push_back({"turn", "rad/s", turn, "shorter turns that come back sooner", false, 0.3, 6.0});
  knobs.push_back(
      {"heave_onset", "rad/s", {&heave_onset, 1}, "bumps more than crests, and less travel", false, 0.3, 8.0});
  knobs.push_back(
      {"heave_recentre", "rad/s", {&heave_recentre, 1}, "heave that comes back to its middle sooner", true});
  knobs.push_back(
      {"tilt_rate", "rad/s", {&tilt_rate, 1}, "lasting forces that come earlier; above 3 deg/s the tilting is felt"});
  knobs.push_back({"zeta", "1", {&zeta, 1}, "softer ends of pushes and turns; below 0.7 they swing back"});
}

SharedChannels::SharedChannels(const SharedKnobs& k)
    : heave_gain_(k.force_gain[2]),
      rate_gain_(k.rate_gain),
      heave_(k.heave_onset, k.zeta, k.heave_recentre),
      turn_{TurnChannel(k.turn[0], k.zeta), TurnChannel(k.turn[1], k.zeta), TurnChannel(k.turn[2], k.zeta)} {}

void SharedChannels::add_to(PlatformCommand& command, const Eigen::Vector3d& a, const Eigen::Vector3d& rate,
                            SampleStep step) {
  const ChannelOutput heave = heave_.step(-heave_gain_ * a.z(), step);
  command.shift.z() = heave.place;
  command.acceleration.z() = heave.change;
  for (std::size_t i = 0; i < 3; ++i) {
    const ChannelOutput t = turn_[i].step(rate_gain_[i] * rate(i), step);
    command.angle(i) += t.place;
    command.rate(i) += t.change;
  }
}

PairedInput paired_input(const Eigen::Vector3d& force, const Eigen::Vector3d& a, Eigen::Index pair) {
  return {tilted_force(force)(pair), tilted_force(a)(pair)};
}

void add_paired(PlatformCommand& command, const PairedOutput& o, Eigen::Index pair) {
  const Eigen::Index axis = 1 - pair;
  const double sign = pair == 0 ? -1.0 : 1.0;
  command.shift(axis) = sign * o.shift;
  command.acceleration(axis) = sign * o.acceleration;
  command.angle(pair) += o.tilt;
  command.rate(pair) += o.tilt_rate;
}

}  // namespace veridyn::cueing
