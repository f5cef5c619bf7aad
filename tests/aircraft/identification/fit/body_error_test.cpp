#include "veridyn/aircraft/identification/fit/body_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/aircraft/identification/identified_estimate.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

using F = FlightSignal;
using aircraft::testing::identified_cm;
using aircraft::testing::pitching;

TEST(BodyError, OfTheMomentOfInertiaIsACommonFactorOfItsDerivatives) {
  Subject subject = builtin_subject("thor");
  const FlightSignals signals = pitching(subject);
  const CoefficientResult without = identified_cm(subject, signals);
  ASSERT_EQ(without.verdict, estimation::GroupVerdict::kIdentified) << without.reason;
  const double e = 0.1;
  subject.sigma.Jy = e * subject.inertia->Jy;
  const CoefficientResult with = identified_cm(subject, signals);
  ASSERT_EQ(with.chosen->parameters.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& a = without.chosen->parameters[i];
    const auto& b = with.chosen->parameters[i];
    EXPECT_EQ(a.value, b.value);
    // No rate but q: J q' is all, so that the error is exactly a factor.
    EXPECT_NEAR(b.sigma, std::hypot(a.sigma, e * a.value), 1e-9 * b.sigma) << a.name;
    EXPECT_NEAR((b.high95 - b.low95) / (a.high95 - a.low95), b.sigma / a.sigma, 1e-9);
    EXPECT_EQ(a.sigma_white, b.sigma_white);
  }
  const auto& P = with.chosen->covariance;
  EXPECT_NEAR(P(1, 2) - without.chosen->covariance(1, 2), e * e * with.chosen->theta(1) * with.chosen->theta(2),
              1e-9 * std::abs(P(1, 2)));
  EXPECT_NE(with.reason.find("its error bars are mostly those of Jy (10 %)"), std::string::npos) << with.reason;
}

TEST(BodyError, OfAnUndeterminedInertiaLeavesNoDerivativeSignificant) {
  Subject subject = builtin_subject("thor");
  const FlightSignals signals = pitching(subject);
  subject.sigma.Jy = 0.6 * subject.inertia->Jy;
  const CoefficientResult result = identified_cm(subject, signals);
  for (const auto& p : result.chosen->parameters) {
    EXPECT_EQ(p.status, estimation::ParameterStatus::kInsignificant) << p.name;
    EXPECT_LT(p.low95 * p.high95, 0.0) << p.name;
  }
}

// The chord is in the moment's reference and in q_n: Cm ~ 1/c, Cm_q ~ 1/c^2.
TEST(BodyError, OfTheChordFollowsTheDefinitionOfTheCoefficients) {
  Subject subject = builtin_subject("thor");
  const FlightSignals signals = pitching(subject);
  subject.sigma.chord = 0.01 * subject.chord;
  const CoefficientResult result = identified_cm(subject, signals);
  const Eigen::VectorXd relative = result.body_sensitivity.col(3).cwiseQuotient(result.chosen->theta);
  EXPECT_NEAR(relative(1), -0.01, 1e-6);
  EXPECT_NEAR(relative(2), -0.02, 1e-6);
  EXPECT_NEAR(relative(3), -0.01, 1e-6);
}

TEST(BodyError, IsSharedByTheCoefficientsOfAnEstimate) {
  Subject subject = builtin_subject("thor");
  CoefficientResult a, b;
  for (CoefficientResult* r : {&a, &b}) {
    r->verdict = estimation::GroupVerdict::kIdentified;
    r->model = coefficient_model(Coefficient::kCl, std::vector<std::pair<std::string_view, double>>{{"beta", 1.0}});
    r->chosen.emplace();
    r->chosen->theta = Eigen::VectorXd::Ones(1);
    r->chosen->covariance = Eigen::MatrixXd::Ones(1, 1);
    r->chosen->parameters.resize(1);
    r->body_sensitivity = Eigen::MatrixXd::Zero(1, kBodyConstants);
  }
  a.name = "Cl";
  b.name = "Cn";
  a.body_sensitivity(0, 0) = 0.3;
  b.body_sensitivity(0, 0) = 0.2;
  b.body_sensitivity(0, 5) = 0.7;
  const estimation::Estimate estimate = make_estimate(subject, std::vector<CoefficientResult>{a, b});
  EXPECT_NEAR(estimate.covariance(0, 1), 0.06, 1e-15);
  EXPECT_NEAR(estimate.covariance(1, 0), 0.06, 1e-15);
}

