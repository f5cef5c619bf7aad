#include "veridyn/cueing/washout/fuzzy_washout.hpp"

namespace veridyn::cueing {
namespace {

/// Degrees to which a value is small, middling and large: triangles over 0, 1/2 and 1.
std::array<double, 3> degrees(double value) {
  const double v = std::clamp(value, 0.0, 1.0);
  return {std::max(1.0 - 2.0 * v, 0.0), 1.0 - std::abs(2.0 * v - 1.0), std::max(2.0 * v - 1.0, 0.0)};
}

}  // namespace

double fuzzy_gain(double used, double outward, double boldness, double caution) {
  // Share of the way from bold to cautious, by range in use (rows) and speed outward (columns).
  constexpr double kRules[3][3] = {{0.0, 0.1, 0.4}, {0.2, 0.5, 0.8}, {0.6, 0.9, 1.0}};
  constexpr double kFast = 2.0;  // half of the range in a quarter of a second [1/s]
  const std::array<double, 3> by_place = degrees(used), by_speed = degrees(outward / kFast);
  double share = 0.0;  // the degrees of each add up to one
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) share += by_place[i] * by_speed[j] * kRules[i][j];
  }
  return boldness + share * (caution - boldness);
}

std::vector<Knob> FuzzyDesign::knobs() {
  std::vector<Knob> all = {
      {"onset", "rad/s", {&onset, 1}, "shorter pushes, and less travel", false, 0.3, 6.0},
      {"tilt", "rad/s", {&tilt, 1}, "lasting forces that come earlier, with more of a turn in them", false, 0.5, 12.0},
      {"boldness", "1", {&boldness, 1}, "stronger small motions", false, 1.0, 2.0},
      {"caution", "1", {&caution, 1}, "stronger large motions, and sooner at the limits", true, 0.1, 1.0},
      {"adaptation", "1/s", {&adaptation, 1}, "gains that follow sooner; too far up they pump", false, 0.5, 10.0}};
  shared.add_to(all);
  return all;
}

std::unique_ptr<Washout> FuzzyDesign::make(const Platform& platform) const {
  return std::make_unique<FuzzyWashout>(*this, platform);
}

FuzzyWashout::Pair FuzzyWashout::pair_of(const FuzzyDesign& d, const Platform& platform, Eigen::Index pair) {
  const AxisLimits& shift = platform.limits[shift_axis(pair)];
  const AxisLimits& tilt = platform.limits[tilt_axis(pair)];
  return {.shift_range = 0.5 * (shift.highest - shift.lowest),
          .tilt_range = 0.5 * (tilt.highest - tilt.lowest),
          .shift = ShiftChannel(d.onset, d.shared.zeta, 0.0),
          .low_pass = numerics::CausalFilter(numerics::low_pass(d.tilt, d.shared.zeta)),
          .tilt = {}};
}

FuzzyWashout::FuzzyWashout(const FuzzyDesign& d, const Platform& platform)
    : design_(checked(d)), shared_(d.shared), pairs_{pair_of(d, platform, 0), pair_of(d, platform, 1)} {}

PairedOutput FuzzyWashout::Pair::step(const PairedInput& now, const FuzzyDesign& d, SampleStep step) {
  if (!step) {
    gain = 1.0;
    last_shift = shift_rate = 0.0;
  } else if (*step > 0.0) {
    const double shift_used = shift_range > 0.0 ? last.shift / shift_range : 0.0;
    const double shift_speed = shift_range > 0.0 ? shift_rate / shift_range : 0.0;
    const double tilt_used = tilt_range > 0.0 ? last.tilt / tilt_range : 0.0;
    const double tilt_speed = tilt_range > 0.0 ? last.tilt_rate / tilt_range : 0.0;
    const auto outward = [](double used, double speed) { return used < 0.0 ? -speed : speed; };
    const double desired =
        std::min(fuzzy_gain(std::abs(shift_used), outward(shift_used, shift_speed), d.boldness, d.caution),
                 fuzzy_gain(std::abs(tilt_used), outward(tilt_used, tilt_speed), d.boldness, d.caution));
    gain = desired + (gain - desired) * std::exp(-d.adaptation * *step);
  }
  const ChannelOutput s = shift_range > 0.0 ? shift.step(gain * now(1), step) : ChannelOutput{};
  const ChannelOutput t = tilt.step(cueing::next(low_pass, gain * now(0), step), d.shared.tilt_rate, step);
  if (step && *step > 0.0) shift_rate = (s.place - last_shift) / *step;
  last_shift = s.place;
  return last = {s.place, s.change, t.place, t.change};
}

PlatformCommand FuzzyWashout::next(const VehicleMotion& motion, SampleStep step) {
  PlatformCommand command;
  shared_.add_to(command, motion.acceleration, motion.rate, step);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto pair = static_cast<std::size_t>(i);
    const PairedInput now = design_.shared.force_gain[1 - pair] * paired_input(motion.force, motion.acceleration, i);
    add_paired(command, pairs_[pair].step(now, design_, step), i);
  }
  return command;
}

}  // namespace veridyn::cueing
