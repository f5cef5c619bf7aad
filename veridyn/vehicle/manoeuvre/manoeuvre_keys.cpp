#include "veridyn/vehicle/manoeuvre/manoeuvre_keys.hpp"

#include <fmt/format.h>

namespace veridyn::vehicle {
namespace {

template <typename Keys>
KeyTable<Keys> table_of(const std::string& manoeuvres) {
  return KeyTable<Keys>("drive", fmt::format("With `manoeuvre = {}`:", manoeuvres));
}

/// With amplitude and start.
template <typename Keys>
KeyTable<Keys> steered(const std::string& manoeuvres) {
  return table_of<Keys>(manoeuvres)
      .number("amplitude", &Keys::amplitude, "rad", between(-kPi / 2, kPi / 2),
              "steer at the road wheels, left positive")
      .number("start", &Keys::start, "s", kAnyNumber, "when the steering begins");
}

/// The driver of a path or of a course between cones (MacAdam 1981).
template <typename Keys>
KeyTable<Keys> driven(KeyTable<Keys> table) {
  using D = PreviewDriverOptions;
  const auto of = [](auto member) { return [member](Keys& keys) -> double& { return keys.driver.*member; }; };
  return table.number("preview_time", of(&D::preview_time), "s", kPositive, "how far ahead the driver looks")
      .number("delay", of(&D::delay), "s", kAnyNumber, "between seeing and steering")
      .number("lag", of(&D::lag), "s", kAnyNumber, "of the arms, a first order")
      .number("max_steer", of(&D::max_steer), "rad", kPositive, "at the road wheels")
      .number("max_steer_rate", of(&D::max_steer_rate), "rad/s", kPositive, "at the road wheels");
}

KeyTable<ConesKeys> between_cones(KeyTable<ConesKeys> table) {
  using K = ConesKeys;
  table.number("vehicle_width", &K::vehicle_width, "m", kPositive, "of the body")
      .otherwise("7/6 of the track")
      .number("front_overhang", &K::front_overhang, "m", kNotNegative, "of the body ahead of the front axle")
      .number("rear_overhang", &K::rear_overhang, "m", kNotNegative, "of the body behind the rear axle");
  return driven(std::move(table));
}

}  // namespace

const KeyTable<StepSteerKeys>& StepSteerKeys::keys() {
  using K = StepSteerKeys;
  static const auto table = steered<K>("\"step steer\"")
                                .number("rise_time", &K::rise_time, "s", kPositive,
                                        "of the ramp to the amplitude; ISO 7401 allows 0.15 s between 10 and 90 %");
  return table;
}

const KeyTable<SineKeys>& SineKeys::keys() {
  static const auto table =
      steered<SineKeys>("\"sine\"").number("frequency", &SineKeys::frequency, "Hz", kPositive, "of the one period");
  return table;
}

const KeyTable<ContinuousSineKeys>& ContinuousSineKeys::keys() {
  using K = ContinuousSineKeys;
  static const auto table = steered<K>("\"continuous sine\"")
                                .number("frequency", &K::frequency, "Hz", kPositive, "of the periods")
                                .count("periods", &K::periods, 1, 100000, "how many");
  return table;
}

const KeyTable<SineWithDwellKeys>& SineWithDwellKeys::keys() {
  using K = SineWithDwellKeys;
  static const auto table = steered<K>("\"sine with dwell\"")
                                .number("frequency", &K::frequency, "Hz", kPositive, "of the period")
                                .number("dwell", &K::dwell, "s", kAnyNumber, "wait at the second peak");
  return table;
}

const KeyTable<RampSteerKeys>& RampSteerKeys::keys() {
  using K = RampSteerKeys;
  static const auto table = steered<K>("\"ramp steer\"")
                                .number("rate", &K::rate, "rad/s", kPositive, "at which the steer grows")
                                .number("hold", &K::hold, "s", kAnyNumber, "how long the amplitude is held");
  return table;
}

const KeyTable<FishhookKeys>& FishhookKeys::keys() {
  using K = FishhookKeys;
  static const auto table =
      steered<K>("\"fishhook\"")
          .number("rate", &K::rate, "rad/s", kPositive, "of the ramps; 720 deg/s at a hand wheel of ratio 17 is 0.75")
          .number("dwell", &K::dwell, "s", kPositive, "wait at the first amplitude");
  return table;
}

const KeyTable<RandomSteerKeys>& RandomSteerKeys::sweep_keys() {
  using K = RandomSteerKeys;
  static const auto table =
      steered<K>("\"sweep\"")
          .number("low", &K::low, "Hz", kPositive, "first frequency")
          .number("high", &K::high, "Hz", kPositive, "last frequency, which it grows to exponentially")
          .number("length", &K::length, "s", kPositive, "of the sweep");
  return table;
}

const KeyTable<RandomSteerKeys>& RandomSteerKeys::keys() {
  using K = RandomSteerKeys;
  static const auto table = steered<K>("\"random steer\"")
                                .number("low", &K::low, "Hz", kPositive, "lowest frequency")
                                .number("high", &K::high, "Hz", kPositive, "highest frequency")
                                .number("length", &K::length, "s", kPositive, "of the signal")
                                .count("seed", &K::seed, 0, kLargestSeed, "of the random phases")
                                .otherwise("the study's `seed`");
  return table;
}

const KeyTable<CircleKeys>& CircleKeys::keys() {
  using K = CircleKeys;
  static const auto table =
      driven(steered<K>("\"steady-state circle\"")
                 .choice("method", &K::constant_radius, {{"constant speed", false}, {"constant radius", true}},
                         "ISO 4138: steer that grows at constant speed, or speed that grows on a circle")
                 .number("rate", &K::rate, "rad/s", kPositive, "of the growing steer")
                 .number("radius", &K::radius, "m", kAnyNumber, "of the circle, negative to the right")
                 .otherwise("required with `constant radius`")
                 .number("end_speed", &K::end_speed, "m/s", kPositive, "to which the speed grows")
                 .otherwise("required with `constant radius`")
                 .number("length", &K::length, "s", kPositive, "in which it does"));
  return table;
}

const KeyTable<ConesKeys>& ConesKeys::course_keys() {
  static const auto table = between_cones(table_of<ConesKeys>("\"double lane change\"` or `\"obstacle avoidance\"")
                                              .number("course_scale", &ConesKeys::course_scale, "1", kPositive,
                                                      "size of the course, for a model of a car"));
  return table;
}

const KeyTable<ConesKeys>& ConesKeys::slalom_keys() {
  using K = ConesKeys;
  static const auto table = between_cones(
      table_of<K>("\"slalom\"")
          .count("cones", &K::cones, 1, 1000, "how many, in a line")
          .number("spacing", &K::spacing, "m", kPositive, "from cone to cone")
          .number("clearance", &K::clearance, "m", kAnyNumber, "which the path leaves to the flank of the body"));
  return table;
}

const KeyTable<BrakingInATurnKeys>& BrakingInATurnKeys::keys() {
  using K = BrakingInATurnKeys;
  static const auto table =
      driven(table_of<K>("\"braking in a turn\"")
                 .number("radius", &K::radius, "m", kAnyNumber, "of the circle, negative to the right")
                 .number("deceleration", &K::deceleration, "m/s^2", kPositive, "by the brakes, the steering held")
                 .number("brake_time", &K::brake_time, "s", kPositive, "when the brakes are applied"));
  return table;
}

const KeyTable<FollowPathKeys>& FollowPathKeys::keys() {
  using K = FollowPathKeys;
  static const auto table = driven(table_of<K>("\"follow path\"")
                                       .file("file", &K::file, "table of the path")
                                       .number("radius", &K::radius, "m", kPositive, "of a circle, in place of a file")
                                       .otherwise("none")
                                       .choice("direction", &K::side, {{"left", 1}, {"right", -1}}, "of the circle"));
  return table;
}

const KeyTable<SignalKeys>& SignalKeys::keys() {
  using K = SignalKeys;
  static const auto table =
      table_of<K>("\"signal\"")
          .file("file", &K::file,
                "table with time[s], steer[rad], and where they are known drive_torque[N m], "
                "brake_torque[N m]")
          .numbers("time", &K::time, "s", kAnyNumber, "of the samples of `steer`, in place of a file")
          .numbers("steer", &K::steer, "rad", kAnyNumber, "at the road wheels, straight between samples");
  return table;
}

const KeyTable<TorqueKeys>& TorqueKeys::keys() {
  using K = TorqueKeys;
  static const auto table =
      KeyTable<K>("drive", "What drives and brakes, with `longitudinal = true`:")
          .flag("hold_speed", &K::hold_speed, "drive and brakes keep the speed of the beginning")
          .number("target_speed", &K::target_speed, "m/s", kPositive, "or this one")
          .otherwise("none")
          .numbers("drive_torque", &K::drive_torque, "N m", kAnyNumber,
                   "of all driven wheels: one number, or one for each of `torque_time`")
          .numbers("brake_torque", &K::brake_torque, "N m", kAnyNumber, "of all wheels, likewise")
          .numbers("torque_time", &K::torque_time, "s", kAnyNumber, "of the torques, straight between");
  return table;
}

std::vector<StudyKeys> manoeuvre_keys() {
  return all_of(StepSteerKeys::keys(), SineKeys::keys(), ContinuousSineKeys::keys(), SineWithDwellKeys::keys(),
                RampSteerKeys::keys(), FishhookKeys::keys(), RandomSteerKeys::sweep_keys(), RandomSteerKeys::keys(),
                CircleKeys::keys(), ConesKeys::course_keys(), ConesKeys::slalom_keys(), BrakingInATurnKeys::keys(),
                FollowPathKeys::keys(), SignalKeys::keys(), TorqueKeys::keys());
}

}  // namespace veridyn::vehicle
