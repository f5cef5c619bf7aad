#include "veridyn/muscle/identification/task_posterior.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/identification/two_tasks.hpp"

namespace veridyn::muscle {
namespace {

using test::kTaskNoise;

struct SampledTasks {
  test::TwoTasks model;
  std::vector<estimation::RowMatrix> measured;
  TaskEstimate estimate;
};

SampledTasks sampled_tasks() {
  SampledTasks s;
  // Away from its bounds the posterior is normal.
  for (estimation::ModelParameter& p : s.model.parameters_) p.low = -5.0, p.high = 5.0;
  s.measured = s.model.recorded(Eigen::Vector4d(1.2, 0.9, 1.3, 1.0), kTaskNoise);
  Progress progress;
  s.estimate = estimate_from_tasks(s.model, s.measured, Eigen::VectorXd::Constant(1, kTaskNoise), {}, progress);
  return s;
}

estimation::PosteriorSample drawn(const SampledTasks& s) {
  Progress progress;
  return sample_tasks(s.model, s.measured, s.estimate, {.steps = 3000, .effective = 1000, .seed = 1}, progress);
}

// A thousand independent draws: means within 3 % of a standard deviation, these within 2 %; allowed are four times as
// much.
TEST(SampleTasks, AreOfTheNormalPosteriorOfALinearModel) {
  SampledTasks s = sampled_tasks();
  s.estimate.chi_square = 0.8;  // less than the noise: not narrowed
  const estimation::PosteriorSample sample = drawn(s);
  ASSERT_TRUE(sample.usable());
  ASSERT_EQ(sample.parameters.size(), 4U);
  const test::NormalPosterior expected = test::posterior_of(s.model, s.measured, kTaskNoise);
  for (std::size_t i = 0; i < 4; ++i) {
    const double sd = std::sqrt(expected.covariance(i, i));
    EXPECT_NEAR(sample.parameters[i].mean, expected.mean(i), 0.13 * sd) << i;
    EXPECT_NEAR(sample.parameters[i].sd, sd, 0.1 * sd) << i;
  }
}

TEST(SampleTasks, AreWiderWhereTheResidualIsLargerThanTheStatedNoise) {
  SampledTasks s = sampled_tasks();
  s.estimate.chi_square = 4.0;
  const estimation::PosteriorSample sample = drawn(s);
  ASSERT_TRUE(sample.usable());
  // Of a noise twice as large.
  const test::NormalPosterior expected = test::posterior_of(s.model, s.measured, 2.0 * kTaskNoise);
  const double sd = std::sqrt(expected.covariance(0, 0));
  EXPECT_NEAR(sample.parameters[0].sd, sd, 0.1 * sd);
  EXPECT_GT(sd, 1.3 * std::sqrt(test::posterior_of(s.model, s.measured, kTaskNoise).covariance(0, 0)));
}

TEST(SampleTasks, AreWiderWhereTheNoiseIsCorrelated) {
  SampledTasks s = sampled_tasks();
  s.estimate.chi_square = 1.0;
  const double white = drawn(s).parameters[0].sd;
  // Noise of first order with this correlation from sample to sample has (1 + r)/(1 - r) times the power at low
  // frequency, where these slow responses are; the prior's share and the second task's shorter time take off some.
  s.estimate.noise_correlation = Eigen::VectorXd::Constant(1, 0.8);
  const double correlated = drawn(s).parameters[0].sd;
  EXPECT_GT(correlated, 1.5 * white);
  EXPECT_LT(correlated, 3.2 * white);
}

}  // namespace
}  // namespace veridyn::muscle
