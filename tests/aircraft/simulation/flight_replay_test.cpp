#include "veridyn/aircraft/simulation/flight_replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/simulated_flight.hpp"

namespace veridyn::aircraft {
namespace {

/// Ten seconds of a flight through turbulence, recorded so often.
SimulatedFlight recorded(double rate_Hz, const Subject& subject = testing::linear_unatrap(), bool gradients = false) {
  SimulationOptions o;
  o.subject = subject;
  o.gust_gradients = gradients;
  o.duration = 10.0;
  o.airspeed = 20.0;
  o.turbulence = gust_spectrum("low_moderate");
  o.truth_rate = rate_Hz;
  Progress progress;
  return simulate(o, progress);
}
const SimulatedFlight& replayed_flight() {
  static const SimulatedFlight flown = recorded(100.0);
  return flown;
}

/// Root mean square difference of the replay from the flight over so many seconds from 2 s on, over the signal's own.
double largest_error(const SimulatedFlight& flight, double seconds,
                     const Subject& subject = testing::linear_unatrap()) {
  const FlightReplay replay(flight.truth, kGravity);
  const double rate_Hz = 1.0 / (replay.time(1) - replay.time(0));
  const auto begin = static_cast<std::size_t>(std::lround(2.0 * rate_Hz));
  const std::size_t end = begin + static_cast<std::size_t>(std::lround(seconds * rate_Hz));
  Eigen::MatrixXd signals;
  EXPECT_TRUE(replay.fly(subject, begin, end, signals));
  double most = 0.0;
  for (std::size_t i = 0; i < kReplaySignals.size(); ++i) {
    const std::vector<double> all = replay.flown(i);
    const Eigen::VectorXd flown =
        Eigen::Map<const Eigen::VectorXd>(all.data() + begin, static_cast<Eigen::Index>(end - begin));
    const Eigen::VectorXd error = signals.row(i).transpose() - flown;
    most = std::max(most, error.norm() / (flown.array() - flown.mean()).matrix().norm());
  }
  return most;
}

TEST(FlightReplay, OfTheSameAircraftIsTheFlight) {
  // At the simulation's own steps the equations are the same; rounding of the attitude through Euler angles is left.
  EXPECT_LT(largest_error(recorded(400.0), 5.0), 1e-9);
  // At a quarter of them gusts between the samples are lost.
  EXPECT_LT(largest_error(replayed_flight(), 5.0), 0.1);
}

TEST(FlightReplay, HasTheGradientsOfGustsAndTheLagOfTheDownwash) {
  Subject s = testing::linear_unatrap();
  s.downwash = {.CL_alphadot = 1.0, .Cm_alphadot = -6.0, .tail_arm = 0.8};
  const SimulatedFlight flight = recorded(400.0, s, true);
  EXPECT_LT(largest_error(flight, 5.0, s), 1e-9);
  EXPECT_GT(largest_error(flight, 5.0), 0.05) << "without the downwash";
}

TEST(FlightReplay, OfAnotherAircraftLeavesTheFlight) {
  const FlightReplay replay(replayed_flight().truth, kGravity);
  Subject heavy = testing::linear_unatrap();
  heavy.mass *= 1.1;
  Eigen::MatrixXd same, other;
  ASSERT_TRUE(replay.fly(testing::linear_unatrap(), 0, 300, same));
  ASSERT_TRUE(replay.fly(heavy, 0, 300, other));
  // At the first sample the motion is the same and the specific force that of the mass.
  EXPECT_NEAR(other(5, 0), same(5, 0), 1e-12);
  EXPECT_NEAR(other(8, 0), same(8, 0) / 1.1, 1e-9);
  EXPECT_GT((other - same).cwiseAbs().row(3).maxCoeff(), 1e-3);
}

TEST(FlightReplay, SaysWhereTheAircraftDeparts) {
  const FlightReplay replay(replayed_flight().truth, kGravity);
  Subject unstable = testing::linear_unatrap();
  CoefficientModel& Cm = unstable.model.at(Coefficient::kCm);
  for (std::size_t i = 0; i < Cm.terms.size(); ++i)
    if (Cm.terms[i].expression == "alpha") Cm.values[i] = 5.0;
  Eigen::MatrixXd signals;
  EXPECT_FALSE(replay.fly(unstable, 0, 900, signals));
}

}  // namespace
}  // namespace veridyn::aircraft
