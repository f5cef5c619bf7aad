#include "veridyn/aircraft/identification/fit/flight_delays.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/stripped_recording.hpp"
#include "veridyn/aircraft/identification/fit/manoeuvre_delays.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using aircraft::testing::Identified;

const DelayReport& report_of(const Identified& flight, std::string_view group) {
  const std::vector<DelayReport>& all = flight.analysis.flights.front().delays;
  return *std::ranges::find(all, group, &DelayReport::group);
}

/// Share of the intervals of the side's derivatives that hold the truth.
double covered(const Identified& flight) {
  double held = 0.0, count = 0.0;
  for (const CoefficientResult& result : flight.analysis.coefficients) {
    if (result.axis != Axis::kLateral || !result.chosen) continue;
    for (const estimation::Parameter& p : result.chosen->parameters) {
      const double truth = flight.analysis.truth.at(p.name);
      held += p.low95 <= truth && truth <= p.high95 ? 1.0 : 0.0;
      count += 1.0;
    }
  }
  return held / count;
}

// In gusts the alignment does not find the delay of the beta vane, or one that is too short; and it gives the aileron
// one that is the vane's. CY_r came out 0.57 +- 0.02 in place of 0.30.
TEST(FlightDelays, ALateVaneIsFoundByTheManoeuvresInGusts) {
  double held = 0.0, flights = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    FlightStudy study = campaign_flight("unatrap", seed, 200.0, "low_light");
    recording::take_off_delay(study.mapped.recording, {"beta"}, -0.035);
    const Identified flight = aircraft::testing::identified(study);
    const DelayReport& beta = report_of(flight, "beta");
    EXPECT_TRUE(beta.applied());
    EXPECT_NEAR(beta.delay_s, 0.035, 3.0 * beta.sigma_s);
    EXPECT_LT(beta.sigma_s, 0.015);
    const DelayReport& aileron = report_of(flight, "aileron");
    EXPECT_NEAR(aileron.delay_s, 0.0, 0.008) << seed;
    held += covered(flight);
    flights += 1.0;
  }
  EXPECT_GT(held / flights, 0.85);
}

// A deflection that is recorded after its effect. About a prior of 0 +- 20 ms the manoeuvres found one that was 50 ms
// late 19 +- 18 ms early, Cn_beta 0.05 +- 0.08 for 0.25, and of one 0.22 s late no row said anything.
TEST(FlightDelays, ADeflectionRecordedAfterItsEffectIsFoundWhateverItsSize) {
  for (const double late_s : {0.05, 0.22}) {
    FlightStudy study = campaign_flight("unatrap", 1, 120.0, "low_moderate");
    recording::take_off_delay(study.mapped.recording, {"rudder"}, -late_s);
    const Identified flight = aircraft::testing::identified(study);
    const DelayReport& rudder = report_of(flight, "rudder");
    EXPECT_NEAR(rudder.delay_s, -late_s, estimation::kBeyondChance * rudder.sigma_s) << late_s;
    EXPECT_LT(rudder.sigma_s, 0.015) << late_s;
    EXPECT_GT(covered(flight), 0.85) << late_s;
    const std::vector<estimation::Evidence>& rows = flight.analysis.flights.front().recording_evidence;
    const auto order = std::ranges::find_if(rows, [](const estimation::Evidence& row) {
      return row.check == estimation::Check::kOrderInTime && row.about == "rudder";
    });
    ASSERT_NE(order, rows.end()) << late_s;
    EXPECT_EQ(order->outcome, late_s > 0.1 ? estimation::Outcome::kFailed : estimation::Outcome::kCare) << late_s;
  }
}

TEST(FlightDelays, WhatTheStudyGivesIsKnownAndWhatItKnowsRoughlyIsNot) {
  const auto sigma_of_beta = [](const FlightStudy& study) {
    const SensorBudget budget = aircraft::testing::identified(study).analysis.flights.front().budget;
    const auto found = std::ranges::find_if(budget.errors, [](const SensorError& e) {
      return e.sensor == BudgetSensor::kBeta && e.kind == SensorErrorKind::kDelay;
    });
    return found == budget.errors.end() ? 0.0 : found->sigma;
  };
  FlightStudy study = campaign_flight("unatrap", 1, 100.0, "low_moderate");
  const double unknown = sigma_of_beta(study);
  EXPECT_GT(unknown, 0.001);
  EXPECT_LT(unknown, 0.025);
  study.delays.given = {{"beta", 0.0}};
  EXPECT_EQ(sigma_of_beta(study), 0.0);
  study.known_sensors.errors = {{BudgetSensor::kBeta, SensorErrorKind::kDelay, 0.0, 0.0005}};
  EXPECT_NEAR(sigma_of_beta(study), 0.0005, 1e-4);
  study.delays.automatic = false;
  EXPECT_EQ(sigma_of_beta(study), 0.0);
}

