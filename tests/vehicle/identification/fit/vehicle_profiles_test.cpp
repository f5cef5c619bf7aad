#include "veridyn/vehicle/identification/fit/vehicle_profiles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::ProfileEnd;
using ::testing::HasSubstr;

/// A drive, identified, with the profiles that the options ask for.
struct ProfiledDrive {
  OutputErrorResult estimate;
  estimation::ProfileResult profiles;
};

ProfiledDrive profiled(double rms, double duration, const VehicleIdentifyOptions& options, double widening = 1.0) {
  const VehicleParameters<double> car = testing::family_car();
  const DriveSignalOptions signal_options;
  const DriveSignals signals = prepare_drive_signals(
      testing::mapped(record_drive(testing::lively_drive(car, 5, rms, duration), reference_drive_sensors(), 5)),
      signal_options);
  const DriveSegments segments = find_drive_segments(signals, {});
  const VehicleProblem problem{signals, segments, car, signal_options, options};
  Progress progress;
  ProfiledDrive out;
  out.estimate = estimate_by_output_error(problem, nullptr, {}, SearchEffort::kToTheEnd, progress);
  out.profiles = profile_drive(problem, nullptr, out.estimate, widening, progress);
  return out;
}

// What is well determined is nearly linear: then the profile is the error bar, corrected and uncorrected.
TEST(VehicleProfiles, AreTheErrorBarsOfWhatADriveDetermines) {
  VehicleIdentifyOptions options;
  options.profiles = {"C_f", "I_z"};
  const ProfiledDrive d = profiled(0.02, 30.0, options);
  ASSERT_TRUE(d.profiles.usable()) << d.profiles.message;
  ASSERT_EQ(d.profiles.profiles.size(), 2u);
  for (const estimation::ParameterProfile& p : d.profiles.profiles) {
    const estimation::Parameter& own = d.estimate.raw.parameters[p.parameter];
    EXPECT_EQ(p.low_end, ProfileEnd::kClosed) << p.name;
    EXPECT_EQ(p.high_end, ProfileEnd::kClosed) << p.name;
    const double inflation = std::max(1.0, std::pow(own.sigma / own.sigma_white, 2));
    EXPECT_GT(inflation, 1.5);  // the smoothing that measured and simulated signals go through correlates the residual
    const double sigma = 0.5 * (p.high - p.low) / std::sqrt(3.841458820694124);
    EXPECT_NEAR(sigma / std::sqrt(inflation) / own.sigma_white, 1.0, 0.15) << p.name;
    EXPECT_NEAR(sigma / own.sigma, 1.0, 0.15) << p.name;
  }
}

TEST(VehicleProfiles, WidenLikeTheErrorBarsDo) {
  VehicleIdentifyOptions options;
  options.profiles = {"C_f"};
  const ProfiledDrive one = profiled(0.02, 20.0, options), four = profiled(0.02, 20.0, options, 4.0);
  ASSERT_TRUE(one.profiles.usable() && four.profiles.usable());
  const auto width = [](const ProfiledDrive& d) { return d.profiles.profiles[0].high - d.profiles.profiles[0].low; };
  EXPECT_NEAR(width(four) / width(one), 2.0, 0.15);
}

// In a steady circle the yaw inertia has no part: not even the largest value that is tried is excluded.
TEST(VehicleProfiles, AreOpenWhereADriveExcludesNothing) {
  const VehicleParameters<double> car = testing::family_car();
  const VehicleTrajectory slow = testing::drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [&](double) { return testing::linear_bicycle(car); }, 30.0,
      [](double t) { return 0.02 * std::min(1.0, t / 2.0); }, [](double) { return 20.0; });
  const DriveSignalOptions signal_options;
  const DriveSignals signals =
      prepare_drive_signals(testing::mapped(record_drive(slow, reference_drive_sensors(), 5)), signal_options);
  DriveSegments segments;
  segments.identification = {{.begin = 8.0, .end = 27.0}};
  VehicleIdentifyOptions options;
  options.model.free[DriveUnknown::kCf] = false;
  options.model.free[DriveUnknown::kCr] = false;
  options.profiles = {"I_z"};
  const VehicleProblem problem{signals, segments, car, signal_options, options};
  Progress progress;
  const OutputErrorResult estimate = estimate_by_output_error(problem, nullptr, {}, SearchEffort::kToTheEnd, progress);
  const estimation::ProfileResult r = profile_drive(problem, nullptr, estimate, 1.0, progress);
  ASSERT_TRUE(r.usable()) << r.message;
  const estimation::ParameterProfile& I_z = r.profiles.front();
  EXPECT_EQ(I_z.high_end, ProfileEnd::kOpen) << I_z.text();
  EXPECT_TRUE(std::isnan(I_z.high));
}

TEST(VehicleProfiles, AreReadWithTheStudy) {
  const auto read = [](const std::string& text) {
    return VehicleIdentifyOptions::keys().read(
        Study::parse("[identify]\n" + text, "study.toml").root().table("identify"));
  };
  EXPECT_THAT(read("profiles = [\"C_f\"]").profiles, ::testing::ElementsAre("C_f"));
  EXPECT_EQ(read("profiles = true").profiles.size(), 6u);
  EXPECT_EQ(read("profiles = true\nestimate = [\"C_f\", \"C_r\"]").profiles.size(), 2u);
  try {
    static_cast<void>(read("profiles = true\noutput_error = false"));
    FAIL() << "profiles without output error";
  } catch (const InputError& e) {
    EXPECT_THAT(std::string(e.what()), HasSubstr("study.toml:2: identify.profiles: are of the output error"));
  }
  EXPECT_THROW(static_cast<void>(read("profiles = [\"mu\"]")), InputError);
}

}  // namespace
}  // namespace veridyn::vehicle
