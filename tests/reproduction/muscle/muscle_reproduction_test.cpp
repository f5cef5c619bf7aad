#include "bench/reproduction/muscle/muscle_reproduction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

/// Two unknowns of the brachialis, found from one task and from two.
std::string comparison(const std::string& end) {
  return "title = \"row\"\n[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n[tasks]\nnumbers = [8, 33]\nhold_out = "
         "[11]\n"
         "accuracy = 1e-5\n[person]\nnoise = 0\n[identify]\nstarts = 1\nscreened = 1\n[compare]\npersons = 2\n"
         "[[parameter]]\nmuscles = [\"brachialis\"]\nfields = [\"max_isometric_force\"]\nbounds = \"20 %\"\n"
         "[[parameter]]\nmuscles = [\"brachialis\"]\nfields = [\"optimal_fiber_length\"]\nbounds = \"20 %\"\n"
         "[[case]]\nname = \"one\"\nnumbers = [8]\n[[case]]\nname = \"two\"\nload = 2\nspread = \"10 %\"\n" +
         end;
}

MuscleReproduction reproduced_case(const std::string& end) {
  Progress silent;
  return reproduce_muscle(Study::parse(comparison(end), "row.toml"), silent);
}

TEST(MuscleReproduction, ComparesPersonsCaseByCaseAndFailsWhatIsNotMet) {
  const MuscleReproduction r = reproduced_case(
      "[[expect]]\nquantity = \"parameter error\"\ncase = \"two\"\nstatistic = \"largest\"\nbelow = 1e-3\n"
      "[[expect]]\nquantity = \"unseen NRMSE\"\ncase = \"two\"\nthan = \"one\"\nlessened_by = \"99.9999999 %\"\n"
      "published = \"-99 %\"\n");
  ASSERT_EQ(r.cases.size(), 2u);
  EXPECT_EQ(r.cases[0].setting.tasks, std::vector<int>{8});
  EXPECT_EQ(r.cases[1].setting.tasks, (std::vector<int>{8, 33}));
  EXPECT_EQ(r.cases[1].setting.load, 2.0);
  for (const ComparedOutcome& c : r.cases) {
    ASSERT_EQ(c.persons.size(), 2u);
    EXPECT_NE(c.persons[0].parameter_error, c.persons[1].parameter_error);
    for (const ComparedPerson& p : c.persons) {
      EXPECT_EQ(p.trouble, "");
      EXPECT_EQ(p.identified, 2);
      EXPECT_LT(p.unseen, 1e-3);
      EXPECT_GT(p.simulations.with_derivatives, 0u);
    }
    EXPECT_LE(c.median(ComparedQuantity::kUnseen), c.largest(ComparedQuantity::kUnseen));
  }
  ASSERT_EQ(r.checks.size(), 2u);
  EXPECT_TRUE(r.checks[0].passed) << r.checks[0].text;
  EXPECT_FALSE(r.checks[1].passed) << r.checks[1].text;
  EXPECT_THAT(r.checks[1].text, testing::HasSubstr("published -99 %"));
  EXPECT_FALSE(r.passed());
}

TEST(MuscleReproduction, RefusesWhatItCannotCompareWithFileLineAndKey) {
  const auto refusal = [](const std::string& end) -> std::string {
    try {
      (void)reproduced_case(end);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("[[expect]]\ncase = \"twoo\"\nbelow = 1\n"),
              testing::AllOf(testing::HasSubstr("row.toml:"),
                             testing::HasSubstr("'twoo' is no [[case]] (did you mean 'two'?)")));
  EXPECT_THAT(refusal("[[expect]]\ncase = \"two\"\n"), testing::HasSubstr("says nothing"));
  EXPECT_THAT(refusal("[[expect]]\ncase = \"two\"\nbelow = 1\nbelwo = 2\n"), testing::HasSubstr("belwo"));
  EXPECT_THAT(refusal("[[case]]\nname = \"x\"\nnumbers = [43]\n"),
              testing::HasSubstr("43 is none of the tasks 1 to 42"));
}

}  // namespace
}  // namespace veridyn::muscle
