#include "veridyn/aircraft/reconstruction/sensor_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;
using testing::MadeFlight;
using testing::make_flight;

TEST(SensorErrors, AreJudgedByWhatTheFlightAddsToThePrior) {
  Eigen::MatrixXd C(3, 3);
  C << 1.0, 0.95, 0.0, 0.95, 1.0, 0.1, 0.0, 0.1, 1.0;
  const auto reports = judge_sensor_errors({{"alpha_bias", "rad", 0.03, 0.1, 0.01},
                                            {"alpha_scale", "1", 0.1, 0.1, 0.06},
                                            {"pitot_bias", "Pa", 1.0, 20.0, 19.0}},
                                           C);
  ASSERT_EQ(reports.size(), 3U);
  EXPECT_EQ(reports[0].observability, Observability::kObservable);
  EXPECT_EQ(reports[1].observability, Observability::kWeak);
  EXPECT_EQ(reports[2].observability, Observability::kNotObservable);
  EXPECT_NEAR(reports[0].information, 0.99, 1e-12);
  EXPECT_EQ(reports[0].correlated_with, "alpha_scale");
  EXPECT_NEAR(reports[0].correlation, 0.95, 1e-12);
  EXPECT_THAT(reports[0].statement, HasSubstr("distinguishable from alpha_scale"));
  EXPECT_THAT(reports[2].statement, HasSubstr("kept at its prior"));
}

/// Errors put into made flights, estimated, in units of the printed sigma: their root mean square over the seeds.
std::map<std::string, double> normalised_errors(int seeds, double duration, bool beta) {
  const std::map<std::string, double> truth{
      {"alpha_bias", 2.0 * kDegree}, {"beta_bias", -1.0 * kDegree}, {"pitot_scale", 0.06}};
  std::map<std::string, double> squares;
  for (int seed = 1; seed <= seeds; ++seed) {
    MadeFlight f = make_flight({.duration = duration, .seed = static_cast<std::uint64_t>(seed)});
    const auto add = [&](const char* name, auto&& error) {
      Channel c = f.recording.at(name);
      for (std::size_t i = 0; i < c.size(); ++i) c.value[i] += error(i);
      f.recording.set(c);
    };
    add("alpha", [&](std::size_t) { return truth.at("alpha_bias"); });
    if (beta) add("beta", [&](std::size_t) { return truth.at("beta_bias"); });
    add("dynamic_pressure",
        [&](std::size_t i) { return truth.at("pitot_scale") * 0.6 * f.airspeed[i] * f.airspeed[i]; });
    ReconstructOptions o;
    o.sensors = NoiseSource::kReference;
    o.turbulence = named_turbulence("low_moderate");
    o.keep_filter = false;
    o.alpha_bias = o.pitot_scale = true;
    o.beta_bias = beta;
    Progress quiet;
    const Reconstruction r = reconstruct(f.recording, o, quiet);
    EXPECT_THAT(r.warnings, ::testing::Not(::testing::Contains(HasSubstr("did not converge"))));
    for (const SensorErrorReport& e : r.sensor_errors) {
      squares[e.name] += std::pow((e.value - truth.at(e.name)) / e.sigma, 2) / seeds;
    }
  }
  for (auto& [name, value] : squares) {
    value = std::sqrt(value);
    std::printf("  %s: rms error / sigma %.2f over %d seeds\n", name.c_str(), value, seeds);
  }
  return squares;
}

// As states of the filter these ratios were 3.0, 4.3 and 3.5. With three seeds 95 % of sound ratios lie below 1.61
// (chi-square); the margin above that is for the 1.2 to 1.3 that many seeds show.
TEST(SensorErrors, HaveRealisticSigmasInTurbulence) {
  for (const auto& [name, ratio] : normalised_errors(3, 60.0, false)) EXPECT_LT(ratio, 2.1) << name;
}

TEST(SensorErrorsSoak, HaveRealisticSigmasOverManySeeds) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "long-running test; set VERIDYN_SOAK=1 to run it";
  for (const auto& [name, ratio] : normalised_errors(24, 120.0, true)) {
    EXPECT_LT(ratio, 1.6) << name;
    // The checks' doubt is that of slow gusts, which these made flights do not answer: 0.35 to 0.55 here.
    EXPECT_GT(ratio, 0.25) << name;
  }
}

TEST(SensorErrors, OfInertialSensorsAreStatesWithAVerdictEach) {
  MadeFlight f = make_flight({.duration = 60.0});
  Channel c = f.recording.at("accel_z");
  for (double& v : c.value) v = 1.02 * v + 0.1;
  f.recording.set(c);
  ReconstructOptions o;
  o.sensors = NoiseSource::kReference;
  o.turbulence = named_turbulence("low_moderate");
  o.gyro_bias = o.accel_bias = o.accel_scale = true;
  Progress quiet;
  const Reconstruction r = reconstruct(f.recording, o, quiet);
  const auto find = [&](const char* name) {
    return *std::find_if(r.sensor_errors.begin(), r.sensor_errors.end(), [&](const auto& e) { return e.name == name; });
  };
  EXPECT_EQ(r.sensor_errors.size(), 9U);
  EXPECT_EQ(find("gyro_bias_x").observability, Observability::kObservable);
  // Level flight loads the z axis almost constantly: bias and scale are distinguished by the loads of turns alone.
  EXPECT_GT(std::abs(find("accel_scale_z").correlation), 0.8);
  EXPECT_NEAR(find("accel_scale_z").value, 0.02, 4.0 * find("accel_scale_z").sigma);
  EXPECT_NEAR(find("accel_bias_z").value, 0.1, 4.0 * find("accel_bias_z").sigma);
}

}  // namespace
}  // namespace veridyn::aircraft