// Without a tensor: what comes out is the moment over the moment of inertia.
TEST(PerUnitInertia, GivesTheDerivativesOverTheMomentOfInertia) {
  Subject subject = builtin_subject("thor");
  const FlightSignals signals = pitching(subject);
  const double Jy = subject.inertia->Jy;
  const CoefficientResult known = identified_cm(subject, signals);
  subject.inertia.reset();
  const CoefficientResult result = identified_cm(subject, signals);
  ASSERT_EQ(result.verdict, estimation::GroupVerdict::kIdentified) << result.reason;
  EXPECT_EQ(result.name, "Cm/Jy");
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& p = result.chosen->parameters[i];
    EXPECT_NEAR(p.value, known.chosen->parameters[i].value / Jy, 1e-9 * std::abs(p.value));
    EXPECT_NEAR(p.sigma, known.chosen->parameters[i].sigma / Jy, 1e-6 * p.sigma);
  }
  EXPECT_EQ(result.chosen->parameters[1].name, "Cm/Jy_alpha");
  EXPECT_EQ(result.chosen->parameters[1].unit, "1/rad/kg/m^2");
  EXPECT_NE(result.reason.find("per unit inertia"), std::string::npos);
  // Nothing can be flown with it.
  EXPECT_FALSE(
      identified_subject(subject, std::vector<CoefficientResult>{result}).model.find(Coefficient::kCm)->known());
  EXPECT_TRUE(identified_coefficients(std::vector<CoefficientResult>{result}).empty());
}

// For a flat body with Jx = Jy, of which the assumption is true, nothing is lost.
TEST(PerUnitInertia, IsExactForAFlatBody) {
  Subject subject = builtin_subject("thor");
  subject.inertia = Inertia{.Jx = 0.08, .Jy = 0.08, .Jz = 0.16, .Jxz = 0.0};
  numerics::RandomStream random(4, "flat");
  for (int i = 0; i < 20; ++i) {
    FlightSample<double> s;
    for (double& v : s.value) v = random.normal();
    s[F::kAirspeed] = 20.0;
    const AeroCoefficients<double> full = measured_coefficients(s, subject, 1.2);
    const AeroCoefficients<double> unit = coefficients_per_unit_inertia(s, subject, 1.2);
    EXPECT_NEAR(unit.Cl, full.Cl / 0.08, 1e-12);
    EXPECT_NEAR(unit.Cm, full.Cm / 0.08, 1e-12);
    EXPECT_NEAR(unit.Cn, full.Cn / 0.16, 1e-12);
    EXPECT_EQ(unit.CL, full.CL);
  }
}

TEST(BodySigma, IsReadWrittenAndRefusedWhenNegative) {
  const Study study =
      Study::parse("[subject]\nbuiltin = \"thor\"\nsigma = { mass = \"20 gram\", Jy = 0.01 }\n", "s.toml");
  const Subject subject = read_subject(study.root().table("subject"));
  EXPECT_NEAR(subject.sigma.mass, 0.02, 1e-15);
  const Study again = Study::parse(write_subject_toml(subject), "t.toml");
  EXPECT_EQ(read_subject(again.root().table("subject")), subject);
  const Study wrong = Study::parse("[subject]\nbuiltin = \"thor\"\nsigma = { Jy = -1 }\n", "s.toml");
  EXPECT_THROW(static_cast<void>(read_subject(wrong.root().table("subject"))), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
