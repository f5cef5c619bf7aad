#include "veridyn/aircraft/model/aero_model.hpp"

#include <ceres/jet.h>

#include "tests/support/refusal.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

AeroVariables<double> some_variables() {
  return {.alpha = 0.12,
          .beta = -0.05,
          .p_n = 0.03,
          .q_n = 0.004,
          .r_n = -0.01,
          .de = -0.07,
          .da = 0.02,
          .dr = 0.03,
          .CT = 0.4,
          .Va = 17.0};
}

double value(std::string_view term) { return parse_term(term, "here").evaluate(some_variables()); }

TEST(Term, EvaluatesProductsPowersAbsolutesAndSplines) {
  EXPECT_DOUBLE_EQ(value("1"), 1.0);
  EXPECT_DOUBLE_EQ(value("alpha"), 0.12);
  EXPECT_DOUBLE_EQ(value("alpha^2"), 0.12 * 0.12);
  EXPECT_DOUBLE_EQ(value("alpha*q_n"), 0.12 * 0.004);
  EXPECT_DOUBLE_EQ(value(" q_n * alpha "), 0.12 * 0.004);
  EXPECT_DOUBLE_EQ(value("abs(de)"), 0.07);
  EXPECT_DOUBLE_EQ(value("abs(beta)^3"), 0.05 * 0.05 * 0.05);
  EXPECT_DOUBLE_EQ(value("CT*Va"), 0.4 * 17.0);
  EXPECT_DOUBLE_EQ(value("spline(alpha, 0.1, 2)"), (0.12 - 0.1) * (0.12 - 0.1));
  EXPECT_NEAR(value("spline(alpha, 5 deg, 1)"), 0.12 - 5 * M_PI / 180, 1e-15);
  EXPECT_DOUBLE_EQ(value("spline(alpha, 0.2, 2)"), 0.0);
  EXPECT_DOUBLE_EQ(value("spline(alpha, 0.1, 0)"), 1.0);
}

TEST(Term, HasOneCanonicalTextThatReadsBackEqual) {
  EXPECT_EQ(parse_term("q_n*alpha", "here").expression, "alpha*q_n");
  EXPECT_EQ(parse_term("alpha*1*alpha", "here").expression, "alpha^2");
  EXPECT_TRUE(parse_term("q_n*alpha", "here") == parse_term("alpha * q_n", "here"));
  for (const char* text : {"1", "alpha^3*beta", "abs(de)", "abs(alpha)^2", "spline(alpha, 5 deg, 2)",
                           "spline(alpha, 0.1, 3)", "spline(Va, 17.5 m/s, 1)", "beta*spline(alpha, -2.5 deg, 1)"}) {
    const Term once = parse_term(text, "here");
    const Term twice = parse_term(once.expression, "here");
    EXPECT_TRUE(once == twice) << text;
    EXPECT_EQ(once.expression, twice.expression);
  }
}

TEST(Term, NamesItsParameterAsTheLiteratureDoes) {
  const auto name = [](Coefficient c, std::string_view t) { return parameter_name(c, parse_term(t, "here")); };
  EXPECT_EQ(name(Coefficient::kCL, "1"), "CL_0");
  EXPECT_EQ(name(Coefficient::kCL, "alpha"), "CL_alpha");
  EXPECT_EQ(name(Coefficient::kCD, "alpha^2"), "CD_alpha2");
  EXPECT_EQ(name(Coefficient::kCm, "q_n"), "Cm_q");
  EXPECT_EQ(name(Coefficient::kCL, "q_n*alpha"), "CL_alpha_q");
  EXPECT_EQ(name(Coefficient::kCY, "dr"), "CY_dr");
  EXPECT_EQ(name(Coefficient::kCD, "CT"), "CD_CT");
  EXPECT_EQ(name(Coefficient::kCD, "abs(de)"), "CD_abs_de");
  EXPECT_EQ(name(Coefficient::kCL, "spline(alpha, 5 deg, 2)"), "CL_spline_alpha_5deg_2");
  EXPECT_EQ(name(Coefficient::kCn, "p_n"), "Cn_p");
}

