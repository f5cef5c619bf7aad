#include "veridyn/aircraft/identification/fit/coefficient_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft::internal {
namespace {

using aircraft::testing::PitchingFlight;

/// The fit of Cm to one flight by OLS, and its checks.
struct FittedCm {
  explicit FittedCm(const PitchingFlight& flight, Segments segments = aircraft::testing::pitching_segments())
      : flights(aircraft::testing::only_flight(aircraft::testing::pitching(subject, flight), std::move(segments))) {
    options.method = estimation::Method::kOls;
  }
  [[nodiscard]] FlightView view() const { return {flights, subject, options}; }
  [[nodiscard]] CoefficientFit fit() const { return fit_coefficient(truth, view()); }
  [[nodiscard]] CoefficientChecks checks() const { return check_fit(fit(), 0.05, nullptr, view()); }

  Subject subject = builtin_subject("thor");
  CoefficientModel truth = *subject.model.find(Coefficient::kCm);
  std::vector<PreparedFlight> flights;
  IdentifyOptions options;
};

TEST(CoefficientFit, FindsTheParametersOfExactRows) {
  const FittedCm cm({.noise = 0.0, .later_noise = 0.0});
  const CoefficientFit fit = cm.fit();
  ASSERT_TRUE(fit.chosen.has_value());
  for (std::size_t i = 0; i < cm.truth.size(); ++i)
    EXPECT_NEAR(fit.model.values[i], cm.truth.values[i], 1e-9 * std::abs(cm.truth.values[i])) << i;
  EXPECT_EQ(fit.of_rows, fit.chosen->theta);
  EXPECT_NEAR(fit.unmodelled_share, 0.0, 1e-12);
}

TEST(CoefficientFit, NeedsTenRowsAParameter) {
  Segments few = aircraft::testing::pitching_segments();
  few.longitudinal.identification = {{0.0, 0.4}};
  const CoefficientFit fit = FittedCm({}, few).fit();
  EXPECT_FALSE(fit.enough_rows);
  EXPECT_FALSE(fit.chosen.has_value());
}

// Sensors leave 0.002 of Cm; a sine of 0.03 that no term makes has a variance of 4.5e-4, 112 times theirs.
TEST(CoefficientFit, KnowsHowMuchOfTheResidualIsNotTheSensors) {
  const CoefficientFit usual = FittedCm({}).fit(), disturbed = FittedCm({.unmodelled = 0.03}).fit();
  EXPECT_NEAR(usual.error_ratio, 1.0, 0.1);
  EXPECT_EQ(usual.unmodelled_share, 0.0);
  EXPECT_NEAR(disturbed.error_ratio, 113.0, 10.0);
  EXPECT_GT(disturbed.unmodelled_share, 0.1);
}

TEST(CoefficientFit, ChecksAreOfWhatWasHeldOut) {
  const CoefficientChecks same = FittedCm({}).checks();
  EXPECT_TRUE(same.has_holdout);
  EXPECT_NEAR(same.holdout_ratio, 1.0, 0.1);
  EXPECT_NEAR(same.outside_bands, 0.05, 0.02);
  EXPECT_NEAR(same.error_over_start, 1.0, 0.01) << "what the study gives is the truth";
  EXPECT_GT(same.contradiction_p, 0.01);
  // Half of the elevator is lost in what was held out: sigma of its effect over the sensors' is about
  // 0.5 |Cm_de| 0.038/0.002.
  const FittedCm lost({.later_elevator = 0.5});
  const CoefficientChecks other = lost.checks();
  EXPECT_LT(other.contradiction_p, 1e-6);
  const double effect = 0.5 * std::abs(lost.truth.value_of("de").value()) * std::hypot(0.05, 0.02) / std::sqrt(2.0);
  EXPECT_NEAR(other.holdout_ratio, 1.0 + std::pow(effect / 0.002, 2.0), 0.1 * other.holdout_ratio);
  // But for the one row that lies on the border.
  EXPECT_NEAR(other.identification_fit.r2, same.identification_fit.r2, 1e-4);
}

TEST(CoefficientFit, WithoutHoldOutSaysSo) {
  Segments none = aircraft::testing::pitching_segments();
  none.longitudinal.holdout.clear();
  EXPECT_FALSE(FittedCm({}, none).checks().has_holdout);
}

TEST(CoefficientFit, OfFlightsThatDifferIsTheMeanOfTheirs) {
  FittedCm cm({});
  cm.flights = aircraft::testing::pitching_set(cm.subject, 4, 0.05, 3);
  CoefficientFit together = cm.fit();
  const Eigen::VectorXd of_rows = together.of_rows;
  const FlightFits each = fit_each_flight(together, cm.view());
  ASSERT_EQ(each.fits.size(), 4U);
  ASSERT_TRUE(each.scatter.found());
  EXPECT_EQ(together.of_rows, of_rows) << "kept beside the mean";
  EXPECT_EQ(together.chosen->theta, each.scatter.mean);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(of_rows.size());
  for (const CoefficientFit& one : each.fits) sum += 0.25 * one.chosen->theta;
  EXPECT_TRUE(together.chosen->theta.isApprox(sum, 1e-3)) << "flights are known equally well";
}

}  // namespace
}  // namespace veridyn::aircraft::internal
