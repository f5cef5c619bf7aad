#include "veridyn/aircraft/identification/evidence/sensor_doubt.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Outcome;
using estimation::Parameter;
using estimation::ParameterStatus;
using ::testing::HasSubstr;
using ::testing::Not;

FlightSignals flown_signals() {
  FlightSignals signals;
  signals[FlightSignal::kAlpha].value = {0.01, 0.05, 0.09};
  signals[FlightSignal::kAirspeed].value = {18.0, 20.0, 22.0};
  return signals;
}

TEST(DoubtSensitivity, IsThatOfALinearLawInClosedForm) {
  // A slope over alpha and a constant: a scale of alpha divides the slope, a zero moves the constant by it.
  constexpr double kSlope = 4.0, kConstant = 0.3;
  const auto estimate = [&](const FlightSignals& changed) {
    const std::vector<double>& a = changed[FlightSignal::kAlpha].value;
    const std::vector<double> truth = flown_signals()[FlightSignal::kAlpha].value;
    const double slope = kSlope * (truth[2] - truth[0]) / (a[2] - a[0]);
    return Eigen::VectorXd(Eigen::Vector2d(kConstant + kSlope * truth[0] - slope * a[0], slope));
  };
  const Eigen::VectorXd theta = Eigen::Vector2d(kConstant, kSlope);
  const std::vector<SignalDoubt> doubts{{.signal = FlightSignal::kAlpha, .scale = 0.05},
                                        {.signal = FlightSignal::kAlpha, .zero = 0.02}};
  const Eigen::MatrixXd J = doubt_sensitivity(flown_signals(), doubts, theta, estimate);
  EXPECT_NEAR(J(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(J(1, 0), -0.05 * kSlope, 0.01 * 0.05 * kSlope);
  EXPECT_NEAR(J(0, 1), -0.02 * kSlope, 1e-12);
  EXPECT_NEAR(J(1, 1), 0.0, 1e-12);
}

TEST(DoubtSensitivity, LeavesOutWhatTheRecordingHasNotOrCannotBeEstimatedAgain) {
  const Eigen::VectorXd theta = Eigen::Vector2d(1.0, 2.0);
  const std::vector<SignalDoubt> of_beta{{.signal = FlightSignal::kBeta, .scale = 0.1}};
  const auto same = [&](const FlightSignals&) { return Eigen::VectorXd(2.0 * theta); };
  EXPECT_TRUE(doubt_sensitivity(flown_signals(), of_beta, theta, same).isZero());
  const std::vector<SignalDoubt> of_alpha{{.signal = FlightSignal::kAlpha, .scale = 0.1}};
  EXPECT_TRUE(doubt_sensitivity(flown_signals(), of_alpha, theta, [](const FlightSignals&) {
                return Eigen::VectorXd();
              }).isZero());
}

std::vector<Parameter> parameters() {
  return {{.name = "CL_alpha", .value = 4.0, .sigma = 0.05, .status = ParameterStatus::kIdentified},
          {.name = "CL_q", .value = 2.0, .sigma = 0.3, .status = ParameterStatus::kIdentified}};
}

TEST(DoubtRow, NamesWhatIsInMoreDoubtThanItsNoise) {
  const estimation::Evidence row = doubt_row("CL", parameters(), Eigen::Vector2d(0.4, 0.1));
  EXPECT_EQ(row.outcome, Outcome::kNotVerified);
  EXPECT_NEAR(row.value, 8.0, 1e-12);
  EXPECT_THAT(says(row), HasSubstr("CL_alpha by 0.4"));
  EXPECT_THAT(says(row), Not(HasSubstr("CL_q")));
  EXPECT_FALSE(advice_of(row).empty());
  const estimation::Evidence calm = doubt_row("CL", parameters(), Eigen::Vector2d(0.04, 0.1));
  EXPECT_EQ(calm.outcome, Outcome::kPassed);
  EXPECT_TRUE(advice_of(calm).empty());
}

TEST(WeakByDoubt, MarksWhatWouldBeWeakByItsInterval) {
  // 1.96 sqrt(0.05^2 + d^2) = 0.5 4.0 at d = 1.019.
  EXPECT_EQ(weak_by_doubt(parameters(), Eigen::Vector2d(1.0, 0.0))[0].status, ParameterStatus::kIdentified);
  EXPECT_EQ(weak_by_doubt(parameters(), Eigen::Vector2d(1.04, 0.0))[0].status, ParameterStatus::kWeak);
  std::vector<Parameter> rejected = parameters();
  rejected[0].status = ParameterStatus::kRejected;
  EXPECT_EQ(weak_by_doubt(rejected, Eigen::Vector2d(1.04, 0.0))[0].status, ParameterStatus::kRejected);
}

}  // namespace
}  // namespace veridyn::aircraft