TEST(Term, RefusesWhatItDoesNotKnowNamingTheNearest) {
  const auto message = [](std::string_view t) { return why([&] { static_cast<void>(parse_term(t, "s.toml:3")); }); };
  EXPECT_EQ(message("alhpa"), "s.toml:3: term 'alhpa': unknown variable 'alhpa' (did you mean 'alpha'?)");
  EXPECT_THAT(message("alpha*"), HasSubstr("a factor is missing"));
  EXPECT_THAT(message(""), HasSubstr("an empty term"));
  EXPECT_THAT(message("alpha^0"), HasSubstr("power '0' is not a whole number from 1 to 9"));
  EXPECT_THAT(message("alpha^6*alpha^6"), HasSubstr("power 12 is above 9"));
  EXPECT_THAT(message("alpha^1.5"), HasSubstr("power '1.5'"));
  EXPECT_THAT(message("spline(alpha, 2)"), HasSubstr("spline(variable, knot, degree)"));
  EXPECT_THAT(message("spline(alpha, 2 m, 1)"), HasSubstr("unit 'm' is a length"));
  EXPECT_THAT(message("spline(alpha, two, 1)"), HasSubstr("knot 'two' is not a number"));
  EXPECT_THAT(message("abs(alpha"), HasSubstr("closing parenthesis"));
}

AeroModel model_with(StallForm form, bool drag = true) {
  AeroModel m;
  m.set(coefficient_model(Coefficient::kCL, std::vector<std::pair<std::string_view, double>>{
                                                {"1", 0.3}, {"alpha", 4.0}, {"q_n", 3.0}, {"de", 0.4}}));
  m.set(coefficient_model(Coefficient::kCD, std::vector<std::pair<std::string_view, double>>{
                                                {"1", 0.05}, {"alpha", 0.1}, {"alpha^2", 1.5}}));
  m.stall = StallBlend{.M = 40, .alpha0 = 0.3, .form = form, .drag = drag};
  return m;
}

TEST(AeroModel, BlendsIntoTheFlatPlateInBothForms) {
  AeroVariables<double> v = some_variables();
  for (const double a : {-1.2, -0.31, 0.0, 0.25, 0.32, 1.0}) {
    v.alpha = a;
    const double s = separated_share(a, 40.0, 0.3);
    const double plate_CL = 2 * (a < 0 ? -1 : 1) * std::pow(std::sin(a), 2) * std::cos(a);
    const double plate_CD = 2 * std::pow(std::sin(a), 2);
    const double rest = 3.0 * v.q_n + 0.4 * v.de;
    const auto full = model_with(StallForm::kFull).evaluate(v);
    EXPECT_NEAR(full.CL, (1 - s) * (0.3 + 4 * a + rest) + s * plate_CL, 1e-14);
    EXPECT_NEAR(full.CD, (1 - s) * (0.05 + 0.1 * a + 1.5 * a * a) + s * plate_CD, 1e-14);
    const auto source = model_with(StallForm::kSource).evaluate(v);
    EXPECT_NEAR(source.CL, (1 - s) * (0.3 + 4 * a) + s * plate_CL + rest, 1e-14);
    EXPECT_NEAR(source.CD, (1 - s) * (0.05 + 0.1 * a) + s * plate_CD + 1.5 * a * a, 1e-14);
    EXPECT_NEAR(model_with(StallForm::kFull, false).evaluate(v).CD, 0.05 + 0.1 * a + 1.5 * a * a, 1e-14);
    const auto kirchhoff = model_with(StallForm::kSeparation).evaluate(v);
    const double attached = 1 / ((1 + std::exp(40.0 * (a - 0.3))) * (1 + std::exp(-40.0 * (a + 0.3))));
    EXPECT_NEAR(attached, 1 - s, 1e-14);
    EXPECT_NEAR(kirchhoff.CL, std::pow(0.5 * (1 + std::sqrt(attached)), 2) * (0.3 + 4 * a) + rest, 1e-14);
  }
}

TEST(AeroModel, HasTheDerivativesOfItsDifferencesThroughJets) {
  using Jet = ceres::Jet<double, 1>;
  for (const StallForm form : {StallForm::kFull, StallForm::kSource, StallForm::kSeparation}) {
    const AeroModel m = model_with(form);
    for (const double a : {-0.5, -0.29, 0.1, 0.28, 0.31, 0.7}) {
      AeroVariables<Jet> v;
      v.alpha = Jet(a, 0);
      v.q_n = Jet(0.01);
      AeroVariables<double> low, high;
      const double h = 1e-5;
      low.alpha = a - h;
      high.alpha = a + h;
      low.q_n = high.q_n = 0.01;
      const auto jet = m.evaluate(v);
      // Central differences: error h^2/6 of a third derivative of order M^3 times CL.
      EXPECT_NEAR(jet.CL.v[0], (m.evaluate(high).CL - m.evaluate(low).CL) / (2 * h), 1e-4);
      EXPECT_NEAR(jet.CD.v[0], (m.evaluate(high).CD - m.evaluate(low).CD) / (2 * h), 1e-4);
    }
  }
}

