#include "veridyn/aircraft/identification/parameter_groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

CoefficientResult pitching_moment() {
  const Subject subject = builtin_subject("thor");
  return aircraft::testing::identified_cm(subject, aircraft::testing::pitching(subject));
}

const estimation::MethodResult* find_method(const estimation::ParameterGroup& group, std::string_view method) {
  const auto found = std::ranges::find(group.methods, method, &estimation::MethodResult::method);
  return found == group.methods.end() ? nullptr : &*found;
}

TEST(ParameterGroups, HoldTheChosenEstimateAndEveryMethod) {
  const std::vector<CoefficientResult> results{pitching_moment()};
  const std::vector<estimation::ParameterGroup> groups = parameter_groups(results, {});
  ASSERT_EQ(groups.size(), 1U);
  const estimation::ParameterGroup& cm = groups[0];
  EXPECT_EQ(cm.name, "Cm");
  EXPECT_EQ(cm.meaning, "pitching moment");
  EXPECT_EQ(cm.verdict, results[0].verdict);
  EXPECT_EQ(cm.method, "OLS");
  EXPECT_EQ(cm.evidence.size(), results[0].evidence.size());
  ASSERT_EQ(cm.parameters.size(), results[0].model.size());
  EXPECT_EQ(cm.parameters.front().value, results[0].chosen->parameters.front().value);
  for (const char* method : {"OLS", "TLS", "GTLS", "PCA-GTLS"}) EXPECT_NE(find_method(cm, method), nullptr) << method;
}

// Two parameters of one method become one column; those of another coefficient are not this one's.
TEST(ParameterGroups, GatherOtherEstimatorsByMethod) {
  OtherEstimators others;
  const auto other = [](Coefficient c, const char* method, const char* name, double value) {
    estimation::Parameter p;
    p.name = name;
    p.value = value;
    return OtherParameter{.coefficient = c, .estimate = {method, p}};
  };
  others.parameters = {other(Coefficient::kCm, "output error", "Cm_alpha", -1.0),
                       other(Coefficient::kCm, "output error", "Cm_de", -2.0),
                       other(Coefficient::kCL, "output error", "CL_alpha", 3.0),
                       other(Coefficient::kCm, "frequency domain", "Cm_de", -2.1)};
  const std::vector<CoefficientResult> results{pitching_moment()};
  const estimation::ParameterGroup cm = parameter_groups(results, others).at(0);
  const estimation::MethodResult* output_error = find_method(cm, "output error");
  ASSERT_NE(output_error, nullptr);
  EXPECT_TRUE(output_error->usable);
  ASSERT_EQ(output_error->parameters.size(), 2U);
  EXPECT_EQ(output_error->parameters[1].value, -2.0);
  ASSERT_NE(find_method(cm, "frequency domain"), nullptr);
  EXPECT_EQ(find_method(cm, "frequency domain")->parameters.size(), 1U);
}

TEST(TrueValues, AreThoseOfTheTermsThatTheTruthHas) {
  const Subject truth = builtin_subject("thor");
  CoefficientResult cm = pitching_moment();
  cm.model.terms.push_back(parse_term("alpha^3", "test"));
  cm.model.values.push_back(0.0);
  const auto values = true_values(truth, truth, std::vector<CoefficientResult>{cm});
  EXPECT_EQ(values.size(), truth.model.find(Coefficient::kCm)->size());
  EXPECT_EQ(values.at("Cm_de"), truth.model.find(Coefficient::kCm)->value_of("de").value());
  Subject without = truth;
  without.model.coefficients[Coefficient::kCm].reset();
  EXPECT_TRUE(true_values(without, truth, std::vector<CoefficientResult>{cm}).empty());
}

TEST(Predictions, AreTheSimulatedQuantitiesThenTheCoefficientsWithAHoldOut) {
  CoefficientResult with = pitching_moment(), without = with;
  without.name = "CL";
  without.holdout_fit = {};
  const std::vector<PredictedQuantity> simulated{{.name = "airspeed", .unit = "m/s", .fit = {.rmse = 0.4, .count = 9}}};
  const auto all = predictions(simulated, std::vector<CoefficientResult>{with, without});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].name, "airspeed");
  EXPECT_EQ(all[0].fit.rmse, 0.4);
  EXPECT_EQ(all[1].name, "Cm");
  EXPECT_EQ(all[1].fit.r2, with.holdout_fit.r2);
  EXPECT_TRUE(std::isnan(all[1].lag1));
}

}  // namespace
}  // namespace veridyn::aircraft
