#include "veridyn/aircraft/reconstruction/air_data_likelihood.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/aircraft/simulated_flight.hpp"

namespace veridyn::aircraft {
namespace {

using internal::AirDataErrors;

TEST(AirDataErrors, CorrectWhatIsApplied) {
  AirDataErrors errors;
  errors.index = {AirDataErrorVector::kAlphaBias, AirDataErrorVector::kPitotScale};
  errors.value(AirDataErrorVector::kAlphaBias) = 0.02;
  errors.value(AirDataErrorVector::kPitotScale) = 0.1;
  errors.applied = {1};
  Eigen::Matrix<double, 5, 1> expected = Eigen::Matrix<double, 5, 1>::Zero();
  expected(AirDataErrorVector::kPitotScale) = 0.1;
  EXPECT_EQ(errors.correction(), expected);
}

TEST(AirDataErrors, AreThoseThatTheOptionsEstimateInTheOrderOfTheirPriors) {
  ReconstructOptions o;
  o.pitot_bias = o.beta_bias = true;
  EXPECT_EQ(internal::estimated_air_data_errors(o),
            (std::vector<int>{AirDataErrorVector::kBetaBias, AirDataErrorVector::kPitotBias}));
  EXPECT_EQ(internal::air_data_error_priors()[AirDataErrorVector::kPitotBias], kPitotBiasPrior);
  EXPECT_EQ(internal::air_data_error_priors()[AirDataErrorVector::kBetaBias], kVaneBiasPrior);
}

// The innovations of a filter that knows the aircraft show a vane that is 6 deg off and a tube that reads 30 % of the
// pressure too much, to within the standard errors that the likelihood states.
TEST(AirDataLikelihood, FindsTheErrorsOfVaneAndTubeOfAKnownAircraft) {
  aircraft::testing::Flown flown = aircraft::testing::fly({.duration = 30.0});
  const auto change = [&](const char* name, double factor, double offset) {
    Channel channel = flown.measured.at(name);
    for (double& v : channel.value) v = factor * v + offset;
    flown.measured.set(std::move(channel));
  };
  change("alpha", 1.0, 6.0 * kDegree);
  change("dynamic_pressure", 1.3, 0.0);
  ReconstructOptions o = aircraft::testing::reference_options();
  o.filter = FilterKind::kModelBased;
  o.alpha_bias = o.pitot_scale = true;
  const Reconstruction r = aircraft::testing::reconstructed(flown, o);
  for (const auto& [name, truth, prior] :
       {std::tuple{"alpha_bias", 6.0 * kDegree, kVaneBiasPrior}, std::tuple{"pitot_scale", 0.3, kPitotScalePrior}}) {
    const auto found = std::ranges::find(r.sensor_errors, name, &SensorErrorReport::name);
    ASSERT_NE(found, r.sensor_errors.end()) << name;
    EXPECT_NEAR(found->value, truth, 3.5 * found->sigma) << name;
    EXPECT_LT(found->sigma, 0.5 * prior) << name << ": the flight says something of it";
    EXPECT_LT(found->sigma, 0.05 * truth) << name;
  }
}

}  // namespace
}  // namespace veridyn::aircraft