/// With servos of 50 ms and 4 rad/s, or with none that takes time; their commands are logged.
FlightStudy commanded_flight(bool servos) {
  std::string text = "seed = 3\n[subject]\nbuiltin = \"unatrap\"\n";
  for (const char* surface : {"elevator", "aileron", "rudder"})
    text += fmt::format("[subject.actuators.{}]\n{}\n", surface,
                        servos ? "time_constant = 0.05\nrate_limit = 4.0" : "time_constant = 0\nrate_limit = 1000");
  Progress silent;
  return read_study(
      Study::parse(text + "[flight]\nduration = 120\naltitude = 300\nlog_commands = true\n", "servos.toml"), silent);
}

const SensorError* lag_of(const Identified& flight, BudgetSensor surface) {
  const std::vector<SensorError>& errors = flight.analysis.flights.front().budget.errors;
  const auto found = std::ranges::find_if(
      errors, [&](const SensorError& e) { return e.sensor == surface && e.kind == SensorErrorKind::kLag; });
  return found == errors.end() ? nullptr : &*found;
}

// Every autopilot logs commands. A first-order lag is no delay: Cm_alpha came out -0.46 +- 0.02 in place of -0.85.
TEST(FlightDelays, ALagOfCommandedSurfacesIsFoundAndInTheIntervals) {
  const Identified flight = aircraft::testing::identified(commanded_flight(true));
  for (const BudgetSensor surface : {BudgetSensor::kElevator, BudgetSensor::kAileron, BudgetSensor::kRudder}) {
    const SensorError* lag = lag_of(flight, surface);
    ASSERT_NE(lag, nullptr);
    EXPECT_GT(lag->mean, 0.01);
    EXPECT_NEAR(lag->mean, 0.05, 3.0 * lag->sigma);
  }
  for (const CoefficientResult& result : flight.analysis.coefficients) {
    if (result.coefficient != Coefficient::kCm) continue;
    for (const estimation::Parameter& p : result.chosen->parameters) {
      EXPECT_NEAR(p.value, flight.analysis.truth.at(p.name), p.high95 - p.value) << p.name;
      if (p.name == "Cm_alpha") EXPECT_LT(p.high95 - p.value, 0.5 * std::abs(p.value));
    }
  }
  // A surface that is where it is commanded to be jumps with the command: it has none.
  EXPECT_EQ(lag_of(aircraft::testing::identified(commanded_flight(false)), BudgetSensor::kElevator), nullptr);
}

/// Of a parameter of a flight.
struct Part {
  estimation::Parameter parameter;
  double air_data = 0.0;
};
Part part_of(const Identified& flight, Coefficient coefficient, const std::string& name) {
  for (const CoefficientResult& result : flight.analysis.coefficients) {
    if (result.coefficient != coefficient || !result.chosen) continue;
    const estimation::Parameter* p = result.chosen->find(name);
    const auto at = p - result.chosen->parameters.data();
    return {*p, result.interval_parts.air_data(at)};
  }
  return {};
}

// Without ground velocity nothing verifies the air data: 0.0 was said to be in doubt.
TEST(FlightDelays, WithoutGroundVelocityThePriorsOfTheAirDataAreInTheIntervals) {
  FlightStudy study = campaign_flight("unatrap", 2, 150.0, "low_light");
  study.mapped.recording = aircraft::testing::without(study.mapped.recording, {"vel_north", "vel_east", "vel_down"});
  const Part slope = part_of(aircraft::testing::identified(study), Coefficient::kCL, "CL_alpha");
  EXPECT_GT(slope.air_data, 0.08 * slope.parameter.value) << "5 % of the airspeed are 10 % of a coefficient";
  EXPECT_GT(slope.parameter.sigma, slope.air_data);
}

// 50 Pa are a tenth of the airspeed: the interval was 0.06 to either side, and 0.57 were "in doubt".
TEST(FlightDelays, AZeroOfThePitotTubeIsCorrectedAndInTheIntervals) {
  FlightStudy study = campaign_flight("unatrap", 1, 150.0, "low_moderate");
  Channel pressure = study.mapped.recording.at("dynamic_pressure");
  for (double& v : pressure.value) v += 50.0;
  study.mapped.recording.set(std::move(pressure));
  const Identified flight = aircraft::testing::identified(study);
  const Part slope = part_of(flight, Coefficient::kCL, "CL_alpha");
  const double truth = flight.analysis.truth.at("CL_alpha");
  EXPECT_LE(slope.parameter.low95, truth);
  EXPECT_GE(slope.parameter.high95, truth);
}

TEST(LagNotes, NameSurfacesThatFollowACommand) {
  using enum BudgetSensor;
  SensorBudget budget;
  budget.add({{kElevator, SensorErrorKind::kLag, 0.06, 0.01},
              {kAileron, SensorErrorKind::kLag, 0.015, 0.01},
              {kRudder, SensorErrorKind::kDelay, 0.06, 0.01}});
  const std::vector<std::string> notes = lag_notes(budget);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes.front().starts_with("elevator")) << notes.front();
}

}  // namespace
}  // namespace veridyn::aircraft
