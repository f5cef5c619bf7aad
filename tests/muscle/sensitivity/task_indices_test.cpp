#include "veridyn/muscle/sensitivity/task_indices.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/sensitivity/sampled_arm.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::muscle {
namespace {

using test::four_tasks;
using test::SampledArm;

TEST(TaskIndices, OfMorrisAreTheChangeAcrossTheRange) {
  // One unknown only: each walk is one step of 2/3 of the range, so that mu* is the mean of |change| / (2/3).
  const SampledArm& s = four_tasks();
  std::vector<MuscleUnknown> inputs = {muscle_factors(s.arm.model(), 5, 0.05)[0]};
  const TaskResponses responses(s.arm, inputs, s.tasks, 1e-6);
  TaskIndexOptions options{.method = IndexMethod::kMorris, .morris_trajectories = 1};
  Progress progress;
  const std::vector<std::string> names = {"a", "b", "c", "d"};
  numerics::BlockStore nothing;
  const TaskIndices found = task_indices(responses, std::vector<std::size_t>{2}, names, options, nothing, progress);
  ASSERT_EQ(found.results.size(), 1U);
  EXPECT_EQ(found.simulations, 2U);
  std::vector<double> candidates;
  for (const double low : {0.0, 1.0 / 3.0}) {
    const auto at = [&](double x) { return responses.nrmse(2, Eigen::VectorXd::Constant(1, 0.95 + 0.1 * x)); };
    candidates.push_back(std::abs(at(low + 2.0 / 3.0) - at(low)) * 1.5);
  }
  const double mu = found.results[0].morris[0].absolute;
  EXPECT_GT(mu, 0.0);
  EXPECT_LT(std::min(std::abs(mu - candidates[0]), std::abs(mu - candidates[1])), 1e-9 + 1e-6 * mu);
}

TEST(TaskIndices, WarnWhereAnIntervalExceedsATenthOfItsIndex) {
  EXPECT_FALSE(wide_interval(0.5, 0.48, 0.52));
  EXPECT_TRUE(wide_interval(0.5, 0.46, 0.52));
  EXPECT_TRUE(wide_interval(0.0, -0.01, 0.01));
  EXPECT_TRUE(wide_interval(0.5, std::nan(""), 0.5));
}

}  // namespace
}  // namespace veridyn::muscle
