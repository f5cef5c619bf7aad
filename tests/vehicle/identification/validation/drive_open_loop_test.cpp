#include "veridyn/vehicle/identification/validation/drive_open_loop.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "tests/vehicle/identification/validation/open_loop_drive.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::OpenLoopState;
using estimation::OpenLoopWindow;
using estimation::Outcome;
using Drive = testing::OpenLoopDrive;
using ::testing::ElementsAre;
using testing::estimate_of;
using testing::family_car;
using ::testing::HasSubstr;
using testing::lively_drive;
using testing::state_of;
using testing::WanderingSteer;

estimation::Estimate bicycle_estimate(const VehicleParameters<double>& p, double sigma = 0.0) {
  return estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}}, sigma);
}

const Evidence& row_of(const std::vector<Evidence>& rows, estimation::Check check) {
  return *std::ranges::find(rows, check, &Evidence::check);
}

double pooled_inside(const DriveOpenLoop& driven) {
  double inside = 0.0, count = 0.0;
  for (const OpenLoopState& state : driven.states) {
    inside += state.inside * static_cast<double>(state.fit.count);
    count += static_cast<double>(state.fit.count);
  }
  return inside / count;
}

// Sensors' noise is white, and the model exact: a share of 95 % of 60 000 samples, which share the biases of a drive.
TEST(DriveOpenLoop, OfTheTrueModelHasTheMeasurementsInItsBands) {
  const VehicleParameters<double> p = family_car();
  double inside = 0.0;
  constexpr int kDrives = 6;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    const Drive drive(lively_drive(p, seed), reference_drive_sensors(), seed);
    const DriveOpenLoop driven = drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}});
    inside += pooled_inside(driven) / kDrives;
    ASSERT_THAT(driven.offsets, ElementsAre("steer_bias", "yaw_rate_bias", "accel_y_bias"));
    for (const OpenLoopState& state : driven.states) {
      EXPECT_EQ(state.held, state.windows) << state.name;
      EXPECT_LT(state.normalised_rmse, 0.15) << state.name;
    }
    for (const Evidence& row : open_loop_evidence(driven)) EXPECT_TRUE(row.passed()) << says(row);
  }
  EXPECT_NEAR(inside, 0.95, 0.03);
}

// Models drawn from a covariance, with bands that know it: theirs cover too.
TEST(DriveOpenLoop, BandsHoldTheErrorsOfTheParameters) {
  const VehicleParameters<double> p = family_car();
  constexpr double kSigma = 0.06;
  numerics::RandomStream random(4, "models");
  double inside = 0.0, without = 0.0;
  constexpr int kDraws = 60;
  for (int draw = 0; draw < kDraws; ++draw) {
    VehicleParameters<double> model = p;
    for (double* value : {&model.C_f, &model.C_r, &model.I_z}) *value *= 1.0 + kSigma * random.normal();
    const Drive drive(lively_drive(p, 10 + static_cast<std::uint64_t>(draw), 0.02, 30.0), reference_drive_sensors(),
                      static_cast<std::uint64_t>(draw));
    const DriveOpenLoopOptions options{.times = {.duration_s = 30.0}};
    inside += pooled_inside(drive.driven(p, bicycle_estimate(model, kSigma), options)) / kDraws;
    without += pooled_inside(drive.driven(p, bicycle_estimate(model), options)) / kDraws;
  }
  EXPECT_NEAR(inside, 0.95, 0.04);
  EXPECT_LT(without, 0.85) << "the covariance must matter";
}

/// Share of ten other drives in the bands of models identified by `identify` and driven by `validate`.
double inside_on_other_drives(std::string_view more) {
  const Study study =
      Study::parse(fmt::format("[subject]\nkind = 'vehicle'\nmass = 1500\na = 1.2\nb = 1.5\n[data]\nframe = 'flu'\n"
                               "[identify]\nstructure = 'bicycle'\n[validate]\nopen_loop = '10 min'\n{}",
                               more),
                   "study.toml");
  const auto recorded = [](std::uint64_t seed, double length) {
    return record_drive(lively_drive(family_car(), seed, 0.014, length), reference_drive_sensors(), seed);
  };
  Progress silent;
  double inside = 0.0;
  constexpr std::uint64_t kDrives = 10;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    const estimation::Estimate found = identify(read_study(study, recorded(seed, 60.0), silent), silent).estimate;
    EXPECT_GT(found.fit.at("yaw_rate.long_run"), 3.0) << "noise of the steering lasts as long as the car takes";
    const VehicleAnalysis other = validate(read_study(study, recorded(seed + 100, 120.0), silent), found, silent);
    inside += pooled_inside(other.open_loop) / static_cast<double>(kDrives);
  }
  return inside;
}

