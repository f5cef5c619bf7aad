#include "veridyn/aircraft/flying_qualities/levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

/// What a level asks for, for levels 1 to 3.
using Limits = std::array<double, 3>;

int first_level(const std::array<bool, 3>& holds) {
  const auto found = std::ranges::find(holds, true);
  return static_cast<int>(found - holds.begin()) + 1;
}

int level_at_least(double value, const Limits& least) {
  return first_level({value >= least[0], value >= least[1], value >= least[2]});
}

int level_at_most(double value, const Limits& most) {
  return first_level({value <= most[0], value <= most[1], value <= most[2]});
}

int level_between(double value, const Limits& least, const Limits& most) {
  return std::max(level_at_least(value, least), level_at_most(value, most));
}

/// Small, or of high manoeuvrability: quicker answers are asked of them.
bool is_agile(const FlyingQualities& asked) {
  return asked.aircraft_class == AircraftClass::kI || asked.aircraft_class == AircraftClass::kIV;
}

int level_of_short_period(const NaturalMode& motion, double control_anticipation, FlightPhase phase) {
  const bool gradual = phase == FlightPhase::kB;
  const int damping = level_between(motion.damping(), gradual ? Limits{0.30, 0.20, 0.15} : Limits{0.35, 0.25, 0.15},
                                    gradual ? Limits{2.0, 2.0, kInfinity} : Limits{1.30, 2.0, kInfinity});
  constexpr EnumArray<FlightPhase, Limits, 3> kLeastAnticipation{
      {Limits{0.28, 0.16, 0.16}, Limits{0.085, 0.038, 0.038}, Limits{0.16, 0.096, 0.096}}};
  return std::max(damping, level_between(control_anticipation, kLeastAnticipation[phase], {3.6, 10.0, kInfinity}));
}

/// Level 3 may grow, in 55 s at the fastest to twice as much.
int level_of_phugoid(const NaturalMode& motion) {
  const double grows_slowly = std::log(2.0) / 55.0;
  return first_level({motion.damping() >= 0.04, motion.damping() >= 0.0, motion.decay() >= -grows_slowly});
}

int level_of_dutch_roll(const NaturalMode& motion, const FlyingQualities& asked) {
  const double damping = motion.damping(), frequency = motion.frequency();
  double least_damping = 0.08, least_product = 0.15, least_frequency = 0.4;
  if (asked.phase == FlightPhase::kA) {
    least_damping = 0.19;
    least_product = 0.35;
  }
  if (asked.phase == FlightPhase::kC && !is_agile(asked)) least_product = 0.10;
  if (asked.phase != FlightPhase::kB && is_agile(asked)) least_frequency = 1.0;
  return std::max({level_at_least(damping, {least_damping, 0.02, 0.0}),
                   level_at_least(damping * frequency, {least_product, 0.05, -kInfinity}),
                   level_at_least(frequency, {least_frequency, 0.4, 0.4})});
}

int level_of_roll(const NaturalMode& motion, const FlyingQualities& asked) {
  if (!(motion.decay() > 0.0)) return kNoLevel;
  const bool quick = asked.phase != FlightPhase::kB && is_agile(asked);
  return level_at_most(1.0 / motion.decay(), quick ? Limits{1.0, 1.4, 10.0} : Limits{1.4, 3.0, 10.0});
}

int level_of_spiral(const NaturalMode& motion, FlightPhase phase) {
  const double doubles_in = motion.decay() < 0.0 ? std::log(2.0) / -motion.decay() : kInfinity;
  return level_at_least(doubles_in, {phase == FlightPhase::kB ? 20.0 : 12.0, 8.0, 4.0});
}

}  // namespace

const KeyTable<FlyingQualities>& FlyingQualities::keys() {
  using Q = FlyingQualities;
  static const auto table =
      KeyTable<Q>("flying_qualities", "By what the modes of the identified aircraft are judged.")
          .choice("class", &Q::aircraft_class, choices_of<AircraftClass>(kAircraftClassNames),
                  "of MIL-F-8785C: I small and light, II medium, III large and heavy, IV of high manoeuvrability")
          .choice("category", &Q::phase, choices_of<FlightPhase>(kFlightPhaseNames),
                  "of flight phases, of MIL-F-8785C: A rapid manoeuvres and precise tracking, B gradual manoeuvres, C "
                  "take-off and landing")
          .number("airspeed", &Q::airspeed, "m/s", kPositive, "of the straight flight whose modes are computed")
          .otherwise("the median of what was excited");
  return table;
}

int level_of(Mode mode, const NaturalMode& motion, double control_anticipation, const FlyingQualities& asked) {
  switch (mode) {
    case Mode::kShortPeriod:
      return level_of_short_period(motion, control_anticipation, asked.phase);
    case Mode::kPhugoid:
      return level_of_phugoid(motion);
    case Mode::kDutchRoll:
      return level_of_dutch_roll(motion, asked);
    case Mode::kRoll:
      return level_of_roll(motion, asked);
    case Mode::kSpiral:
      return level_of_spiral(motion, asked.phase);
  }
  return kNoLevel;
}

}  // namespace veridyn::aircraft