TEST(AeroModel, GivesTheRegressionRowWhoseProductWithTheParametersIsTheCoefficient) {
  const AeroModel m = model_with(StallForm::kFull);
  const CoefficientModel& CL = m.at(Coefficient::kCL);
  const auto v = some_variables();
  const Eigen::VectorXd row = CL.regressors(v);
  EXPECT_NEAR(row.dot(Eigen::Map<const Eigen::VectorXd>(CL.values.data(), 4)), CL.linear(v), 1e-15);
  const std::vector<double> other = {1, 2, 3, 4};
  EXPECT_NEAR(CL.linear(v, std::span<const double>(other)), 1 + 2 * v.alpha + 3 * v.q_n + 4 * v.de, 1e-15);
  EXPECT_THAT(CL.parameter_names(), ElementsAre("CL_0", "CL_alpha", "CL_q", "CL_de"));
}

AeroModel read(std::string_view text, AeroModel base = {}) {
  const Study study = Study::parse(text, "s.toml");
  const StudyTable table = study.root().table("model");
  AeroModel m = std::move(base);
  aero_model_keys().read(table, m);
  study.root().finish();
  return m;
}

TEST(AeroModel, ReadsValuesAndStructureFromAStudyAndWritesThemBack) {
  const AeroModel m = read(
      "[model]\nCL = { \"1\" = 0.2933, alpha = 3.607, \"alpha*q_n\" = 1.5, \"spline(alpha, 12 deg, 2)\" = \"unknown\" "
      "}\n"
      "Cm = [\"1\", \"alpha\", \"q_n\", \"de\"]\n[model.stall]\nM = 20\nalpha0 = \"27 deg\"\nform = \"source\"\n");
  EXPECT_DOUBLE_EQ(*m.at(Coefficient::kCL).value_of("alpha"), 3.607);
  EXPECT_FALSE(m.at(Coefficient::kCL).known());
  EXPECT_THAT(m.unknown_parameters(), ElementsAre("CL_spline_alpha_12deg_2", "Cm_0", "Cm_alpha", "Cm_q", "Cm_de"));
  EXPECT_EQ(m.find(Coefficient::kCD), nullptr);
  EXPECT_DOUBLE_EQ(m.stall->alpha0, 27 * M_PI / 180);
  EXPECT_TRUE(read(write_aero_model_toml(m, "model")) == m);
  EXPECT_FALSE(read("[model]\n[model.stall]\nform = \"none\"\n", m).stall.has_value());
}

TEST(AeroModel, RefusesWrongModelsWithPlaceAndRule) {
  EXPECT_EQ(why([] { read("[model]\nCL = [\"1\", \"alhpa\"]\n"); }),
            "s.toml:2: model.CL: term 'alhpa': unknown variable 'alhpa' (did you mean 'alpha'?)");
  EXPECT_THAT(why([] { read("[model]\nCL = { alpha = 1, \"1*alpha\" = 2 }\n"); }), HasSubstr("is there twice"));
  EXPECT_THAT(why([] { read("[model]\nCX = [\"1\"]\n"); }), HasSubstr("model.CX: unknown key"));
  EXPECT_THAT(why([] { read("[model]\nCL = 3\n"); }), HasSubstr("neither a list of terms"));
  EXPECT_THAT(why([] { read("[model]\nCL = []\n"); }), HasSubstr("has no terms"));
  EXPECT_THAT(why([] { read("[model]\nCL = { alpha = \"wide\" }\n"); }), HasSubstr("model.CL.alpha"));
  EXPECT_THAT(why([] { read("[model]\n[model.stall]\nM = -1\n"); }), HasSubstr("must be > 0"));
  EXPECT_THAT(why([] { read("[model]\n[model.stall]\nshape = 1\n"); }), HasSubstr("shape"));
}

}  // namespace
}  // namespace veridyn::aircraft