// From one drive to another as `identify` and `validate` go: how long the residual's errors last is known, and counts.
// The bands hold the steering's scale too, which this simulated steering has exactly.
TEST(DriveOpenLoop, BandsOfIdentifiedModelsCoverOtherDrives) {
  const double inside = inside_on_other_drives("");
  EXPECT_GT(inside, 0.94);
  EXPECT_LT(inside, 0.99);
}

TEST(DriveOpenLoop, BandsAreNoWiderWhereTheSteeringsScaleIsKnown) {
  EXPECT_NEAR(inside_on_other_drives("[identify.uncertainty]\nsteer_scale = 0\n"), 0.955, 0.015);
}

TEST(DriveOpenLoop, OfAWrongParameterLeavesItsBandsSoonAndTheRowSaysSo) {
  const VehicleParameters<double> p = family_car();
  const Drive drive(lively_drive(p, 3), reference_drive_sensors(), 3);
  for (double VehicleParameters<double>::*field :
       {&VehicleParameters<double>::C_f, &VehicleParameters<double>::C_r, &VehicleParameters<double>::I_z}) {
    VehicleParameters<double> wrong = p;
    wrong.*field *= 1.3;
    const DriveOpenLoop driven = drive.driven(p, bicycle_estimate(wrong), {.times = {.duration_s = 60.0}});
    const OpenLoopState& yaw_rate = state_of(driven, "yaw_rate");
    EXPECT_LT(yaw_rate.horizon_s, 15.0) << "the true model holds for 57 s";
    EXPECT_EQ(yaw_rate.held, 0u);
    EXPECT_LT(pooled_inside(driven), 0.9);
    const std::vector<Evidence> rows = open_loop_evidence(driven);
    const Evidence row = row_of(rows, estimation::Check::kOpenLoopHorizon);
    EXPECT_FALSE(row.passed()) << says(row);
    EXPECT_NE(row.cause, estimation::Cause::kNone);
    EXPECT_FALSE(advice_of(row).empty());
  }
}

// What the residual had beyond the sensors where the model was identified is in the bands of its forecasts.
TEST(DriveOpenLoop, WidensItsBandsByTheResidualOfItsIdentification) {
  VehicleParameters<double> wrong = family_car();
  wrong.C_f *= 1.1;
  const Drive drive(lively_drive(family_car(), 3), reference_drive_sensors(), 3);
  const DriveOpenLoopOptions options{.times = {.duration_s = 60.0}, .offsets = {{}}};
  estimation::Estimate estimate = bicycle_estimate(wrong);
  const DriveOpenLoop sure = drive.driven(family_car(), estimate, options);
  estimate.fit["yaw_rate.rmse"] = state_of(sure, "yaw_rate").fit.rmse * kDegree;
  estimate.fit["accel_y.rmse"] = state_of(sure, "accel_y").fit.rmse;
  const DriveOpenLoop widened = drive.driven(family_car(), estimate, options);
  EXPECT_LT(pooled_inside(sure), 0.8);
  EXPECT_NEAR(pooled_inside(widened), 0.95, 0.04);
  EXPECT_EQ(state_of(widened, "yaw_rate").held, 1u);
}

