// veridyn export --estimate: an estimate that does not fit is refused, not trimmed.
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"

namespace veridyn {
namespace {

using testing::HasSubstr;

class Export : public ProgramTest {
 protected:
  [[nodiscard]] static nlohmann::json parameter(const std::string& name, const nlohmann::json& value,
                                                const std::string& status = "identified") {
    return {{"name", name}, {"value", value}, {"sigma", 0.1},    {"low95", 1.0},
            {"high95", 9},  {"unit", "1"},    {"status", status}};
  }
  /// Arguments of an export of the Aerosonde's lift with these parameters.
  [[nodiscard]] std::string with(const nlohmann::json& parameters) const {
    std::vector<std::vector<double>> covariance(parameters.size(), std::vector<double>(parameters.size()));
    const nlohmann::json estimate = {
        {"subject", "x"},           {"method", "OLS"}, {"parameters", parameters},
        {"covariance", covariance}, {"verdict", ""},   {"warnings", nlohmann::json::array()}};
    return "export " + file("s.toml", "[subject]\nbuiltin = \"aerosonde\"\n") + " --format json --estimate-file " +
           file("e.json", estimate.dump()) + out();
  }
};

TEST_F(Export, RefusesAParameterThatTheModelDoesNotHave) {
  expect_refusal(with(nlohmann::json::array({parameter("CL_alpha", 4.5), parameter("CL_alhpa", 4.5)})),
                 "e.json: parameter 'CL_alhpa' is not in the study's model (did you mean 'CL_alpha'?)");
}

TEST_F(Export, RefusesAUsableParameterWithoutAValue) {
  expect_refusal(with(nlohmann::json::array({parameter("CL_alpha", nullptr)})),
                 "e.json: parameter 'CL_alpha': has no value, but status identified");
  expect_refusal(with(nlohmann::json::array({parameter("CL_alpha", nullptr, "insignificant")})),
                 "has no value, but status insignificant");
}

TEST_F(Export, RefusesANegativeErrorBar) {
  nlohmann::json wrong = parameter("CL_alpha", 4.5);
  wrong["sigma"] = -1;
  expect_refusal(with(nlohmann::json::array({wrong})), "e.json: parameter 'CL_alpha': sigma is -1; must be >= 0");
}

TEST_F(Export, TakesTheOldNameOfItsOptionWithANote) {
  std::string arguments = with(nlohmann::json::array({parameter("CL_alpha", 4.5)}));
  arguments.replace(arguments.find("--estimate-file "), std::string("--estimate-file ").size(), "--estimate=");
  const Outcome exported = run(arguments);
  EXPECT_EQ(exported.exit_code, 0);
  EXPECT_EQ(exported.text, "note: --estimate is now called --estimate-file\n");
}

TEST_F(Export, MakesUnknownWhatWasNotIdentified) {
  ASSERT_EQ(
      run(with(nlohmann::json::array({parameter("CL_alpha", 4.5), parameter("CD_0", nullptr, "rejected")}))).exit_code,
      0);
  const auto model = nlohmann::json::parse(read_file(in_out("model.json")));
  ASSERT_EQ(model["coefficients"]["CL"].size(), 1u);
  EXPECT_EQ(model["coefficients"]["CL"][0]["value"], 4.5);
  for (const char* coefficient : {"CD", "Cm"}) {
    for (const auto& term : model["coefficients"][coefficient]) EXPECT_TRUE(term["value"].is_null()) << term;
  }
}

}  // namespace
}  // namespace veridyn
