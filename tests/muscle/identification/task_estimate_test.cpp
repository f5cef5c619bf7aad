#include "veridyn/muscle/identification/task_estimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/identification/two_tasks.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::muscle {
namespace {

using estimation::ParameterStatus;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

using test::kTaskNoise;
const Eigen::Vector4d kHidden(1.2, 0.9, 1.3, 1.0);

TaskEstimate estimated(const test::TwoTasks& model, const std::vector<estimation::RowMatrix>& measured,
                       const Eigen::VectorXd& noise, const TaskEstimateOptions& options = {}) {
  Progress progress;
  return estimate_from_tasks(model, measured, noise, options, progress);
}

TEST(TaskEstimate, IsTheNormalPosteriorOfALinearModel) {
  const test::TwoTasks model;
  const auto measured = model.recorded(kHidden, kTaskNoise);
  const TaskEstimate e = estimated(model, measured, Eigen::VectorXd::Constant(1, kTaskNoise));
  ASSERT_TRUE(e.usable()) << e.best.message;
  const test::NormalPosterior expected = test::posterior_of(model, measured, kTaskNoise);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double sigma = std::sqrt(expected.covariance(i, i));
    EXPECT_NEAR(e.best.theta(i), expected.mean(i), 1e-3 * sigma) << i;
    EXPECT_NEAR(e.best.parameters[i].sigma, sigma, 1e-3 * sigma) << i;
    const double prior = model.parameters()[i].prior_sigma;
    EXPECT_NEAR(e.learned(i), 1.0 - std::pow(sigma / prior, 2), 1e-3) << i;
  }
  EXPECT_NEAR(e.chi_square, 1.0, 0.3);
  EXPECT_EQ(e.noise_correlation.size(), 0) << "the noise is white";
}

// Where only the sum of two is known, each learns its share of the priors' variance: a/(a + b) and b/(a + b).
TEST(TaskEstimate, SaysWhatTheTasksSayOfEachParameter) {
  test::TwoTasks model;
  const auto measured = model.recorded(kHidden, kTaskNoise);
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(1, kTaskNoise);
  const TaskEstimate alike = estimated(model, measured, noise);
  const auto status = [](const TaskEstimate& e, std::size_t i) { return e.best.parameters[i].status; };
  EXPECT_EQ(status(alike, 0), ParameterStatus::kIdentified);
  EXPECT_EQ(status(alike, 1), ParameterStatus::kWeak);
  EXPECT_EQ(status(alike, 2), ParameterStatus::kWeak);
  EXPECT_EQ(status(alike, 3), ParameterStatus::kNotExcited);
  EXPECT_NEAR(alike.learned(1), 0.5, 0.01);
  ASSERT_THAT(alike.null_directions, SizeIs(2));
  EXPECT_THAT(alike.null_directions, ::testing::Contains(::testing::AnyOf("left against right", "right against left")));
  EXPECT_THAT(alike.null_directions, ::testing::Contains("idle"));
  EXPECT_FALSE(alike.ambiguous);
  model.parameters_[1].prior_sigma = 0.6;
  model.parameters_[2].prior_sigma = 0.2;
  const TaskEstimate unlike = estimated(model, measured, noise);
  EXPECT_NEAR(unlike.learned(1), 0.9, 0.01);
  EXPECT_NEAR(unlike.learned(2), 0.1, 0.01);
  EXPECT_EQ(status(unlike, 1), ParameterStatus::kIdentified);
  EXPECT_EQ(status(unlike, 2), ParameterStatus::kNotExcited) << "the tasks move with it, and as much with left";
}

TEST(TaskEstimate, LeavesWhatIsFixedAndStopsAtABound) {
  test::TwoTasks model;
  model.parameters_[2].fixed = true;
  model.parameters_[0].high = 1.1;
  const TaskEstimate e =
      estimated(model, model.recorded(kHidden, kTaskNoise), Eigen::VectorXd::Constant(1, kTaskNoise));
  ASSERT_TRUE(e.usable());
  EXPECT_EQ(e.best.parameters[0].status, ParameterStatus::kAtBound);
  EXPECT_EQ(e.best.theta(0), 1.1);
  EXPECT_EQ(e.best.parameters[2].status, ParameterStatus::kFixed);
  EXPECT_EQ(e.best.theta(2), 1.0);
}

