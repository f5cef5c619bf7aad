#include "bench/reproduction/aircraft/reproduction.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/elevator_flight.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

TEST(Reproduction, FailsWhenAResultDoesNotShow) {
  Progress silent;
  // Ordinary least squares with exact regressors is not biased: the study claims that it is.
  const std::string study =
      fmt::format("title = \"wrong\"\n{}{}", test::elevator_flight(3),
                  "[experiment]\ncoefficient = \"CL\"\nmethods = [\"OLS\"]\nseeds = 30\nsnr = 30\n"
                  "[expect]\nbiased = \"OLS\"\n");
  const Reproduction result = reproduce(Study::parse(study, "test.toml").root(), silent);
  ASSERT_EQ(result.checks.size(), 1u);
  EXPECT_FALSE(result.passed());
}

TEST(Reproduction, AnEstimateThatSettlesBeforeItIsExcitedFails) {
  // CD_q and CD_de hardly move CD: its errors are small long before these directions stand out of the noise.
  Progress silent;
  std::string study =
      "title = \"order\"\nseed = 1\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 400\n"
      "airspeed = 20\n";
  for (const int start : {40, 120})
    study += fmt::format(
        "[[flight.manoeuvre]]\nkind = \"doublet\"\nstart = {}\nsurfaces = [\"elevator\"]\n"
        "amplitude = \"0.5 deg\"\n",
        start);
  for (const int start : {180, 280})
    study += fmt::format(
        "[[flight.manoeuvre]]\nkind = \"multisine\"\nstart = {}\nduration = 100\n"
        "surfaces = [\"elevator\"]\n",
        start);
  study +=
      "[experiment]\ncoefficient = \"CD\"\nseeds = 1\nrate = 100\nsnr = 30\nregressor_snr = 23\n"
      "[[experiment.tracker]]\nname = \"PCA\"\nlambda = 1.0\nforgetting = \"constant\"\n"
      "[expect]\nsettles_when_excited = \"PCA\"\nknown_when_excited = \"PCA\"\n";
  const Reproduction result = reproduce(Study::parse(study, "test.toml").root(), silent);
  ASSERT_EQ(result.checks.size(), 2u);
  const TrackingRun& run = result.tracking->runs[0][0];
  ASSERT_LT(run.settling_s[0], run.excited_s - 10.0) << "the case is no case";
  EXPECT_FALSE(result.checks[0].passed);
  EXPECT_NE(result.checks[0].text.find("before what is claimed to be its cause"), std::string::npos)
      << result.checks[0].text;
  // By its own intervals it is known after that only.
  EXPECT_TRUE(result.checks[1].passed) << result.checks[1].text;
}

TEST(Reproduction, NoFalseAlarmStatesTheExposureThatItsRateNeeds) {
  Progress silent;
  const std::string study = fmt::format(
      "title = \"alarms\"\n{}[experiment]\ncoefficient = \"Cm\"\nseeds = 9\nrate = 50\nsnr = 30\n"
      "regressor_snr = 25\n[[experiment.tracker]]\nname = \"T\"\ndetection_learning = \"20 s\"\n"
      "[expect]\nno_false_alarm = [\"T\"]\nfalse_alarm_rate = [\"T\"]\n",
      test::elevator_flight(3));
  const Reproduction result = reproduce(Study::parse(study, "test.toml").root(), silent);
  // Nine times 40 s, 0.1 hours: no more than 30 an hour (3/T) with 95 %, where one in ten hours is stated.
  EXPECT_NEAR(result.tracking->unchanged_hours(0, 30.0), 0.1, 1e-3);
  ASSERT_EQ(result.checks.size(), 2u);
  EXPECT_TRUE(result.checks[0].passed);
  EXPECT_NE(result.checks[0].text.find("at most 30 an hour (95 %)"), std::string::npos) << result.checks[0].text;
  EXPECT_NE(result.checks[0].text.find("takes 30 hours"), std::string::npos) << result.checks[0].text;
  EXPECT_FALSE(result.checks[1].passed) << "0.1 hours cannot show one alarm in ten hours";
}

TEST(Reproduction, RefusesAMisspeltExpectation) {
  Progress silent;
  const std::string study = fmt::format("title = \"wrong\"\n{}{}", test::elevator_flight(3),
                                        "[experiment]\ncoefficient = \"CL\"\nmethods = [\"OLS\"]\nseeds = 3\n"
                                        "[expect]\nunbiassed = \"OLS\"\n");
  EXPECT_THROW((void)reproduce(Study::parse(study, "test.toml").root(), silent), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
