#include "veridyn/aircraft/flying_qualities/levels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

NaturalMode oscillation(double frequency, double damping) {
  const std::complex<double> root(-damping * frequency, frequency * std::sqrt(std::abs(1.0 - damping * damping)));
  return {root, std::conj(root)};
}

NaturalMode first_order(double root) { return {root, root}; }

struct Case {
  Mode mode;
  NaturalMode motion;
  AircraftClass aircraft_class;
  FlightPhase phase;
  int level;
};

// Either side of limits that MIL-F-8785C prints in tables IV, VI, VII and VIII and in 3.2.1.2.
TEST(FlyingQualities, HaveTheLevelsOfTheirTables) {
  using enum AircraftClass;
  constexpr FlightPhase A = FlightPhase::kA, B = FlightPhase::kB, C = FlightPhase::kC;
  for (const Case& c : {Case{Mode::kShortPeriod, oscillation(4.0, 0.36), kI, A, 1},
                        Case{Mode::kShortPeriod, oscillation(4.0, 0.34), kI, A, 2},
                        Case{Mode::kShortPeriod, oscillation(4.0, 0.31), kI, B, 1},
                        Case{Mode::kShortPeriod, oscillation(4.0, 0.16), kI, C, 3},
                        Case{Mode::kShortPeriod, oscillation(4.0, 0.14), kI, B, kNoLevel},
                        Case{Mode::kPhugoid, oscillation(0.3, 0.041), kI, B, 1},
                        Case{Mode::kPhugoid, oscillation(0.3, 0.039), kI, B, 2},
                        Case{Mode::kPhugoid, oscillation(0.3, -0.04), kI, B, 3},
                        Case{Mode::kPhugoid, oscillation(0.3, -0.05), kI, B, kNoLevel},
                        Case{Mode::kDutchRoll, oscillation(2.0, 0.2), kIV, A, 1},
                        Case{Mode::kDutchRoll, oscillation(2.0, 0.18), kIV, A, 2},
                        Case{Mode::kDutchRoll, oscillation(2.0, 0.09), kI, B, 1},
                        Case{Mode::kDutchRoll, oscillation(0.9, 0.2), kI, C, 2},
                        Case{Mode::kDutchRoll, oscillation(0.9, 0.2), kIII, C, 1},
                        Case{Mode::kDutchRoll, oscillation(1.0, 0.01), kI, B, 3},
                        Case{Mode::kDutchRoll, oscillation(1.0, -0.01), kI, B, kNoLevel},
                        Case{Mode::kRoll, first_order(-1.0 / 0.99), kI, A, 1},
                        Case{Mode::kRoll, first_order(-1.0 / 1.2), kI, A, 2},
                        Case{Mode::kRoll, first_order(-1.0 / 1.2), kII, A, 1},
                        Case{Mode::kRoll, first_order(-1.0 / 9.0), kI, B, 3},
                        Case{Mode::kRoll, first_order(0.1), kI, B, kNoLevel},
                        Case{Mode::kSpiral, first_order(-0.01), kI, B, 1},
                        Case{Mode::kSpiral, first_order(std::log(2.0) / 19.0), kI, B, 2},
                        Case{Mode::kSpiral, first_order(std::log(2.0) / 13.0), kI, C, 1},
                        Case{Mode::kSpiral, first_order(std::log(2.0) / 5.0), kI, B, 3},
                        Case{Mode::kSpiral, first_order(std::log(2.0) / 3.0), kI, B, kNoLevel}})
    EXPECT_EQ(level_of(c.mode, c.motion, 1.0, {.aircraft_class = c.aircraft_class, .phase = c.phase}), c.level)
        << words_of(c.mode) << " " << c.motion.first << " " << kFlightPhaseNames[c.phase];
}

// Figures 1 to 3: the lines of constant frequency^2/(n/alpha).
TEST(FlyingQualities, AskForControlAnticipation) {
  const auto level = [](double anticipation, FlightPhase phase) {
    return level_of(Mode::kShortPeriod, oscillation(4.0, 0.7), anticipation, {.phase = phase});
  };
  EXPECT_EQ(level(0.29, FlightPhase::kA), 1);
  EXPECT_EQ(level(0.27, FlightPhase::kA), 2);
  EXPECT_EQ(level(0.09, FlightPhase::kB), 1);
  EXPECT_EQ(level(0.05, FlightPhase::kB), 2);
  EXPECT_EQ(level(0.12, FlightPhase::kC), 2);
  EXPECT_EQ(level(3.7, FlightPhase::kB), 2);
  EXPECT_EQ(level(11.0, FlightPhase::kB), 3);
  EXPECT_EQ(level(0.03, FlightPhase::kB), kNoLevel);
  EXPECT_EQ(level(kNaN, FlightPhase::kB), kNoLevel);
}

}  // namespace
}  // namespace veridyn::aircraft
