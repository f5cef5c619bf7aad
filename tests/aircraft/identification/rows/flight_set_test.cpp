#include "veridyn/aircraft/identification/rows/flight_set.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::pitching_set;
using ::testing::HasSubstr;

CoefficientResult cm_of_set(const Subject& subject, std::span<const PreparedFlight> flights) {
  IdentifyOptions options;
  options.coefficients = {Coefficient::kCm};
  options.method = estimation::Method::kOls;
  Progress silent;
  return identify_coefficients(flights, subject, options, silent).coefficients.at(0);
}

estimation::Evidence scatter_row_of(const CoefficientResult& result) {
  const auto row =
      std::ranges::find(result.evidence, estimation::Check::kScatterBetweenFlights, &estimation::Evidence::check);
  return row == result.evidence.end() ? estimation::Evidence{} : *row;
}

// Four flights alike: half the standard error of one, and nothing that scatters.
TEST(FlightSet, OfFlightsAlikeIsOneRegression) {
  const Subject subject = builtin_subject("thor");
  const std::vector<PreparedFlight> flights = pitching_set(subject, 4, 0.0, 2);
  const CoefficientResult all = cm_of_set(subject, flights), one = cm_of_set(subject, {flights.data(), 1});
  EXPECT_EQ(scatter_row_of(all).outcome, estimation::Outcome::kPassed) << says(scatter_row_of(all));
  EXPECT_FALSE(one.scatter.has_value());
  EXPECT_EQ(all.flight_estimates.size(), 4u);
  EXPECT_EQ(all.flight_fits.size(), 4u);
  // Both are widened by how much identification and hold-out differ by chance, by up to a half.
  const double ratio = all.chosen->find("Cm_alpha")->sigma / one.chosen->find("Cm_alpha")->sigma;
  EXPECT_GT(ratio, 0.5 / 1.6);
  EXPECT_LT(ratio, 0.5 * 1.6);
}

TEST(FlightSet, OfFlightsThatDifferIsTheirMean) {
  const Subject subject = builtin_subject("thor");
  const std::vector<PreparedFlight> flights = pitching_set(subject, 4, 0.05, 3);
  const CoefficientResult all = cm_of_set(subject, flights);
  const estimation::Evidence row = scatter_row_of(all);
  EXPECT_EQ(row.outcome, estimation::Outcome::kCare);
  EXPECT_THAT(says(row), HasSubstr("from the scatter of 4"));
  ASSERT_EQ(all.flight_estimates.size(), 4u);
  double sum = 0.0;
  for (const FlightEstimate& e : all.flight_estimates)
    sum += estimation::find_parameter(e.parameters, "Cm_alpha")->value;
  EXPECT_NEAR(all.chosen->find("Cm_alpha")->value, 0.25 * sum, 1e-4 * std::abs(sum)) << "known equally well";
  EXPECT_GT(all.chosen->find("Cm_alpha")->sigma,
            estimation::find_parameter(all.flight_estimates[0].parameters, "Cm_alpha")->sigma);
  EXPECT_EQ(all.verdict, estimation::GroupVerdict::kIdentified) << all.reason;
}

// A flight held out as a whole differs as the others do, and contradicts nothing.
TEST(FlightSet, HoldsOutAWholeFlight) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = pitching_set(subject, 5, 0.05, 4);
  for (PreparedFlight& flight : flights)
    for (AxisSegments* axis : {&flight.segments.longitudinal, &flight.segments.lateral}) {
      axis->identification = axis->excited;
      axis->holdout.clear();
    }
  flights[4].segments = all_held_out(flights[4].segments);
  EXPECT_TRUE(flights[4].segments.longitudinal.identification.empty());
  const CoefficientResult cm = cm_of_set(subject, flights);
  ASSERT_EQ(cm.flight_fits.size(), 1u);
  EXPECT_EQ(cm.flight_fits[0].flight, "flight5.csv");
  EXPECT_GT(cm.flight_fits[0].fit.r2, 0.9);
  EXPECT_GT(cm.contradiction_p, 1e-3);
  EXPECT_EQ(cm.verdict, estimation::GroupVerdict::kIdentified) << cm.reason;
}

// 60 sets of four flights, four parameters each, which go together: the standard deviation of the share is between 1.4
// % and 2.8 %. Intervals from the rows alone hold the mean in less than a fifth.
TEST(FlightSet, IntervalsCoverTheMeanOfFlightsThatDiffer) {
  const Subject subject = builtin_subject("thor");
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  int held = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const CoefficientResult r = cm_of_set(subject, pitching_set(subject, 4, 0.05, 100 + seed));
    for (std::size_t j = 0; j < cm.values.size(); ++j) {
      const estimation::Parameter& p = r.chosen->parameters[j];
      ++count;
      held += p.low95 <= cm.values[j] && cm.values[j] <= p.high95 ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(held) / count, 0.95, 0.09);
}

TEST(FlightSet, NamesWhatGivesNothing) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = pitching_set(subject, 3, 0.0, 5);
  for (PreparedFlight& flight : flights) {
    flight.aligned.recording.add(make_channel("gyro_x", "rad/s", make_time_base({5.0, 105.0}), {0.0, 0.0}));
    flight.recording_evidence = {
        estimation::row_of(estimation::Check::kGyroDelay, "gyro", estimation::Outcome::kPassed)};
  }
  flights[1].reconstruction.contradiction.emplace();
  flights[1].reconstruction.contradiction->statement = "vel_down contradicts the accelerometer";
  flights[2].segments.longitudinal.excited.clear();
  flights[2].segments.lateral.excited.clear();
  const std::vector<PreparedFlight> set = side_by_side(flights);
  EXPECT_EQ(set[0].recording_evidence[0].about, "flight1.csv: gyro");
  ASSERT_EQ(set[1].recording_evidence.size(), 1u);
  EXPECT_EQ(says(set[1].recording_evidence[0]), "flight2.csv is left out: vel_down contradicts the accelerometer");
  EXPECT_EQ(set[1].recording_evidence[0].outcome, estimation::Outcome::kCare);
  ASSERT_EQ(set[2].recording_evidence.size(), 1u) << "what is wrong with it spoils no estimate of the others";
  EXPECT_EQ(set[2].recording_evidence[0].check, estimation::Check::kNothingExcited);
  EXPECT_EQ(set[0].shift_s, 0.0);
  EXPECT_EQ(set[1].shift_s, 100.0 + kBetweenFlights_s);
  const std::vector<estimation::RecordingUse> uses = recording_uses(set, false);
  EXPECT_EQ(uses[0].use, "identification and hold-out");
  EXPECT_EQ(uses[1].use, "left out");
  EXPECT_EQ(uses[2].use, "nothing excited");
  EXPECT_TRUE(recording_uses({set.data(), 1}, false).empty());
  // Where no flight gives anything, all of it is said.
  flights.erase(flights.begin());
  EXPECT_EQ(side_by_side(flights).back().recording_evidence.size(), 2u);
}

}  // namespace
}  // namespace veridyn::aircraft
