#include "veridyn/aircraft/sensors/vane_kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/recording/delays.hpp"

namespace veridyn::aircraft {
namespace {

/// A calm flight with sensors that have no errors.
VaneKinematics calm_motion() {
  Progress silent;
  const FlightStudy study =
      read_study(Study::parse("seed = 2\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 120\naltitude = 300\n"
                              "turbulence = \"none\"\n[sensors]\nset = \"perfect\"\n",
                              "calm.toml"),
                 silent);
  const Recording& r = study.mapped.recording;
  const auto band = recording::BandLimited::around(r.at("gyro_x"), 4.0);
  const auto smooth = [&](const char* name) { return band->smooth(r.at(name)); };
  VaneKinematics motion{.rate_Hz = band->rate_Hz(),
                        .p = smooth("gyro_x"),
                        .q = smooth("gyro_y"),
                        .r = smooth("gyro_z"),
                        .ax = smooth("accel_x"),
                        .ay = smooth("accel_y"),
                        .az = smooth("accel_z"),
                        .phi = band->smooth_angle(r.at("roll")),
                        .theta = band->smooth_angle(r.at("pitch")),
                        .Va = smooth("dynamic_pressure"),
                        .alpha = smooth("alpha"),
                        .beta = smooth("beta")};
  const std::vector<double> density = band->smooth(study.truth->at("air_density"));
  for (std::size_t k = 0; k < motion.Va.size(); ++k) motion.Va[k] = std::sqrt(2.0 * motion.Va[k] / density[k]);
  return motion;
}

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0.0, count = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!std::isfinite(a[k]) || !std::isfinite(b[k])) continue;
    squares += (a[k] - b[k]) * (a[k] - b[k]);
    count += 1.0;
  }
  EXPECT_GT(count, 1000.0);
  return std::sqrt(squares / count);
}

// The simulation integrates forces and moments in body axes; the vanes show the same angles.
TEST(StillAirAngles, AreThoseOfTheVanesInASimulatedFlight) {
  const VaneKinematics motion = calm_motion();
  const StillAirAngles angles = still_air_angles(motion);
  const std::vector<double> zero(motion.Va.size(), 0.0);
  for (const auto& [integrated, shown] : {std::pair{&angles.alpha, &motion.alpha}, {&angles.beta, &motion.beta}}) {
    const std::vector<double> found = without_drift(*integrated, motion.rate_Hz);
    const std::vector<double> truth = without_drift(*shown, motion.rate_Hz);
    EXPECT_GT(rms_difference(truth, zero), 0.005);
    EXPECT_LT(rms_difference(found, truth), 0.03 * rms_difference(truth, zero));
  }
}

// At the nose of an aircraft that pitches up the air comes from above.
TEST(StillAirAngles, HoldWhatRotationAddsAtTheVanes) {
  VaneKinematics motion = calm_motion();
  const StillAirAngles centre = still_air_angles(motion);
  motion.position = {0.4, 0.0, 0.0};
  const StillAirAngles nose = still_air_angles(motion);
  for (std::size_t k = 0; k < motion.Va.size(); k += 97) {
    EXPECT_NEAR(nose.alpha[k] - centre.alpha[k], -0.4 * motion.q[k] / motion.Va[k], 0.002) << k;
    EXPECT_NEAR(nose.beta[k] - centre.beta[k], 0.4 * motion.r[k] / motion.Va[k], 0.002) << k;
  }
}

TEST(WithoutDrift, LeavesNothingOfBiasAndDriftAndWhatIsFast) {
  std::vector<double> angle;
  for (int k = 0; k < 1000; ++k) angle.push_back(0.3 + 0.001 * k + std::sin(2.0 * kPi * 0.01 * k));
  angle[500] = kNaN;
  const std::vector<double> left = without_drift(angle, 100.0);
  EXPECT_TRUE(std::isnan(left[450]) && std::isnan(left[550]) && std::isnan(left[50]));
  // The mean over two seconds of a sine of one is zero, but for the one sample more.
  for (const std::size_t k : {150U, 333U, 620U, 880U})
    EXPECT_NEAR(left[k], std::sin(2.0 * kPi * 0.01 * static_cast<double>(k)), 0.006) << k;
}

}  // namespace
}  // namespace veridyn::aircraft