// A bias of today is none of the vehicle: found in the first seconds, as far as these tell the three apart.
TEST(DriveOpenLoop, FindsTheBiasesOfTheDay) {
  const VehicleParameters<double> p = family_car();
  Drive drive(lively_drive(p, 5), testing::perfect_sensors(), 1);
  for (double& r : drive.signals[DriveSignal::kYawRate].value) r += 0.02;
  for (double& a : drive.signals[DriveSignal::kAccelY].value) a += 0.2;
  for (const auto& [signal, sigma] : {std::pair{DriveSignal::kYawRate, 1e-4}, std::pair{DriveSignal::kAccelY, 1e-3}})
    drive.signals[signal].sigma = sigma;
  const DriveOpenLoop found = drive.driven(
      p, bicycle_estimate(p),
      {.times = {.duration_s = 60.0}, .offsets = {{DriveUnknown::kYawRateBias, DriveUnknown::kAccelYBias}}});
  ASSERT_EQ(found.windows.size(), 1u);
  ASSERT_EQ(found.windows[0].start.size(), 4u);
  EXPECT_NEAR(found.windows[0].start[2].value, 0.02, 1e-4);
  EXPECT_NEAR(found.windows[0].start[3].value, 0.2, 1e-3);
  EXPECT_LT(state_of(found, "yaw_rate").normalised_rmse, 1e-3);
  const DriveOpenLoop as_it_is = drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}, .offsets = {{}}});
  EXPECT_GT(state_of(as_it_is, "yaw_rate").shares.bias, 0.99);
  EXPECT_TRUE(as_it_is.offsets.empty());
  // On the drive that it was identified from the estimate knows them.
  estimation::Estimate own =
      estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}, {"yaw_rate_bias", 0.02}, {"accel_y_bias", 0.2}});
  const DriveOpenLoop known = drive.driven(p, own, {.times = {.duration_s = 60.0}}, OpenLoopUse::kHoldout);
  EXPECT_THAT(known.offsets, ElementsAre("steer_bias"));
  EXPECT_LT(state_of(known, "yaw_rate").normalised_rmse, 1e-3);
}

TEST(DriveOpenLoop, LooksAtNothingThatIdentificationHasUsedUnlessItIsAnotherDrive) {
  const VehicleParameters<double> p = family_car();
  Drive drive(lively_drive(p, 5), reference_drive_sensors(), 1);
  drive.segments.holdout = {{10.0, 20.0}, {40.0, 43.0}};
  drive.segments.identification = {{21.0, 39.0}};
  const DriveOpenLoopOptions options{.times = {.duration_s = 100.0}};
  const DriveOpenLoop own = drive.driven(p, bicycle_estimate(p), options, OpenLoopUse::kHoldout);
  ASSERT_EQ(own.windows.size(), 1u) << "three seconds are too short";
  EXPECT_NEAR(own.windows[0].span.begin, 10.0, 0.01);
  EXPECT_NEAR(own.windows[0].span.end, 21.0, 0.02);
  EXPECT_THAT(own.text, HasSubstr("that identification did not see"));
  const DriveOpenLoop other = drive.driven(p, bicycle_estimate(p), options, OpenLoopUse::kOtherDrive);
  ASSERT_EQ(other.windows.size(), 1u);
  EXPECT_NEAR(other.windows[0].span.end, 59.9, 0.02) << "the whole drive";
  const DriveOpenLoop part =
      drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 8.0}}, OpenLoopUse::kOtherHoldout);
  ASSERT_EQ(part.windows.size(), 1u);
  EXPECT_NEAR(part.windows[0].span.duration(), 8.0, 0.02);
}

TEST(DriveOpenLoop, OfACarThatSpinsIsCutThereAndTheRowFails) {
  VehicleParameters<double> p = family_car();
  p.C_r *= 0.25;  // oversteering: unstable at 20 m/s
  const Drive drive(lively_drive(family_car(), 5), reference_drive_sensors(), 1);
  const DriveOpenLoop driven = drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}});
  ASSERT_FALSE(driven.windows.empty());
  const bool missed = driven.windows[0].diverged || state_of(driven, "yaw_rate").normalised_rmse > 1.0;
  EXPECT_TRUE(missed);
  const std::vector<Evidence> rows = open_loop_evidence(driven);
  EXPECT_TRUE(std::ranges::any_of(rows, [](const Evidence& row) { return !row.passed(); }));
}

