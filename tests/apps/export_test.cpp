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
  [[nodiscard]] std::string with(const nlohmann::json& parameters, const std::string& format = "json",
                                 const nlohmann::json& judged = nlohmann::json::object()) const {
    std::vector<std::vector<double>> covariance(parameters.size(), std::vector<double>(parameters.size()));
    nlohmann::json estimate = {{"subject", "x"},           {"method", "OLS"}, {"parameters", parameters},
                               {"covariance", covariance}, {"verdict", ""},   {"warnings", nlohmann::json::array()}};
    estimate.update(judged);
    return "export " + file("s.toml", "[subject]\nbuiltin = \"aerosonde\"\n") + " --format " + format +
           " --estimate-file " + file("e.json", estimate.dump()) + out();
  }
  /// All parameters of the Aerosonde's model, those that begin with `other` having another status.
  [[nodiscard]] static nlohmann::json all_parameters(const std::string& other = "none", const char* status = "") {
    nlohmann::json parameters = nlohmann::json::array();
    for (const char* name :
         {"CL_0",     "CL_alpha", "CL_q",  "CL_de", "CD_0",    "CD_alpha", "CD_alpha2", "CY_0",  "CY_beta", "CY_p",
          "CY_r",     "CY_da",    "CY_dr", "Cl_0",  "Cl_beta", "Cl_p",     "Cl_r",      "Cl_da", "Cl_dr",   "Cm_0",
          "Cm_alpha", "Cm_q",     "Cm_de", "Cn_0",  "Cn_beta", "Cn_p",     "Cn_r",      "Cn_da", "Cn_dr"})
      parameters.push_back(parameter(name, 0.1, std::string(name).starts_with(other) ? status : "identified"));
    return parameters;
  }
  /// What an estimate that predicts, but whose values are no physical constants, says of itself.
  [[nodiscard]] static nlohmann::json effective() {
    const auto grade = [](const char* text) -> nlohmann::json {
      return {{"grade", text}, {"because", nlohmann::json::array()}};
    };
    const nlohmann::json row = {{"name", "residual beyond the sensors"},
                                {"about", "CL"},
                                {"outcome", "failed"},
                                {"value", 0.3},
                                {"limit", 0.1},
                                {"scale", "share of the variance"},
                                {"text", "30 % of its variance is not modelled"},
                                {"bears_on", {"parameters"}},
                                {"advice", ""}};
    return {{"grades", {{"data", grade("yes")}, {"parameters", grade("no")}, {"prediction", grade("with care")}}},
            {"evidence", nlohmann::json::array({row})}};
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

// What JSBSim cannot fly is written as far as it is known by the formats that can say "unknown".
TEST_F(Export, OfAnAircraftThatIsPartlyIdentifiedWritesAllButJsbsim) {
  const nlohmann::json lift =
      nlohmann::json::array({parameter("CL_alpha", 4.5), parameter("Cm_alpha", nullptr, "rejected")});
  std::string spoken = with(lift, "all");
  spoken.erase(spoken.find(" --quiet"), std::string(" --quiet").size());
  const Outcome all = run(spoken);
  EXPECT_EQ(all.exit_code, 0) << all.text;
  EXPECT_THAT(all.text, HasSubstr("JSBSim needs every parameter, these have no value: CD_0"));
  for (const char* name : {"model.json", "subject.toml", "model.csv"})
    EXPECT_THAT(read_file(in_out(name)), HasSubstr("4.5")) << name;
  EXPECT_THAT(read_file(in_out("subject.toml")), HasSubstr("unknown"));
  EXPECT_FALSE(std::filesystem::exists(in_out("jsbsim.xml")));
  expect_refusal(with(lift, "jsbsim"), "JSBSim needs every parameter");
}

constexpr const char* kEffectiveSentence =
    "The recording agrees with itself and with physics; the parameters must not be taken for physical constants; the "
    "model predicts held-out data, with care.";

// Whoever opens a file in a simulator sees first for which purposes its numbers may be used.
TEST_F(Export, RepeatsTheGradesInEveryFileThatASimulatorReads) {
  std::string loud = with(all_parameters("CL_", "effective"), "all", effective());
  loud.erase(loud.find(" --quiet"), std::string(" --quiet").size());
  const Outcome exported = run(loud);
  ASSERT_EQ(exported.exit_code, 0) << exported.text;
  EXPECT_THAT(exported.text, HasSubstr(kEffectiveSentence));
  EXPECT_THAT(read_file(in_out("subject.toml")), testing::StartsWith(std::string("# ") + kEffectiveSentence + "\n"));
  const std::string xml = read_file(in_out("jsbsim.xml"));
  EXPECT_EQ(xml.find(std::string("<!-- ") + kEffectiveSentence + " -->"), xml.find('\n') + 1)
      << "below the declaration";
  const auto model = nlohmann::json::parse(read_file(in_out("model.json")));
  EXPECT_EQ(model["grades"]["data"], "yes");
  EXPECT_EQ(model["grades"]["parameters"], "no");
  EXPECT_EQ(model["grades"]["prediction"], "with care");
  EXPECT_EQ(model["coefficients"]["CL"][0]["status"], "effective");
}

// Files of versions before there were grades, or the study's own values.
TEST_F(Export, GradesNothingThatWasNotJudged) {
  ASSERT_EQ(run(with(all_parameters(), "all")).exit_code, 0);
  EXPECT_THAT(read_file(in_out("subject.toml")), testing::Not(HasSubstr("held-out")));
  EXPECT_THAT(read_file(in_out("jsbsim.xml")), testing::Not(HasSubstr("held-out")));
  EXPECT_FALSE(nlohmann::json::parse(read_file(in_out("model.json"))).contains("grades"));
}

TEST_F(Export, RefusesAnEstimateOfWhichNothingMayBeUsed) {
  expect_refusal(with(nlohmann::json::array({parameter("CL_alpha", 4.5, "rejected")}), "all", effective()),
                 "e.json: holds no usable parameter of the study's model");
  // A simulator would take what was rejected for zero.
  expect_refusal(with(all_parameters("Cm_", "rejected"), "jsbsim", effective()),
                 "JSBSim needs every parameter, these have no value: Cm_0, Cm_alpha, Cm_q, Cm_de");
}

// A term that the flight did not excite is held and keeps its status where the coefficient is rejected: lift by the
// pitch rate alone would be no lift.
TEST_F(Export, MakesNoCoefficientOfWhatWasHeldBesideRejectedTerms) {
  ASSERT_EQ(
      run(with(nlohmann::json::array({parameter("CL_alpha", 4.5, "rejected"), parameter("CL_q", 7.0, "not_excited"),
                                      parameter("CD_0", 0.03), parameter("CD_alpha", 0.2, "not_excited")})))
          .exit_code,
      0);
  const auto model = nlohmann::json::parse(read_file(in_out("model.json")));
  for (const auto& term : model["coefficients"]["CL"]) EXPECT_TRUE(term["value"].is_null()) << term;
  // Beside what was identified it is part of the model.
  EXPECT_EQ(model["coefficients"]["CD"].size(), 2u);
}

}  // namespace
}  // namespace veridyn
