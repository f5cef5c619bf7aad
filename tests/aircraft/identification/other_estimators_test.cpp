#include "veridyn/aircraft/identification/other_estimators.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/exact_sensors.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"

namespace veridyn::aircraft {
namespace {

constexpr const char* kCalmFlight = R"toml(
seed = 3
[subject]
builtin = "unatrap"
[flight]
duration = 150
airspeed = 20
turbulence = "none"
[sensors]
set = "reference"
[reconstruct]
sensors = "reference"
turbulence = "none"
)toml";

FlightAnalysis identify(const std::string& more, FlightStudy* out = nullptr) {
  Progress progress;
  FlightStudy study = aircraft::testing::with_exact_sensors(
      read_study(Study::parse(std::string(kCalmFlight) + more, "calm.toml"), progress));
  FlightAnalysis analysis = identify(study, progress);
  if (out != nullptr) *out = std::move(study);
  return analysis;
}

TEST(OtherEstimators, InCalmAirOutputErrorHoldsTheTruthAndIsSharperThanRegression) {
  FlightStudy study;
  const FlightAnalysis a =
      identify("[identify]\noutput_error = true\nbootstrap = 60\nfrequency_band = [\"0.1 Hz\", \"2 Hz\"]\n", &study);
  ASSERT_EQ(a.others.output_error.size(), 2u);
  for (const AxisOutputError& axis : a.others.output_error) {
    ASSERT_TRUE(axis.attempted) << axis.text;
    EXPECT_EQ(axis.estimate.termination, estimation::OutputErrorTermination::kConverged) << axis.text;
    EXPECT_TRUE(axis.estimate.unidentifiable.empty()) << axis.text;
    EXPECT_EQ(axis.estimate.diverged_steps, 0);
  }
  int held = 0, count = 0, far = 0;
  double sharper = 0.0;
  std::map<std::string, int> of_method;
  for (const OtherParameter& p : a.others.parameters) {
    ++of_method[p.estimate.method];
    if (p.estimate.method != "output error") continue;
    const CoefficientModel& truth = study.true_subject->model.at(p.coefficient);
    const auto names = truth.parameter_names();
    const auto at = std::find(names.begin(), names.end(), p.estimate.parameter.name);
    ASSERT_NE(at, names.end());
    const double value = truth.values[at - names.begin()];
    ++count;
    held += p.estimate.parameter.low95 < value && value < p.estimate.parameter.high95;
    far += std::abs(p.estimate.parameter.value - value) > 4.0 * p.estimate.parameter.sigma;
    const auto* regression = a.estimate.find(p.estimate.parameter.name);
    ASSERT_NE(regression, nullptr);
    sharper += std::log(p.estimate.parameter.sigma / regression->sigma);
  }
  EXPECT_EQ(count, 32);
  // 95 % of 32 is 30.4 with a standard deviation of 1.2 were they independent; parameters of a coefficient are not.
  EXPECT_GE(held, 26);
  EXPECT_EQ(far, 0);
  EXPECT_LT(std::exp(sharper / count), 1.0);
  EXPECT_EQ(of_method["frequency domain"], 26);  // all but the six constants
  EXPECT_EQ(of_method["bootstrap of GTLS"] + of_method["bootstrap of OLS"], 32);
  EXPECT_EQ(a.estimate.other_methods.size(), a.others.parameters.size());
}

TEST(OtherEstimators, AreNotRunByDefault) {
  const IdentifyOptions options;
  EXPECT_TRUE(compare_other_estimators({}, {}, {}, options, *std::make_unique<Progress>()).empty());
}

}  // namespace
}  // namespace veridyn::aircraft
