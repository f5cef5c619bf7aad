#include "veridyn/aircraft/identification/fit/coefficient_description.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft::internal {
namespace {

using aircraft::testing::pitching_set;
using ::testing::HasSubstr;

TEST(CoefficientDescription, KnowsItsRowsOrWhyThereAreNone) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = pitching_set(subject, 2, 0.0, 1);
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const CoefficientResult found = described(cm, flights, subject);
  EXPECT_EQ(found.name, "Cm");
  EXPECT_EQ(found.axis, Axis::kLongitudinal);
  EXPECT_DOUBLE_EQ(found.row_interval_s, 0.05);
  EXPECT_EQ(found.reason, "");
  for (PreparedFlight& flight : flights) flight.signals[FlightSignal::kElevator].value.clear();
  EXPECT_THAT(described(cm, flights, subject).reason, HasSubstr("needs elevator"));
}

// y = 2 x exactly; with 3 for 2 the error is x and R^2 is 1 - sum x^2 / sum (y - mean y)^2.
TEST(CoefficientDescription, FitIsOfPredictionAndRegressand) {
  estimation::RegressionData data;
  data.regressors = estimation::RowMatrix(4, 1);
  data.regressors.col(0) << -1.0, 1.0, -2.0, 2.0;
  data.regressand = 2.0 * data.regressors.col(0);
  EXPECT_DOUBLE_EQ(fit_on(data, Eigen::VectorXd::Constant(1, 2.0)).r2, 1.0);
  const numerics::FitMeasures other = fit_on(data, Eigen::VectorXd::Constant(1, 3.0));
  EXPECT_DOUBLE_EQ(other.r2, 0.75);
  EXPECT_DOUBLE_EQ(other.rmse, std::sqrt(2.5));
}

TEST(CoefficientDescription, FitsByFlightAreThoseOfFlightsWithRows) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = pitching_set(subject, 3, 0.0, 1);
  flights[1].signals[FlightSignal::kElevator].value.clear();
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const Eigen::Map<const Eigen::VectorXd> values(cm.values.data(), static_cast<Eigen::Index>(cm.size()));
  const FlightRows rows = coefficient_rows(cm, flights, RowUse::kHoldout, subject);
  const std::vector<FlightFit> fits = fits_by_flight(rows, flights, values);
  ASSERT_EQ(fits.size(), 2U);
  EXPECT_EQ(fits[1].flight, "flight3.csv");
  EXPECT_GT(fits[1].fit.r2, 0.9);
  EXPECT_TRUE(fits_by_flight(rows, {flights.data(), 1}, values).empty()) << "of one flight there is nothing to compare";
}

// The coefficient is measured from q' and modelled from the signals; where one of them is missing there is neither.
TEST(CoefficientDescription, SeriesHoldMeasuredAndModelledWhileAirborne) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights = aircraft::testing::only_flight(
      aircraft::testing::pitching(subject, {.noise = 0.0, .later_noise = 0.0}), aircraft::testing::pitching_segments());
  flights[0].segments.airborne = {{10.0, 20.0}};
  flights[0].shift_s = 100.0;
  flights[0].signals[FlightSignal::kElevator].value[220] = kNaN;  // at 11 s
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const CoefficientResult series = with_series(described(cm, flights, subject), flights, subject);
  ASSERT_EQ(series.time.size(), series.measured.size());
  ASSERT_EQ(series.time.size(), series.modelled.size());
  EXPECT_NEAR(series.time.front(), 110.0, 1e-9);
  EXPECT_NEAR(series.time.back(), 120.0, 1e-9);
  for (std::size_t k = 0; k < series.time.size(); ++k) {
    if (k == 20) {
      EXPECT_TRUE(std::isnan(series.measured[k]) && std::isnan(series.modelled[k]));
    } else {
      EXPECT_NEAR(series.measured[k], series.modelled[k], 1e-12) << series.time[k];
    }
  }
}

}  // namespace
}  // namespace veridyn::aircraft::internal
