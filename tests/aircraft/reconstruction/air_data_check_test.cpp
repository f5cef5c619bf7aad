#include "veridyn/aircraft/reconstruction/air_data_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using aircraft::testing::Identified;
using ::testing::Contains;
using ::testing::HasSubstr;

FlightStudy estimating_everything(FlightStudy study) {
  ReconstructOptions& o = study.reconstruct;
  o.alpha_bias = o.beta_bias = o.alpha_scale = o.pitot_scale = true;
  return study;
}

// By the innovations alone the pitot tube of this clean flight came out 34 % low, with 2 % of doubt, and CL_alpha at
// 2.38 +- 0.014 where 3.58 +- 0.02 is right.
TEST(AirDataCheck, DoesNotMoveACleanFlightsAnswer) {
  for (const char* aircraft : {"unatrap", "thor"}) {
    const FlightStudy study = campaign_flight(aircraft, 1, 200.0);
    const Identified clean = aircraft::testing::identified(study);
    const Identified asked = aircraft::testing::identified(estimating_everything(study));
    std::size_t compared = 0;
    for (const estimation::Parameter& p : clean.analysis.estimate.parameters) {
      if (p.status != estimation::ParameterStatus::kIdentified) continue;
      const estimation::Parameter* other = asked.analysis.estimate.find(p.name);
      ASSERT_NE(other, nullptr) << p.name;
      EXPECT_GE(other->value, p.low95) << aircraft << " " << p.name;
      EXPECT_LE(other->value, p.high95) << aircraft << " " << p.name;
      ++compared;
    }
    EXPECT_GT(compared, 10u);
    EXPECT_THAT(asked.analysis.flights.front().reconstruction.warnings,
                Contains(HasSubstr("pitot_scale: not corrected")));
    for (const SensorErrorReport& e : asked.analysis.flights.front().reconstruction.sensor_errors)
      EXPECT_LT(std::abs(e.value), 4.0 * e.sigma) << aircraft << " " << e.name;
  }
}

// A tube that reads 1.3 times the airspeed on the headings of this flight, a vane that is 8 deg off.
TEST(AirDataCheck, CorrectsWhatTheFlightShows) {
  FlightStudy study = campaign_flight("unatrap", 1, 300.0);
  const auto change = [&](const char* name, double factor, double offset) {
    Channel channel = study.mapped.recording.at(name);
    for (double& v : channel.value) v = factor * v + offset;
    study.mapped.recording.set(std::move(channel));
  };
  change("dynamic_pressure", 1.69, 0.0);
  change("alpha", 1.0, 0.14);
  study.reconstruct.pitot_scale = study.reconstruct.alpha_bias = true;
  const auto grade_of = [](const FlightStudy& flight) {
    return aircraft::testing::identified(flight).analysis.estimate.judgement.data.grade;
  };
  // The advice of the rows that object, to estimate the errors, is one that helps.
  FlightStudy unasked = study;
  unasked.reconstruct.pitot_scale = unasked.reconstruct.alpha_bias = false;
  EXPECT_GE(grade_of(unasked), estimation::Grade::kWithCare);
  EXPECT_EQ(grade_of(study), estimation::Grade::kYes);
  Progress silent;
  const Reconstruction r = reconstruct(study, silent).flights.front().reconstruction;
  ASSERT_EQ(r.sensor_errors.size(), 2u);
  for (const auto& [name, truth] : {std::pair{"pitot_scale", 0.69}, {"alpha_bias", 0.14}}) {
    const auto e = std::ranges::find(r.sensor_errors, name, &SensorErrorReport::name);
    ASSERT_NE(e, r.sensor_errors.end()) << name;
    EXPECT_NEAR(e->value, truth, 3.0 * e->sigma) << name;
    EXPECT_LT(e->sigma, 0.3 * truth) << name;
  }
  EXPECT_THAT(r.warnings, ::testing::Not(Contains(HasSubstr("not corrected"))));
  const Channel& airspeed = r.smoothed.at("airspeed");
  const Channel& truth = study.truth->at("airspeed");
  double sum = 0.0, sum_truth = 0.0;
  for (const double v : airspeed.value) sum += v / static_cast<double>(airspeed.size());
  for (const double v : truth.value) sum_truth += v / static_cast<double>(truth.size());
  EXPECT_NEAR(sum, sum_truth, 0.06 * sum_truth);
}

}  // namespace
}  // namespace veridyn::aircraft
