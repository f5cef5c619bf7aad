#include "bench/reproduction/aircraft/batch_experiment.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/elevator_flight.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Method;

BatchExperiment run(const std::string& experiment, Progress& progress) {
  const Study study = Study::parse(fmt::format("{}{}", test::elevator_flight(3), experiment), "test.toml");
  return run_batch_experiment(ExperimentOptions::read(study.root()), {Method::kOls, Method::kGtls}, progress);
}

// With exact regressors both methods are the same unbiased estimator: means within 4 sigma / sqrt(40) of the truth, and
// 95 % intervals that cover as they should (of 40 seeds at least 33, three standard errors).
TEST(BatchExperiment, CountsWhatMethodsDoOnAverage) {
  Progress silent;
  const BatchExperiment e = run("[experiment]\ncoefficient = \"Cm\"\nseeds = 40\nrate = 20\nsnr = 20\n", silent);
  ASSERT_EQ(e.methods.size(), 2U);
  for (const BatchStatistics& s : e.methods) {
    EXPECT_EQ(s.estimates, 40);
    for (Eigen::Index i = 0; i < e.rows.truth.size(); ++i) {
      EXPECT_LT(s.bias(i, e.rows.truth), 4.0 / std::sqrt(40.0)) << i;
      EXPECT_GE(s.coverage(i), 33.0 / 40.0) << i;
      // What was stated is what they scatter by; a standard deviation of 40 is known to 11 %.
      EXPECT_NEAR(s.mean_sigma(i) / s.sd(i), 1.0, 0.4) << i;
    }
    EXPECT_EQ(s.output_error.size(), 40);
    EXPECT_GT(s.output_error.minCoeff(), 0.0);
    EXPECT_EQ(s.example.size(), static_cast<std::size_t>(e.rows.regressors.rows()));
  }
}

// Noise of the regressors is what least squares is biased by, and total least squares is not.
TEST(BatchExperiment, ShowsTheBiasOfLeastSquares) {
  Progress silent;
  const BatchExperiment e =
      run("[experiment]\ncoefficient = \"Cm\"\nseeds = 10\nrate = 50\nsnr = 30\nregressor_snr = 10\n", silent);
  const auto worst = [&e](std::size_t method) {
    double largest = 0.0;
    for (Eigen::Index i = 1; i < e.rows.truth.size(); ++i)
      largest = std::max(largest, std::abs(e.methods[method].mean(i) / e.rows.truth(i) - 1.0));
    return largest;
  };
  EXPECT_GT(worst(0), 0.1);
  EXPECT_LT(worst(1), 0.3 * worst(0));
}

class OnThreads : public Progress {
 public:
  explicit OnThreads(int count) : count_(count) {}
  [[nodiscard]] int threads() const override { return count_; }

 private:
  int count_;
};

TEST(BatchExperiment, IsTheSameOnAnyNumberOfThreads) {
  OnThreads one(1), three(3);
  const std::string text = "[experiment]\ncoefficient = \"CL\"\nseeds = 7\nrate = 20\nsnr = 20\n";
  const BatchExperiment a = run(text, one), b = run(text, three);
  EXPECT_EQ(a.methods[1].mean, b.methods[1].mean);
  EXPECT_EQ(a.methods[0].sd, b.methods[0].sd);
}

}  // namespace
}  // namespace veridyn::aircraft