TEST(DriveOpenLoop, FollowsHeadingAndPathOfTheCarItIsAndStraysFromAnother) {
  const VehicleParameters<double> p = family_car();
  const VehicleTrajectory trajectory = lively_drive(p, 5);
  DriveSensorSet sensors = testing::perfect_sensors();
  sensors[DriveSensorKind::kPosition] = {.enabled = true, .rate_Hz = 100.0};
  Drive drive(trajectory, sensors, 1);
  ASSERT_FALSE(drive.signals[DriveSignal::kLateralVelocity].available()) << "the path needs it and takes the model's";
  drive.signals[DriveSignal::kYaw].value.assign(
      trajectory.yaw.begin(), trajectory.yaw.begin() + std::ssize(drive.signals[DriveSignal::kX].value));
  const DriveOpenLoopOptions options{.times = {.duration_s = 60.0}, .offsets = {{}}};
  const DriveOpenLoop exact = drive.driven(p, bicycle_estimate(p), options);
  ASSERT_TRUE(exact.path.heading && exact.path.position);
  EXPECT_LT(exact.path.heading->at_end, 0.01 * kDegree);
  EXPECT_LT(exact.path.position->at_end, 0.05) << "after 1.1 km, most of it by the test's own Euler steps";
  EXPECT_NEAR(exact.path.distance_m, 20.0 * 56.9, 25.0);
  EXPECT_EQ(exact.states.size(), 2U) << "the lateral velocity was not measured, and is not scored";
  EXPECT_GT(exact.windows[0].first_left_s, 56.0);
  Drive biased = drive;  // the sensor's, which is neither the model's error nor a part of the heading
  for (double& r : biased.signals[DriveSignal::kYawRate].value) r += 0.02;
  const DriveOpenLoop by_heading =
      biased.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}, .offsets = {{DriveUnknown::kYawRateBias}}});
  EXPECT_LT(by_heading.path.position->at_end, 1.0);
  biased.signals[DriveSignal::kYaw].value.clear();
  const DriveOpenLoop by_positions =
      biased.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}, .offsets = {{DriveUnknown::kYawRateBias}}});
  EXPECT_LT(by_positions.path.position->at_end, 30.0) << "of 1140 m: the course of both ends has its sideslip";
  VehicleParameters<double> softer = p;
  softer.C_r *= 0.9;
  const DriveOpenLoop wrong = drive.driven(p, bicycle_estimate(softer), options);
  EXPECT_GT(wrong.path.position->rmse, 20.0 * exact.path.position->rmse);
  EXPECT_GT(wrong.path.heading->rmse, 20.0 * exact.path.heading->rmse);
}

TEST(DriveOpenLoop, OfAStiffCarIsNotHeldByHoldingTenOfItsPeriods) {
  DriveOpenLoop driven{{.times = {.duration_s = 10.0}, .inputs = "steering and speed"}, 0.042, {}};
  driven.states.push_back(
      {.name = "yaw_rate", .unit = "deg/s", .normalised_rmse = 0.1, .horizon_s = 1.5, .windows = 3});
  const std::vector<Evidence> left = open_loop_evidence(driven);
  EXPECT_EQ(row_of(left, estimation::Check::kOpenLoopHorizon).outcome, Outcome::kCare)
      << "36 of its periods, and a second and a half";
  EXPECT_NEAR(row_of(left, estimation::Check::kOpenLoopHorizon).value, 1.5, 1e-12);
  EXPECT_THAT(says(row_of(left, estimation::Check::kOpenLoopHorizon)), HasSubstr("0.042 s, is shorter"));
  driven.states[0].horizon_s = 10.5;
  EXPECT_EQ(row_of(open_loop_evidence(driven), estimation::Check::kOpenLoopHorizon).outcome, Outcome::kPassed);
  driven.yaw_period_s = 1.5;
  EXPECT_EQ(row_of(open_loop_evidence(driven), estimation::Check::kOpenLoopHorizon).outcome, Outcome::kCare)
      << "7 slow periods";
}

TEST(DriveOpenLoop, SaysWhyNothingWasDrivenAndIsSilentWhereNothingIsAskedFor) {
  const VehicleParameters<double> p = family_car();
  const Drive drive(lively_drive(p, 5, 0.02, 20.0), reference_drive_sensors(), 1);
  EXPECT_TRUE(drive.driven(p, bicycle_estimate(p), {}).text.empty());
  const DriveOpenLoop no_inertia =
      drive.driven(p, estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}}), {.times = {.duration_s = 20.0}});
  EXPECT_FALSE(no_inertia.available());
  EXPECT_THAT(no_inertia.text, HasSubstr("has no I_z"));
  EXPECT_TRUE(drive
                  .driven(p, estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}}), {.times = {.duration_s = 20.0}},
                          OpenLoopUse::kHoldout)
                  .available())
      << "an inertia that was not estimated is the study's";
  EXPECT_TRUE(open_loop_evidence(no_inertia).empty());
  Drive unused = drive;
  unused.segments.holdout.clear();
  EXPECT_THAT(unused.driven(p, bicycle_estimate(p), {.times = {.duration_s = 20.0}}).text,
              HasSubstr("no unseen stretch lasts 4 s"));
}

}  // namespace
}  // namespace veridyn::vehicle
