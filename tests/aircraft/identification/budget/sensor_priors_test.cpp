#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

KnownSensors known(const std::string& text) {
  return read_known_sensors(Study::parse(text, "known.toml").root().table_or_empty("sensors"));
}

TEST(SensorPriors, EachLineHasASizeAUnitAndASource) {
  for (const SensorPrior& prior : sensor_priors()) {
    EXPECT_GT(prior.sigma, 0.0);
    EXPECT_FALSE(prior.unit.empty());
    EXPECT_GT(prior.source.size(), 10U);
  }
}

TEST(SensorPriors, AStudyStatesWhatItKnowsInPlaceOfTheTable) {
  const KnownSensors none = known("");
  EXPECT_EQ(prior_of(BudgetSensor::kAlpha, SensorErrorKind::kScale, none).sigma, 0.1);
  EXPECT_EQ(prior_of(BudgetSensor::kElevator, SensorErrorKind::kZero, none).sigma, 0.0) << "not in the table";
  const KnownSensors some = known(
      "[sensors.alpha]\nscale = { value = 1.08, sigma = 0.02 }\nzero = { value = \"1 deg\", sigma = \"0.2 deg\" }\n"
      "[sensors.beta]\ndelay = { value = \"30 ms\", sigma = \"3 ms\" }\n");
  const SensorError scale = prior_of(BudgetSensor::kAlpha, SensorErrorKind::kScale, some);
  EXPECT_NEAR(scale.mean, 0.08, 1e-12);
  EXPECT_EQ(scale.sigma, 0.02);
  EXPECT_NEAR(prior_of(BudgetSensor::kAlpha, SensorErrorKind::kZero, some).mean, kDegree, 1e-12);
  EXPECT_NEAR(prior_of(BudgetSensor::kBeta, SensorErrorKind::kDelay, some).sigma, 0.003, 1e-12);
  EXPECT_EQ(prior_of(BudgetSensor::kBeta, SensorErrorKind::kScale, some).sigma, 0.1);
}

// A plain number is the error of a simulated sensor, of which the tables have other names.
TEST(SensorPriors, AreNotTakenForErrorsOfSimulatedSensors) {
  EXPECT_THAT(why([] { (void)known("[sensors.alpha]\nscale = 0.02\n"); }), HasSubstr("alpha_vane"));
  EXPECT_THAT(why([] { (void)known("[sensors.alpha]\nscale = { value = 1.0, sigma = -1 }\n"); }), HasSubstr("sigma"));
  EXPECT_THAT(why([] { (void)known("[sensors.elevator]\nscale = { value = 1.0, sigma = 0.1 }\n"); }),
              HasSubstr("not among"));
  Progress silent;
  const FlightStudy study = read_study(
      Study::parse("[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 12\n[sensors.alpha_vane]\nscale = 0.1\n"
                   "[sensors.alpha]\nscale = { value = 1.1, sigma = 0.01 }\n"
                   "delay = { value = \"20 ms\", sigma = \"2 ms\" }\n",
                   "both.toml"),
      silent);
  ASSERT_EQ(study.known_sensors.errors.size(), 2U);
  EXPECT_NEAR(study.delays.given_for("alpha").value_or(0.0), 0.02, 1e-12) << "taken off like a delay that is given";
}

TEST(SensorPriors, AMeasurementUpdatesThem) {
  const SensorError prior{BudgetSensor::kAlpha, SensorErrorKind::kScale, 0.0, 0.1};
  const SensorError good = updated(prior, 0.03, 0.001);
  EXPECT_NEAR(good.mean, 0.03, 1e-4);
  EXPECT_NEAR(good.sigma, 0.001, 1e-6);
  const SensorError poor = updated(prior, 2.0, 100.0);
  EXPECT_NEAR(poor.mean, 0.0, 1e-5);
  EXPECT_NEAR(poor.sigma, 0.1, 1e-6);
  // Precisions add up: two equal ones halve the variance and meet in the middle.
  const SensorError half = updated(prior, 0.1, 0.1);
  EXPECT_NEAR(half.mean, 0.05, 1e-12);
  EXPECT_NEAR(half.sigma, std::sqrt(0.005), 1e-12);
  EXPECT_EQ(updated(prior, kNaN, 0.1).sigma, 0.1);
  EXPECT_EQ(updated({BudgetSensor::kAlpha, SensorErrorKind::kScale, 0.02, 0.0}, 0.5, 0.1).mean, 0.02) << "known";
}

}  // namespace
}  // namespace veridyn::aircraft
