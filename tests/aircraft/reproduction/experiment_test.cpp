#include "veridyn/aircraft/reproduction/experiment.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/reproduction/batch_experiment.hpp"
#include "veridyn/aircraft/reproduction/reproduction.hpp"
#include "veridyn/aircraft/reproduction/tracking_experiment.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

constexpr const char* kFlight = R"toml(seed = 3
[subject]
builtin = "unatrap"
[flight]
duration = 60
airspeed = 20
[[flight.manoeuvre]]
kind = "multisine"
start = 0
duration = 60
surfaces = ["elevator"]
)toml";

ExperimentOptions options_of(const std::string& more) {
  return ExperimentOptions::read(Study::parse(fmt::format("{}{}", kFlight, more), "test.toml").root());
}

TEST(Experiment, HasExactRowsAndNoiseOfTheStatedSize) {
  Progress silent;
  const ExperimentOptions o =
      options_of("[experiment]\ncoefficient = \"Cm\"\nrate = 100\nsnr = 20\nregressor_snr = 10\nspans = [5, 55]\n");
  const ExactRows rows = exact_rows(o, silent);
  ASSERT_EQ(rows.regressors.rows(), 5000);
  // The rows are those of the linear model: no stall in this flight.
  EXPECT_LT((rows.regressors * rows.truth - rows.regressand).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(rows.noise_sd(0), 0.0) << "the constant has no noise";

  const estimation::RegressionData noisy = noisy_rows(rows, o, 7);
  const auto ratio_dB = [](const Eigen::VectorXd& exact, const Eigen::VectorXd& measured) {
    return 10.0 * std::log10((exact.array() - exact.mean()).square().mean() / (measured - exact).squaredNorm() *
                             static_cast<double>(exact.size()));
  };
  EXPECT_NEAR(ratio_dB(rows.regressand, noisy.regressand), 20.0, 0.4);  // four standard errors of the variance
  for (Eigen::Index j = 1; j < rows.regressors.cols(); ++j)
    EXPECT_NEAR(ratio_dB(rows.regressors.col(j), noisy.regressors.col(j)), 10.0, 0.4);
  EXPECT_EQ(noisy.regressors, noisy_rows(rows, o, 7).regressors);
  EXPECT_NE(noisy.regressors, noisy_rows(rows, o, 8).regressors);
}

TEST(Experiment, ColoursItsNoise) {
  Progress silent;
  const ExperimentOptions o =
      options_of("[experiment]\ncoefficient = \"CL\"\nrate = 100\nsnr = 20\nnoise_time = 0.1\n");
  const ExactRows rows = exact_rows(o, silent);
  const Eigen::VectorXd e = noisy_rows(rows, o, 1).regressand - rows.regressand;
  const auto n = e.size() - 10;
  // exp(-1) after ten samples; the standard error of a correlation over 6000 samples of 20 each is about 0.03.
  EXPECT_NEAR(e.head(n).dot(e.tail(n)) / e.squaredNorm(), std::exp(-1.0), 0.12);
}

TEST(Experiment, NamesTheKeyThatIsWrong) {
  EXPECT_THROW((void)options_of("[experiment]\ncoefficient = \"CX\"\n"), InputError);
  EXPECT_THROW((void)options_of("[experiment]\ncoefficient = \"CL\"\nrate = 1000\n"), InputError);
  EXPECT_THROW((void)options_of("[experiment]\ncoefficient = \"CL\"\nspans = [5]\n"), InputError);
}

TEST(Reproduction, SaysNoWhenAResultDoesNotShow) {
  Progress silent;
  // Ordinary least squares with exact regressors is not biased: the study claims that it is.
  const std::string study =
      fmt::format("title = \"wrong\"\n{}{}", kFlight,
                  "[experiment]\ncoefficient = \"CL\"\nmethods = [\"OLS\"]\nseeds = 30\nsnr = 30\n"
                  "[expect]\nbiased = \"OLS\"\n");
  const Reproduction result = reproduce(Study::parse(study, "test.toml").root(), silent);
  ASSERT_EQ(result.checks.size(), 1u);
  EXPECT_FALSE(result.passed());
}

TEST(Reproduction, RefusesAMisspeltExpectation) {
  Progress silent;
  const std::string study = fmt::format("title = \"wrong\"\n{}{}", kFlight,
                                        "[experiment]\ncoefficient = \"CL\"\nmethods = [\"OLS\"]\nseeds = 3\n"
                                        "[expect]\nunbiassed = \"OLS\"\n");
  EXPECT_THROW((void)reproduce(Study::parse(study, "test.toml").root(), silent), InputError);
}

TEST(TrackingExperiment, SettlesWhereItIsExcitedAndNeverWhereItIsBiased) {
  Progress silent;
  const std::string study =
      fmt::format("{}{}", kFlight,
                  "[experiment]\ncoefficient = \"Cm\"\nseeds = 2\nrate = 50\nsnr = 30\nregressor_snr = 15\n"
                  "[[experiment.tracker]]\nname = \"OLS\"\nmethod = \"OLS\"\nlambda = 1.0\n"
                  "forgetting = \"constant\"\n"
                  "[[experiment.tracker]]\nname = \"GTLS\"\nmethod = \"GTLS\"\nlambda = 1.0\n"
                  "forgetting = \"constant\"\n");
  const Study parsed = Study::parse(study, "test.toml");
  const ExperimentOptions o = ExperimentOptions::read(parsed.root());
  const TrackingExperiment e = run_tracking_experiment(o, read_trackers(parsed.root().table("experiment")), silent);
  // GTLS ends nearer to the truth than OLS, whose errors the noise on the regressors makes systematic.
  const auto error = [&](std::size_t tracker) {
    const TrackHistory& h = e.runs[tracker][0].history;
    double worst = 0.0;
    for (std::size_t i = 1; i < h.value.size(); ++i)
      worst = std::max(worst, std::abs(h.value[i].back() / e.rows.truth(static_cast<Eigen::Index>(i)) - 1.0));
    return worst;
  };
  EXPECT_GT(error(0), 0.1);
  EXPECT_LT(error(1), 0.5 * error(0));
}

}  // namespace
}  // namespace veridyn::aircraft