TEST(TaskEstimate, FindsTheNoiseThatIsNotStated) {
  const test::TwoTasks model;
  const TaskEstimate e = estimated(model, model.recorded(kHidden, kTaskNoise), {});
  ASSERT_TRUE(e.usable());
  EXPECT_TRUE(std::isnan(e.chi_square)) << "against which there is nothing to compare";
  // A hundred values: their standard deviation is known to 7 %.
  ASSERT_THAT(e.best.outputs, SizeIs(1));
  EXPECT_NEAR(e.best.outputs[0].noise_sd, kTaskNoise, 0.2 * kTaskNoise);
}

TEST(TaskEstimate, SearchesOftenAndOnceFromWhereItIsTold) {
  const test::TwoTasks model;
  const auto measured = model.recorded(kHidden, kTaskNoise);
  const TaskEstimate three = estimated(model, measured, Eigen::VectorXd::Constant(1, kTaskNoise));
  ASSERT_THAT(three.searches, SizeIs(3));
  int finished = 0;
  for (const TaskSearch& s : three.searches) {
    finished += std::isfinite(s.cost) ? 1 : 0;
    EXPECT_TRUE(!std::isfinite(s.cost) || s.agrees) << "a linear model has one minimum";
  }
  EXPECT_EQ(finished, 2) << "the best two of the coarse fits";
  const TaskEstimate once = estimated(model, measured, Eigen::VectorXd::Constant(1, kTaskNoise),
                                      {.starts = 1, .first = Eigen::Vector4d(0.5, 0.5, 0.5, 0.5)});
  ASSERT_THAT(once.searches, SizeIs(1));
  EXPECT_GT(once.searches[0].rms_start, 10.0) << "far from the recording";
  EXPECT_NEAR(once.best.theta(0), three.best.theta(0), 0.05 * three.best.parameters[0].sigma);
}

TEST(TaskEstimate, DescribesTheEndOfAnotherSearchWithoutMovingIt) {
  const test::TwoTasks model;
  const auto measured = model.recorded(kHidden, kTaskNoise);
  Progress progress;
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(1, kTaskNoise), there = kHidden;
  TaskSearch search;
  search.message = "found by a swarm";
  const TaskEstimate e = describe_estimate(model, measured, noise, there, search, progress);
  ASSERT_TRUE(e.usable()) << e.best.message;
  EXPECT_EQ(e.best.theta, there);
  ASSERT_THAT(e.searches, SizeIs(1));
  EXPECT_EQ(e.searches[0].message, "found by a swarm");
  const test::NormalPosterior expected = test::posterior_of(model, measured, kTaskNoise);
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_NEAR(e.best.parameters[i].sigma, std::sqrt(expected.covariance(i, i)), 1e-6) << "as wide as anywhere";
  EXPECT_EQ(e.best.parameters[0].status, ParameterStatus::kIdentified);
}

TEST(TaskEstimate, OptionsAreRefusedWithTheirRule) {
  EXPECT_THAT(why([] { TaskEstimateOptions{.starts = 0}.validate(); }), HasSubstr("identify.starts"));
  EXPECT_THAT(why([] { TaskEstimateOptions{.starts = 20, .screened = 16}.validate(); }),
              HasSubstr("identify.screened: is 16; must be from starts = 20"));
  EXPECT_NO_THROW(TaskEstimateOptions{}.validate());
}

TEST(BoundPriors, AreOfUnknownsThatHaveNone) {
  std::vector<MuscleUnknown> unknowns(2);
  unknowns[0].low = 1.0;
  unknowns[0].high = 4.0;
  unknowns[0].prior_sigma = kInfinity;
  unknowns[1].high = 1.0;
  unknowns[1].prior_sigma = 0.1;
  const std::vector<MuscleUnknown> with = with_bound_priors(unknowns);
  // A value that is uniform between the bounds has the variance (high - low)^2/12.
  EXPECT_NEAR(std::pow(with[0].prior_sigma, 2), 9.0 / 12.0, 1e-12);
  EXPECT_EQ(with[1].prior_sigma, 0.1);
}

}  // namespace
}  // namespace veridyn::muscle
