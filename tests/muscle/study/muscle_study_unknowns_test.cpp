#include "veridyn/muscle/study/muscle_study_unknowns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<MuscleUnknown> study_unknowns(const std::string& text) {
  const Study study = Study::parse(text, "s.toml");
  return read_unknowns(study.root(), load_model("arm").model());
}

std::string study_unknowns_error(const std::string& text) {
  try {
    static_cast<void>(study_unknowns(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

const std::string kLength = "[[parameter]]\nmuscles = [\"biceps_long\"]\nfields = [\"optimal_fiber_length\"]\n";

TEST(MuscleStudyUnknowns, BoundsAndPriorsInPercentOrUnits) {
  const std::vector<MuscleUnknown> u = study_unknowns(
      "[[parameter]]\nname = \"forces\"\nmuscles = [\"all\"]\nfields = [\"max_isometric_force\"]\nfactor = true\n"
      "bounds = \"20 %\"\nprior = \"10 %\"\n" +
      kLength + "low = \"-10 %\"\nhigh = \"16 cm\"\nprior = \"5 mm\"\nstart = \"14 cm\"\n");
  ASSERT_EQ(u.size(), 2u);
  EXPECT_NEAR(u[0].low, 0.8, 1e-12);
  EXPECT_NEAR(u[0].high, 1.2, 1e-12);
  EXPECT_NEAR(u[0].prior_sigma, 0.1, 1e-12);
  EXPECT_NEAR(u[1].low, 0.126, 1e-12);
  EXPECT_NEAR(u[1].high, 0.16, 1e-12);
  EXPECT_NEAR(u[1].prior_sigma, 0.005, 1e-12);
}

TEST(MuscleStudyUnknowns, MistakesAreNamedWithFileLineAndKey) {
  EXPECT_THAT(study_unknowns_error(kLength + "low = 0.3\nhigh = 0.1\n"),
              AllOf(HasSubstr("s.toml:"), HasSubstr("cross")));
  EXPECT_THAT(study_unknowns_error(kLength + "high = \"-5 %\"\n"),
              AllOf(HasSubstr("s.toml:4"), HasSubstr("leave out")));
  EXPECT_THAT(study_unknowns_error(kLength + "bounds = 0.1\n"), HasSubstr("such as \"20 %\""));
  EXPECT_THAT(study_unknowns_error(kLength + "bounds = \"5 %\"\nlow = 0.1\n"), HasSubstr("both given"));
  EXPECT_THAT(study_unknowns_error(kLength + "prior = \"5 kg\"\n"), HasSubstr("prior"));
  EXPECT_THAT(study_unknowns_error(kLength + kLength), HasSubstr("both set"));
  EXPECT_THAT(study_unknowns_error("[[parameter]]\nmuscles = [\"biceps\"]\nfields = [\"optimal_fiber_length\"]\n"),
              HasSubstr("biceps_"));
}

TEST(MuscleStudyUnknowns, OutputsHaveTheirOwnNoise) {
  const Model model = load_model("arm").model();
  const Study study = Study::parse(
      "[[output]]\nname = \"elbow_flexion\"\nnoise = \"0.1 deg\"\n[[output]]\nname = \"brachialis.tendon_force\"\n",
      "s.toml");
  const std::vector<MuscleOutput> outputs = read_outputs(study.root(), model);
  ASSERT_EQ(outputs.size(), 2u);
  EXPECT_NEAR(outputs[0].noise_sd, 0.1 * kDegree, 1e-12);
  EXPECT_EQ(outputs[1].kind, MuscleOutputKind::kTendonForce);
  EXPECT_EQ(outputs[1].noise_sd, 0.0);
  const Study twice =
      Study::parse("[[output]]\nname = \"elbow_flexion\"\n[[output]]\nname = \"elbow_flexion\"\n", "s.toml");
  EXPECT_THROW((void)read_outputs(twice.root(), model), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
