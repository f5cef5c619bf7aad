#include "veridyn/muscle/identification/muscle_unknowns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/identification/parameter_name.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Model& unknowns_arm() {
  static const Model model = load_model("arm").model();
  return model;
}

std::string unknown_error(const MuscleUnknownSpec& spec) {
  try {
    static_cast<void>(make_unknown(unknowns_arm(), spec, "study.toml:7: parameter"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MuscleUnknown, OfOneParameterStartsAtTheModelsValue) {
  const MuscleUnknown u =
      unknown_of(unknowns_arm(), test::parameter_named(unknowns_arm(), "brachialis.max_isometric_force"));
  const double value =
      unknowns_arm().muscles[unknowns_arm().muscle("brachialis")].parameters.musculotendon.max_isometric_force;
  EXPECT_EQ(u.name, "brachialis.max_isometric_force");
  EXPECT_EQ(u.unit, "N");
  EXPECT_DOUBLE_EQ(u.start, value);
  EXPECT_DOUBLE_EQ(u.low, 0.5 * value);
  EXPECT_DOUBLE_EQ(u.high, 1.5 * value);
  EXPECT_TRUE(std::isinf(u.prior_sigma));
}

TEST(MuscleUnknown, OneFactorForSeveralMusclesAndFields) {
  const MuscleUnknown u = make_unknown(unknowns_arm(),
                                       {.name = "flexor lengths",
                                        .muscles = {"biceps_long", "brachialis"},
                                        .fields = {"optimal_fiber_length", "tendon_slack_length"},
                                        .factor = true,
                                        .low = Extent{-10.0, true},
                                        .high = Extent{1.2, false},
                                        .prior = Extent{5.0, true}},
                                       "x");
  EXPECT_EQ(u.unit, "1");
  EXPECT_EQ(u.parameters.size(), 4u);
  EXPECT_DOUBLE_EQ(u.start, 1.0);
  EXPECT_DOUBLE_EQ(u.low, 0.9);
  EXPECT_DOUBLE_EQ(u.high, 1.2);
  EXPECT_DOUBLE_EQ(u.prior_sigma, 0.05);
  EXPECT_EQ(make_unknown(unknowns_arm(), {.muscles = {"all"}, .fields = {"tendon_strain_factor"}, .factor = true}, "x")
                .parameters.size(),
            unknowns_arm().muscles.size());
}

TEST(MuscleUnknown, ADelayStartsAtZeroWithinATenthOfASecond) {
  const MuscleUnknown u = make_unknown(unknowns_arm(), {.muscles = {"all"}, .fields = {"excitation_delay"}}, "x");
  EXPECT_EQ(u.unit, "s");
  EXPECT_EQ(u.start, 0.0);
  EXPECT_DOUBLE_EQ(u.low, -0.1);
  EXPECT_DOUBLE_EQ(u.high, 0.1);
}

TEST(MuscleUnknown, WrongOnesAreRefusedInOneLine) {
  const std::vector<std::string> biceps{"biceps_long"}, force{"max_isometric_force"};
  EXPECT_THAT(unknown_error({.muscles = {"biceps_lang"}, .fields = force}),
              AllOf(HasSubstr("study.toml:7"), HasSubstr("did you mean 'biceps_long'")));
  EXPECT_THAT(unknown_error({.muscles = biceps, .fields = {"max_isometric_forse"}}),
              HasSubstr("did you mean 'max_isometric_force'"));
  EXPECT_THAT(
      unknown_error({.muscles = biceps, .fields = force, .low = Extent{10.0, true}, .high = Extent{-10.0, true}}),
      HasSubstr("cross"));
  EXPECT_THAT(unknown_error({.muscles = biceps, .fields = force, .low = Extent{5.0, true}, .high = Extent{10.0, true}}),
              HasSubstr("leave out its start"));
  EXPECT_THAT(unknown_error({.muscles = biceps, .fields = force, .low = Extent{-100.0, true}}),
              HasSubstr("must be > 0"));
  EXPECT_THAT(unknown_error({.muscles = biceps, .fields = force, .prior = Extent{0.0, true}}),
              HasSubstr("must be > 0"));
  EXPECT_THAT(unknown_error({.muscles = {"biceps_long", "brachialis"}, .fields = force}), HasSubstr("factor = true"));
  EXPECT_THAT(unknown_error({.muscles = biceps, .fields = {"optimal_fiber_length", "max_isometric_force"}}),
              HasSubstr("factor = true scales both"));
  EXPECT_THAT(unknown_error({.muscles = {}, .fields = force}), HasSubstr("names no muscle"));
  EXPECT_THAT(unknown_error({.muscles = biceps, .fields = {"excitation_delay"}, .factor = true}),
              HasSubstr("which no factor changes"));
}

TEST(MuscleUnknown, TwoThatSetOneParameterAreRefused) {
  const MuscleUnknown all = make_unknown(
      unknowns_arm(), {.name = "forces", .muscles = {"all"}, .fields = {"max_isometric_force"}, .factor = true}, "x");
  const MuscleUnknown one = unknown_of(unknowns_arm(), {0, 0});
  try {
    check_unknowns(unknowns_arm(), std::vector<MuscleUnknown>{all, one}, "study");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'forces'"), HasSubstr("both set")));
  }
  EXPECT_NO_THROW(check_unknowns(unknowns_arm(), std::vector<MuscleUnknown>{all}, "study"));
}

}  // namespace
}  // namespace veridyn::muscle
