#include "veridyn/aircraft/identification/identified_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

/// Cm of the pitching flight, identified, and a CL that was not excited.
struct IdentifiedFlight {
  IdentifiedFlight() {
    results.push_back(aircraft::testing::identified_cm(subject, aircraft::testing::pitching(subject)));
    CoefficientResult lift;
    lift.coefficient = Coefficient::kCL;
    lift.name = "CL";
    lift.model = *subject.model.find(Coefficient::kCL);
    lift.verdict = estimation::GroupVerdict::kNotExcited;
    results.push_back(lift);
    CoefficientResult drag;
    drag.coefficient = Coefficient::kCD;
    drag.name = "CD";
    drag.model = *subject.model.find(Coefficient::kCD);
    drag.verdict = estimation::GroupVerdict::kSkipped;
    results.push_back(drag);
  }
  Subject subject = builtin_subject("thor");
  std::vector<CoefficientResult> results;
};

TEST(IdentifiedEstimate, HoldsWhatWasChosenWithItsFitAndHoldOut) {
  const IdentifiedFlight flight;
  const CoefficientResult& cm = flight.results[0];
  const estimation::Estimate estimate = make_estimate(flight.subject, flight.results);
  EXPECT_EQ(estimate.subject, "thor");
  EXPECT_EQ(estimate.method, "OLS");
  const estimation::Parameter* p = estimate.find("Cm_de");
  ASSERT_NE(p, nullptr);
  EXPECT_NEAR(p->value, flight.subject.model.find(Coefficient::kCm)->value_of("de").value(), 3.5 * p->sigma);
  EXPECT_EQ(estimate.fit.at("Cm.samples"), static_cast<double>(cm.chosen->rows));
  EXPECT_EQ(estimate.fit.at("Cm.r2"), cm.identification_fit.r2);
  EXPECT_EQ(estimate.validation.at("Cm").rmse, cm.holdout_fit.rmse);
  const Eigen::Index n = cm.chosen->theta.size();
  EXPECT_EQ(estimate.covariance.topLeftCorner(n, n), cm.chosen->covariance);
}

// A parameter that is missing would be read as zero.
TEST(IdentifiedEstimate, ListsWhatWasNotExcitedWithoutAValue) {
  const IdentifiedFlight flight;
  const estimation::Estimate estimate = make_estimate(flight.subject, flight.results);
  const estimation::Parameter* p = estimate.find("CL_alpha");
  ASSERT_NE(p, nullptr);
  EXPECT_TRUE(std::isnan(p->value));
  EXPECT_EQ(p->status, estimation::ParameterStatus::kNotExcited);
  EXPECT_EQ(p->unit, "1/rad");
  EXPECT_EQ(estimate.find("CD_0"), nullptr) << "what was skipped was not looked for";
  EXPECT_EQ(static_cast<Eigen::Index>(estimate.parameters.size()), estimate.covariance.rows());
  const Eigen::Index last = estimate.covariance.rows() - 1;
  EXPECT_TRUE(std::isnan(estimate.covariance(last, last)));
}

TEST(IdentifiedSubject, HasTheIdentifiedValuesAndNoOthers) {
  const IdentifiedFlight flight;
  const Subject identified = identified_subject(flight.subject, flight.results);
  EXPECT_EQ(identified_coefficients(flight.results), std::vector<Coefficient>{Coefficient::kCm});
  EXPECT_EQ(identified.model.find(Coefficient::kCm)->values, flight.results[0].model.values);
  for (const Coefficient c : {Coefficient::kCL, Coefficient::kCD, Coefficient::kCn})
    for (const double value : identified.model.find(c)->values) EXPECT_TRUE(std::isnan(value)) << name_of(c);
}

// Moments per unit inertia are no coefficients: nothing can be simulated with them. Nor with what was rejected.
TEST(IdentifiedSubject, TakesNeitherWhatIsPerUnitInertiaNorWhatWasRejected) {
  IdentifiedFlight flight;
  flight.results[0].per_unit_inertia = true;
  const auto first_value = [&flight] {
    return identified_subject(flight.subject, flight.results).model.find(Coefficient::kCm)->values[0];
  };
  EXPECT_TRUE(identified_coefficients(flight.results).empty());
  EXPECT_TRUE(std::isnan(first_value()));
  flight.results[0].per_unit_inertia = false;
  EXPECT_FALSE(std::isnan(first_value()));
  flight.results[0].verdict = estimation::GroupVerdict::kRejected;
  EXPECT_TRUE(identified_coefficients(flight.results).empty());
  EXPECT_TRUE(std::isnan(first_value()));
}

}  // namespace
}  // namespace veridyn::aircraft
