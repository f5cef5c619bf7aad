#include "veridyn/aircraft/model/estimated_subject.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/refusal.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Parameter;
using estimation::ParameterStatus;
using ::testing::HasSubstr;

Parameter parameter(std::string name, double value, ParameterStatus status = ParameterStatus::kIdentified) {
  Parameter p;
  p.name = std::move(name);
  p.value = value;
  p.sigma = 0.1;
  p.status = status;
  return p;
}

CoefficientModel pitching_structure() {
  CoefficientModel model{Coefficient::kCm, {}, {}};
  for (const char* term : {"1", "alpha", "de"}) model.terms.push_back(parse_term(term, "test"));
  model.values.assign(3, 0.0);
  return model;
}

CoefficientModel estimated(std::vector<Parameter> parameters) {
  estimation::Estimate estimate;
  estimate.parameters = std::move(parameters);
  const CoefficientModel structure = pitching_structure();
  return estimated_coefficient(structure, structure.parameter_names(), estimate);
}

TEST(EstimatedCoefficient, HasTheTermsThatTheEstimateHolds) {
  const CoefficientModel model =
      estimated({parameter("Cm_0", 0.1), parameter("Cm_de", -1.5, ParameterStatus::kNotExcited)});
  ASSERT_EQ(model.size(), 2U);
  EXPECT_EQ(model.value_of("1"), 0.1);
  EXPECT_EQ(model.value_of("de"), -1.5) << "what was held keeps the value it was held at";
  EXPECT_FALSE(model.value_of("alpha").has_value());
}

TEST(EstimatedCoefficient, LeavesOutWhatWasRejectedOrIsNoNumber) {
  const CoefficientModel model =
      estimated({parameter("Cm_0", 0.1), parameter("Cm_alpha", -2.0, ParameterStatus::kRejected),
                 parameter("Cm_de", std::nan(""), ParameterStatus::kNotExcited)});
  EXPECT_EQ(model.parameter_names(), std::vector<std::string>{"Cm_0"});
  // What was held in a coefficient that was rejected is no model by itself.
  EXPECT_EQ(estimated({parameter("Cm_alpha", -2.0, ParameterStatus::kRejected),
                       parameter("Cm_de", -1.0, ParameterStatus::kFixed)})
                .size(),
            0U);
}

TEST(EstimatedSubject, HasTheEstimatesValuesAndUnknownOnesElsewhere) {
  const Subject subject = builtin_subject("unatrap");
  estimation::Estimate estimate;
  estimate.parameters = {parameter("Cm_alpha", -0.9)};
  const Subject result = estimated_subject(subject, estimate, "estimate.json");
  EXPECT_EQ(result.model.find(Coefficient::kCm)->values, std::vector<double>{-0.9});
  for (const double value : result.model.find(Coefficient::kCL)->values) EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(result.model.find(Coefficient::kCL)->terms, subject.model.find(Coefficient::kCL)->terms);
  EXPECT_EQ(result.mass, subject.mass);
}

TEST(EstimatedSubject, RefusesAnEstimateOfAnotherModel) {
  const Subject subject = builtin_subject("unatrap");
  const auto refusal = [&](Parameter p) {
    estimation::Estimate estimate;
    estimate.parameters = {std::move(p)};
    return why([&] { static_cast<void>(estimated_subject(subject, estimate, "estimate.json")); });
  };
  EXPECT_EQ(refusal(parameter("Cm_alfa", 1.0)),
            "estimate.json: parameter 'Cm_alfa' is not in the study's model (did you mean 'Cm_alpha'?)");
  EXPECT_EQ(refusal(parameter("Cm_alpha", -1.0, ParameterStatus::kRejected)),
            "estimate.json: holds no usable parameter of the study's model");
}

TEST(SubjectJson, HoldsEveryTermWithItsValueAndNullWhereThatIsUnknown) {
  Subject subject = builtin_subject("unatrap");
  subject.model.find(Coefficient::kCL)->values[0] = std::nan("");
  const auto json = nlohmann::json::parse(to_json(subject));
  EXPECT_EQ(json.at("name"), "unatrap");
  EXPECT_FALSE(json.at("stall").is_null());
  EXPECT_EQ(json.at("stall").at("form"), name_of(subject.model.stall->form));
  const std::string text = json.dump();
  EXPECT_THAT(text, HasSubstr("\"CL_alpha\""));
  EXPECT_THAT(text, HasSubstr("\"value\":null"));
  EXPECT_THAT(to_json(builtin_subject("unatrap")), ::testing::Not(HasSubstr("null")));
}

}  // namespace
}  // namespace veridyn::aircraft
