#include "veridyn/aircraft/identification/rows/flight_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::pitching_set;
using ::testing::HasSubstr;

TEST(FlightRows, HasNoRowThatReachesFromOneFlightIntoTheNext) {
  const Subject subject = builtin_subject("thor");
  const std::vector<PreparedFlight> flights = pitching_set(subject, 3, 0.0, 1);
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const FlightRows rows = coefficient_rows(cm, flights, RowUse::kIdentification, subject);
  const FlightRows one = coefficient_rows(cm, {flights.data(), 1}, RowUse::kIdentification, subject);
  EXPECT_EQ(rows.flights(), 3u);
  EXPECT_EQ(rows.data.rows(), 3 * one.data.rows());
  EXPECT_EQ(rows.of(0).regressors, one.data.regressors);
  for (std::size_t i = 1; i < 3; ++i) {
    const auto begin = static_cast<std::size_t>(rows.first[i]);
    EXPECT_NE(rows.data.segment[begin - 1], rows.data.segment[begin]);
  }
  EXPECT_NO_THROW(rows.data.validate()) << "no segment id comes back";
  // Flights are alike: their errors are.
  EXPECT_TRUE(rows.data.error_covariance.isApprox(one.data.error_covariance, 1e-9));
}

TEST(FlightRows, LeavesOutAFlightThatLacksASignal) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = pitching_set(subject, 2, 0.0, 1);
  flights[1].signals[FlightSignal::kElevator].value.clear();
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const FlightRows rows = coefficient_rows(cm, flights, RowUse::kIdentification, subject);
  EXPECT_EQ(rows.flights(), 1u);
  EXPECT_EQ(rows.rows_of(1), 0);
  EXPECT_EQ(identification_obstacle(cm, flights, subject), "");
  flights[0].signals[FlightSignal::kElevator].value.clear();
  EXPECT_THAT(identification_obstacle(cm, flights, subject), HasSubstr("needs elevator"));
}

TEST(FlightRows, AreThoseOfTheirUse) {
  const Subject subject = builtin_subject("thor");
  const std::vector<PreparedFlight> flights = pitching_set(subject, 1, 0.0, 1);
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const auto count = [&](RowUse use) { return coefficient_rows(cm, flights, use, subject).data.rows(); };
  // 20 rows a second, 160 s and then 80 s.
  EXPECT_NEAR(static_cast<double>(count(RowUse::kIdentification)), 3200.0, 2.0);
  EXPECT_NEAR(static_cast<double>(count(RowUse::kHoldout)), 1600.0, 2.0);
  EXPECT_NEAR(static_cast<double>(count(RowUse::kExcited)), 4800.0, 2.0);
  EXPECT_TRUE(any_excited(flights, Axis::kLongitudinal));
}

// A third of the rows with four times the variance and two thirds with it once: twice of it on average.
TEST(FlightRows, ErrorsAreTheMeanOverAllRows) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = pitching_set(subject, 2, 0.0, 1);
  flights[0].signals[FlightSignal::kQdot].sigma *= 2.0;
  flights[0].segments.longitudinal.identification = {{0.0, 80.0}};
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const FlightRows rows = coefficient_rows(cm, flights, RowUse::kIdentification, subject);
  const FlightRows usual = coefficient_rows(cm, {&flights[1], 1}, RowUse::kIdentification, subject);
  const Eigen::Index n = rows.data.parameters();
  EXPECT_NEAR(rows.data.error_covariance(n, n) / usual.data.error_covariance(n, n), 2.0, 1e-2);
  EXPECT_EQ(rows.of(1).regressand, usual.data.regressand);
  EXPECT_EQ(rows.of(1).error_covariance, rows.data.error_covariance) << "with the errors of all";
}

TEST(FlightRows, MayBeOfOtherSignalsOfOneFlight) {
  const Subject subject = builtin_subject("thor");
  const std::vector<PreparedFlight> flights = pitching_set(subject, 2, 0.0, 1);
  FlightSignals other = flights[1].signals;
  for (double& q : other[FlightSignal::kQ].value) q *= 2.0;
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const FlightRows rows = coefficient_rows(cm, flights, RowUse::kIdentification, subject);
  const FlightRows changed = coefficient_rows(cm, flights, RowUse::kIdentification, subject, &flights[1], &other);
  EXPECT_EQ(changed.of(0).regressors, rows.of(0).regressors);
  EXPECT_NE(changed.of(1).regressors, rows.of(1).regressors);
}

TEST(FlightRows, SayOfEachFlightHowItsSegmentsWereFound) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = pitching_set(subject, 2, 0.0, 1);
  flights[0].segments.longitudinal.text = "two doublets";
  flights[1].segments.longitudinal.text = "nothing moves";
  flights[1].segments.longitudinal.excited.clear();
  EXPECT_EQ(segments_text(flights, Axis::kLongitudinal), "flight1.csv: two doublets; flight2.csv: nothing moves");
  EXPECT_TRUE(any_excited(flights, Axis::kLongitudinal));
  EXPECT_FALSE(any_excited({&flights[1], 1}, Axis::kLongitudinal));
}

}  // namespace
}  // namespace veridyn::aircraft
