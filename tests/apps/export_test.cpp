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

// Export goes as far as it can: what was not identified is the study's, and the file and the console say so.
TEST_F(Export, OfAnAircraftThatIsPartlyIdentifiedTakesTheRestFromTheStudy) {
  const nlohmann::json lift =
      nlohmann::json::array({parameter("CL_alpha", 4.5), parameter("Cm_alpha", nullptr, "rejected")});
  std::string spoken = with(lift, "all");
  spoken.erase(spoken.find(" --quiet"), std::string(" --quiet").size());
  const Outcome all = run(spoken);
  EXPECT_EQ(all.exit_code, 0) << all.text;
  EXPECT_THAT(all.text, HasSubstr("the flight    1: CL\n"));
  EXPECT_THAT(all.text, HasSubstr(": CD, CY, Cl, Cm, Cn, inertia"));
  for (const char* name : {"model.json", "subject.toml", "model.csv"})
    EXPECT_THAT(read_file(in_out(name)), HasSubstr("4.5")) << name;
  EXPECT_THAT(read_file(in_out("subject.toml")), HasSubstr("unknown"));
  const std::string xml = read_file(in_out("jsbsim.xml"));
  EXPECT_THAT(xml, HasSubstr("<description>identified, 95 %: 1 to 9</description>"));
  EXPECT_THAT(xml, HasSubstr("<description>the study's, not identified</description>"));
}

/// A study of an aircraft of which only the structure is known.
constexpr const char* kOwnAircraft =
    "[subject]\nname = \"mine\"\nmass = 1.9\nwing_area = 0.31\nspan = 1.27\nchord = 0.25\n"
    "inertia = { Jx = 0.07, Jy = 0.086, Jz = 0.15, Jxz = 0.01 }\n"
    "[subject.model]\nCL = [\"1\", \"alpha\", \"q_n\", \"de\"]\nCD = [\"1\", \"alpha\", \"alpha^2\"]\n"
    "Cm = [\"1\", \"alpha\", \"q_n\", \"de\"]\n";

// README's last command on a log without thrust: drag, the lateral motion and the engine are estimates.
TEST_F(Export, OfALogWithoutThrustEstimatesDragEngineAndWhatWasNotExcited) {
  nlohmann::json parameters = nlohmann::json::array();
  for (const auto& [name, value] :
       {std::pair{"CL_0", 0.1}, std::pair{"CL_alpha", 4.6}, std::pair{"CL_q", 6.2}, std::pair{"CL_de", 0.1},
        std::pair{"Cm_0", -0.02}, std::pair{"Cm_alpha", -0.7}, std::pair{"Cm_q", -13.0}, std::pair{"Cm_de", -0.8}}) {
    parameters.push_back(parameter(name, value));
    parameters.back()["low95"] = value - 0.2;
    parameters.back()["high95"] = value + 0.2;
  }
  const nlohmann::json estimate = {{"subject", "mine"},
                                   {"method", "GTLS"},
                                   {"parameters", parameters},
                                   {"covariance", std::vector(8, std::vector(8, 0.0))},
                                   {"fit", {{"flight.airspeed", 16.0}, {"flight.air_density", 1.2}}},
                                   {"verdict", ""},
                                   {"warnings", nlohmann::json::array()}};
  const std::string command = "export " + file("s.toml", kOwnAircraft) + " --format jsbsim --estimate-file " +
                              file("e.json", estimate.dump()) + " --out " + (folder_ / "out").string();
  const Outcome exported = run(command);
  ASSERT_EQ(exported.exit_code, 0) << exported.text;
  EXPECT_THAT(exported.text, HasSubstr("the flight    8: CL, Cm\n"));
  EXPECT_THAT(exported.text, HasSubstr("an estimate"));
  EXPECT_THAT(exported.text, HasSubstr("thrust at full throttle"));
  EXPECT_THAT(exported.text, HasSubstr("trimmed at 16 m/s"));
  EXPECT_THAT(exported.text, HasSubstr("short period"));
  EXPECT_THAT(exported.text, HasSubstr("not how this one does"));
  const std::string xml = read_file(in_out("jsbsim.xml"));
  EXPECT_THAT(xml, HasSubstr("<description>identified, 95 %: 4.4 to 4.8</description>"));
  EXPECT_THAT(xml, HasSubstr("<description>estimate: Raymer"));
  EXPECT_THAT(xml, HasSubstr("aero/coefficient/Cn_beta"));
  const auto summary = nlohmann::json::parse(run(command + " --quiet --json").text);
  EXPECT_EQ(summary["jsbsim"]["trimmed"], true);
  EXPECT_EQ(summary["jsbsim"]["flies_as_predicted"], true);
  EXPECT_EQ(summary["jsbsim"]["sources"]["CL_alpha"]["from"], "the flight");
  EXPECT_EQ(summary["jsbsim"]["sources"]["CD_0"]["from"], "an estimate");
}

// The subject.toml of an identification lies beside its estimate.json, which has the intervals and the grades.
TEST_F(Export, OfASubjectTakesIntervalsFromTheEstimateBesideIt) {
  nlohmann::json estimate = {{"subject", "aerosonde"},
                             {"method", "OLS"},
                             {"parameters", all_parameters()},
                             {"covariance", std::vector(29, std::vector(29, 0.0))},
                             {"verdict", ""},
                             {"warnings", nlohmann::json::array()}};
  estimate.update(effective());
  ASSERT_EQ(run("export " + file("s.toml", "[subject]\nbuiltin = \"aerosonde\"\n") + " --format toml --estimate-file " +
                file("e.json", estimate.dump()) + out())
                .exit_code,
            0);
  const std::string subject = file("subject.toml", read_file(in_out("subject.toml")));
  static_cast<void>(file("estimate.json", estimate.dump()));
  ASSERT_EQ(run("export " + subject + " --format jsbsim" + out()).exit_code, 0);
  const std::string xml = read_file(in_out("jsbsim.xml"));
  EXPECT_THAT(xml, HasSubstr("<description>identified, 95 %: 1 to 9</description>"));
  EXPECT_THAT(xml, HasSubstr("must not be taken for physical constants"));
  // Another aircraft's estimate says nothing of this one.
  estimate["subject"] = "another";
  static_cast<void>(file("estimate.json", estimate.dump()));
  ASSERT_EQ(run("export " + subject + " --format jsbsim" + out()).exit_code, 0);
  EXPECT_THAT(read_file(in_out("jsbsim.xml")), testing::Not(HasSubstr("95 %")));
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
  // What was rejected is not in the file: a simulator gets the study's.
  ASSERT_EQ(run(with(all_parameters("Cm_", "rejected"), "jsbsim", effective())).exit_code, 0);
  const std::string xml = read_file(in_out("jsbsim.xml"));
  EXPECT_THAT(xml, HasSubstr("the study's, not identified"));
  EXPECT_THAT(xml, HasSubstr("must not be taken for physical constants"));
  // Of an aircraft of which nothing is known there is none.
  expect_refusal("export " + file("own.toml", kOwnAircraft) + " --format jsbsim" + out(),
                 "no parameter of its model is known");
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
