#include "veridyn/aircraft/model/downwash.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/numerics/moments.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kVa = 20.0;

Subject with_downwash(double tail_arm) {
  Subject s = testing::linear_unatrap();
  s.downwash = {.CL_alphadot = 1.5, .Cm_alphadot = -6.0, .tail_arm = tail_arm};
  return s;
}

// A steady oscillation of alpha: what the lag adds is Cm_alphadot c/(2 l) i w T/(1 + i w T) alpha, T = l/Va, and where
// it is slow Cm_alphadot alpha' c/(2 Va).
TEST(Downwash, GivesAnOscillationThePublishedTermsOfAlphaDot) {
  const Subject s = with_downwash(0.8), quasi_steady = testing::linear_unatrap();
  const double T = 0.8 / kVa;
  for (const double w : {0.5, 10.0, 40.0}) {
    const auto alpha = [w](double t) { return 0.05 * std::sin(w * t); };
    UnsteadyAir<double> air;
    constexpr double kStep = 0.001;
    double t = 0.0;
    for (int k = 0; k < 12000; ++k) {
      air.alpha = alpha(t);
      air.elapsed = kStep;
      t += kStep;
      air.downwash_lag = air.lag(s.downwash, {.Va = kVa, .alpha = alpha(t)});
    }
    const auto loads = [&](const Subject& subject) {
      return aero_loads<double>(subject, air_velocity(kVa, alpha(t), 0.0), Eigen::Vector3d::Zero(), {}, 1.2,
                                air.downwash_lag)
          .coefficients;
    };
    const std::complex<double> iwT(0.0, w * T);
    const double lag = 0.05 * (iwT / (1.0 + iwT) * std::exp(std::complex<double>(0.0, w * t))).imag();
    const double per_lag = s.chord / (2.0 * 0.8);
    EXPECT_NEAR(loads(s).Cm - loads(quasi_steady).Cm, -6.0 * per_lag * lag, 1e-5) << w;
    EXPECT_NEAR(loads(s).CL - loads(quasi_steady).CL, 1.5 * per_lag * lag, 1e-5) << w;
    if (w < 1.0) {
      const double rate = 0.05 * w * std::cos(w * t);
      EXPECT_NEAR(-6.0 * per_lag * lag / (-6.0 * rate * s.chord / (2.0 * kVa)), 1.0, 0.01);
    }
  }
}

/// Standard deviations of what a model leaves of Cm and CL as they acted: the subject's, or the quasi-steady one at the
/// airspeed of each moment.
std::array<double, 2> unexplained(const SimulatedFlight& flight, const Subject& s, bool quasi_steady) {
  std::array<numerics::Moments, 2> left;
  const auto at = [&](const char* name, std::size_t k) { return flight.truth.at(name).value[k]; };
  for (std::size_t k = 0; k < flight.truth.at("Cm").size(); ++k) {
    AeroVariables<double> v;
    v.alpha = at("alpha", k), v.beta = at("beta", k), v.Va = at("airspeed", k);
    v.q_n = 0.5 * s.chord * at("gyro_y", k) / v.Va;
    v.de = at("elevator", k);
    const AeroModel model = quasi_steady ? quasi_steady_model(s, at("air_density", k), v.Va) : s.model;
    const AeroCoefficients<double> c = model.evaluate(v);
    left[0].add(at("Cm", k) - c.Cm);
    left[1].add(at("CL", k) - c.CL);
  }
  return {left[0].sd(), left[1].sd()};
}

// What is left are the lag of 1 ms, changes of thrust across the path and gravity along it.
TEST(Downwash, ActsAsTheQuasiSteadyModelWhereTheTailIsNear) {
  SimulationOptions o;
  o.subject = with_downwash(0.02);
  o.duration = 8.0;
  o.airspeed = kVa;
  o.manoeuvres = std::vector<Manoeuvre>{{.kind = ManoeuvreKind::k3211,
                                         .start = 2.0,
                                         .surfaces = {Surface::kElevator},
                                         .amplitude = {0.02},
                                         .pulse = 0.4}};
  o.step = 0.001;
  Progress quiet;
  const SimulatedFlight flight = simulate(o, quiet);
  ASSERT_TRUE(flight.usable()) << flight.message();
  const auto left = unexplained(flight, o.subject, true), without = unexplained(flight, o.subject, false);
  EXPECT_LT(left[0], 0.1 * without[0]);
  EXPECT_LT(left[1], 0.1 * without[1]);
  EXPECT_EQ(quasi_steady_model(testing::linear_unatrap(), 1.2, kVa), testing::linear_unatrap().model);
}

TEST(Downwash, IsReadAndWritten) {
  const Study study = Study::parse(
      "[subject]\nbuiltin = \"unatrap\"\n[subject.downwash]\ntail_arm = 0.7\nCm_alphadot = -7\n", "study.toml");
  const Subject s = read_subject(study.root().table("subject"));
  EXPECT_EQ(s.downwash, (Downwash{.Cm_alphadot = -7.0, .tail_arm = 0.7}));
  EXPECT_EQ(read_subject(Study::parse(write_subject_toml(s), "written.toml").root().table("subject")), s);
}

}  // namespace
}  // namespace veridyn::aircraft
