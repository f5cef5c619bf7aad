#include "veridyn/aircraft/model/builtin_subjects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(BuiltinSubjects, AreKnownByName) {
  EXPECT_THAT(builtin_subject_names(), ElementsAre("unatrap", "skywalker_2013", "skywalker_2013_mod", "aerosonde",
                                                   "tut_airplane", "hcuav", "x8", "thor"));
  for (const std::string& name : builtin_subject_names()) EXPECT_EQ(builtin_subject(name).name, name);
}

TEST(BuiltinSubjects, AreRefusedWithTheNearestName) {
  EXPECT_EQ(why([] { static_cast<void>(builtin_subject("aerosnde")); }),
            "subject.builtin: unknown aircraft 'aerosnde' (did you mean 'aerosonde'?)");
  EXPECT_THAT(why([] { static_cast<void>(builtin_subject("x9", "study.toml:3")); }), HasSubstr("study.toml:3"));
}

// Beard & McLain (2012), table E.2: mass 13.5 kg, area 0.55 m^2, span 2.8956 m (2.90), chord 0.18994 m (0.19),
// CL_alpha 3.45, CL_de -0.36.
TEST(BuiltinSubjects, HaveThePublishedNumbersOfTheAerosonde) {
  const Subject s = builtin_subject("aerosonde");
  EXPECT_EQ(s.mass, 13.5);
  EXPECT_EQ(s.wing_area, 0.55);
  EXPECT_NEAR(s.span, 2.8956, 0.005);
  EXPECT_NEAR(s.chord, 0.18994, 0.0005);
  EXPECT_EQ(s.model.find(Coefficient::kCL)->value_of("alpha"), 3.45);
  EXPECT_EQ(s.model.find(Coefficient::kCL)->value_of("de"), -0.36);
}

// The signs of an aircraft that flies: more lift with alpha, stable in pitch and yaw, damped in every rate.
TEST(BuiltinSubjects, AreStableAndDamped) {
  for (const std::string& name : builtin_subject_names()) {
    const AeroModel model = builtin_subject(name).model;
    const auto value = [&](Coefficient c, const char* term) { return model.find(c)->value_of(term).value(); };
    // Lift may be a polyline: its slope about 3 deg.
    const auto by_alpha = [&](Coefficient c) {
      AeroVariables<double> low, high;
      low.alpha = 2.0 * kDegree;
      high.alpha = 4.0 * kDegree;
      return model.find(c)->linear(high) - model.find(c)->linear(low);
    };
    EXPECT_GT(by_alpha(Coefficient::kCL), 0.0) << name;
    EXPECT_LT(by_alpha(Coefficient::kCm), 0.0) << name;
    EXPECT_LT(value(Coefficient::kCm, "q_n"), 0.0) << name;
    EXPECT_LT(value(Coefficient::kCl, "p_n"), 0.0) << name;
    EXPECT_GT(value(Coefficient::kCn, "beta"), 0.0) << name;
    EXPECT_LT(value(Coefficient::kCn, "r_n"), 0.0) << name;
  }
}

// Worked out from the tables: X8 0.104, 0.170, 2.005 kg m^2; Thor 0.0692, 0.0864, 0.1560 kg m^2, a quarter of a percent
// beyond the rule.
TEST(Subject, SaysThatThePublishedInertiaOfX8AndThorIsImpossible) {
  for (const std::string& name : builtin_subject_names()) {
    EXPECT_EQ(builtin_subject(name).warnings.size(), name == "x8" || name == "thor" ? 1u : 0u) << name;
  }
  EXPECT_THAT(builtin_subject("x8").warnings[0],
              HasSubstr("0.1045, 0.1702, 2.005 kg m^2: the largest exceeds the sum of the others"));
}

}  // namespace
}  // namespace veridyn::aircraft
