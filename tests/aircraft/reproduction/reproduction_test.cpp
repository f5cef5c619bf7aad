#include "veridyn/aircraft/reproduction/reproduction.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/aircraft/reproduction/experiment_flight.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

TEST(Reproduction, FailsWhenAResultDoesNotShow) {
  Progress silent;
  // Ordinary least squares with exact regressors is not biased: the study claims that it is.
  const std::string study =
      fmt::format("title = \"wrong\"\n{}{}", kExperimentFlight,
                  "[experiment]\ncoefficient = \"CL\"\nmethods = [\"OLS\"]\nseeds = 30\nsnr = 30\n"
                  "[expect]\nbiased = \"OLS\"\n");
  const Reproduction result = reproduce(Study::parse(study, "test.toml").root(), silent);
  ASSERT_EQ(result.checks.size(), 1u);
  EXPECT_FALSE(result.passed());
}

TEST(Reproduction, RefusesAMisspeltExpectation) {
  Progress silent;
  const std::string study = fmt::format("title = \"wrong\"\n{}{}", kExperimentFlight,
                                        "[experiment]\ncoefficient = \"CL\"\nmethods = [\"OLS\"]\nseeds = 3\n"
                                        "[expect]\nunbiassed = \"OLS\"\n");
  EXPECT_THROW((void)reproduce(Study::parse(study, "test.toml").root(), silent), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
