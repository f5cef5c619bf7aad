#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

CoefficientModel lift_model() {
  CoefficientModel model{Coefficient::kCL, {}, {}};
  for (const char* term : {"1", "alpha", "de"}) model.terms.push_back(parse_term(term, "test"));
  model.values = {0.3, 4.0, 0.5};
  return model;
}

TEST(CoefficientTracker, ComesToTheParametersOfItsModelUnderTheirNames) {
  const CoefficientModel model = lift_model();
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(4, 4);
  W(3, 3) = 1e-4;
  CoefficientTracker tracker(model, W, {}, 20.0);
  numerics::RandomStream random(3, "lift");
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.05 * k;
    const std::array<double, 3> x{1.0, 0.1 * std::sin(1.1 * t), 0.05 * std::cos(1.7 * t)};
    const double z = 0.3 + 4.0 * x[1] + 0.5 * x[2] + 0.01 * random.normal();
    static_cast<void>(tracker.update(t, x, z));
  }
  const estimation::RegressionEstimate estimate = tracker.estimate();
  ASSERT_EQ(estimate.parameters.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const estimation::Parameter& p = estimate.parameters[i];
    EXPECT_EQ(p.name, model.parameter_names()[i]);
    EXPECT_NEAR(p.value, model.values[i], 3.5 * p.sigma) << p.name;
    EXPECT_LT(p.sigma, 0.1 * std::abs(model.values[i])) << p.name;
  }
  EXPECT_EQ(tracker.model().coefficient, Coefficient::kCL);
  const CoefficientTracker named(model, W, {}, 20.0, {"a", "b", "c"});
  EXPECT_EQ(named.regression().names(), (std::vector<std::string>{"a", "b", "c"}));
}

TrackOptions read_track(const std::string& text) {
  return TrackOptions::keys().read(Study::parse("[track]\n" + text, "study.toml").root().table("track"));
}

TEST(TrackOptions, AreReadFromTheStudy) {
  const TrackOptions plain = read_track("");
  EXPECT_TRUE(plain.coefficients.empty());
  EXPECT_EQ(plain.filter, TrackFilter::kModelFree);
  EXPECT_TRUE(plain.starts_from_study);
  const TrackOptions guarded =
      read_track("coefficients = [\"CL\", \"Cm\"]\nfilter = \"guarded\"\nstart_model = \"none\"\nmemory = \"30 s\"");
  EXPECT_EQ(guarded.coefficients, (std::vector<Coefficient>{Coefficient::kCL, Coefficient::kCm}));
  EXPECT_EQ(guarded.filter, TrackFilter::kGuarded);
  EXPECT_FALSE(guarded.starts_from_study);
  EXPECT_EQ(guarded.memory_s, 30.0);
  EXPECT_EQ(read_track("air_data = \"sensors\"").air_data, AirDataSource::kSensors);
  for (const AirDataSource source : {AirDataSource::kFilter, AirDataSource::kSensors})
    EXPECT_EQ(read_track("air_data = \"" + std::string(to_string(source)) + "\"").air_data, source);
  for (const TrackFilter filter : {TrackFilter::kModelFree, TrackFilter::kGuarded})
    EXPECT_EQ(read_track("filter = \"" + std::string(to_string(filter)) + "\"").filter, filter);
}

TEST(TrackOptions, RefuseWhatContradictsItself) {
  const auto refusal = [](const std::string& text) { return why([&] { static_cast<void>(read_track(text)); }); };
  EXPECT_EQ(refusal("coefficients = [\"Cx\"]"),
            "study.toml:2: track.coefficients: 'Cx' is unknown (did you mean 'CL'?)");
  EXPECT_THAT(refusal("start_model = \"none\""), HasSubstr("is only for filter = \"guarded\""));
  EXPECT_THAT(refusal("filter = \"guarded\"\nair_data = \"sensors\""), HasSubstr("contradicts air_data"));
  EXPECT_THAT(refusal("filter = \"guarded\"\ncoefficients = [\"Cm\"]"), HasSubstr("lists none of them"));
}

}  // namespace
}  // namespace veridyn::aircraft
