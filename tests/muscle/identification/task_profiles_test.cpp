#include "veridyn/muscle/identification/task_profiles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/study/identify_muscles.hpp"

namespace veridyn::muscle {
namespace {

const std::string kStudy =
    "seed = 1\n[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n[tasks]\nnumbers = [8, 33]\n[person]\nspread = \"5 %\"\n"
    "[[parameter]]\nname = \"flexors\"\nmuscles = [\"biceps_long\", \"biceps_short\", \"brachialis\"]\n"
    "fields = [\"max_isometric_force\"]\nfactor = true\nbounds = \"20 %\"\n"
    "[[parameter]]\nmuscles = [\"triceps_long\"]\nfields = [\"tendon_slack_length\"]\nbounds = \"20 %\"\n"
    "[identify]\nstarts = 1\nadvice = false\nprofiles = ";

TaskStudy profile_study(const std::string& profiles) {
  Progress progress;
  return read_task_study(Study::parse(kStudy + profiles + "\n", "s.toml"), progress);
}

// Two well-determined unknowns: the likelihood is nearly a parabola, and the profile nearly the error bar.
TEST(TaskProfiles, OfWhatIsWellDeterminedAreNearTheErrorBars) {
  Progress progress;
  const MuscleAnalysis a = identify(profile_study("true"), progress);
  ASSERT_TRUE(a.profiles.usable()) << a.profiles.message;
  ASSERT_EQ(a.profiles.profiles.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const estimation::ParameterProfile& p = a.profiles.profiles[i];
    const estimation::Parameter& bar = a.estimate.parameters[i];
    ASSERT_EQ(p.low_end, estimation::ProfileEnd::kClosed);
    ASSERT_EQ(p.high_end, estimation::ProfileEnd::kClosed);
    EXPECT_NEAR(p.value, bar.value, 0.1 * bar.sigma);
    EXPECT_NEAR((p.high - p.low) / (bar.high95 - bar.low95), 1.0, 0.05) << p.name;
    // Seed 1's person lies within both.
    EXPECT_GT(a.true_value(p.name), p.low - bar.sigma);
    EXPECT_LT(a.true_value(p.name), p.high + bar.sigma);
  }
}

TEST(TaskProfiles, AreOfFreeUnknownsOnly) {
  EXPECT_TRUE(profile_study("false").profiles.empty());
  EXPECT_EQ(profile_study("[\"flexors\"]").profiles, std::vector<std::string>{"flexors"});
  for (const char* wrong : {"[\"flexor\"]", "[\"flexors\", \"flexors\"]"})
    EXPECT_THROW(static_cast<void>(profile_study(wrong)), InputError) << wrong;
}

}  // namespace
}  // namespace veridyn::muscle
