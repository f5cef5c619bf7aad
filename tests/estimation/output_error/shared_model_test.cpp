#include "veridyn/estimation/output_error/shared_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <thread>

#include "tests/estimation/output_error/example_models.hpp"
#include "tests/support/thread_ranks.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/numerics/ranks/ranks_progress.hpp"

namespace veridyn::estimation {
namespace {

using numerics::Ranks;
using numerics::SharedWork;
using testing_support::FirstOrder;

class SharedModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t s = 0; s < 2; ++s) {
      ModelResponse truth;
      ASSERT_TRUE(model_.respond(s, Eigen::Vector3d(1.4, 0.7, 0.2), {}, truth));
      for (Eigen::Index k = 0; k < truth.output.rows(); ++k)
        truth.output(k, 0) += 0.02 * std::sin(7.0 * static_cast<double>(k));
      measured_.push_back(truth.output);
    }
  }
  static Eigen::VectorXd input(double frequency) {
    return Eigen::VectorXd::LinSpaced(60, 0.0, 6.0).unaryExpr([=](double t) { return std::sin(frequency * t); });
  }
  /// Bits of the estimate.
  [[nodiscard]] std::vector<std::uint64_t> estimate(const ParametricModel& model, int threads) const {
    const OutputErrorEstimate e = output_error(model, measured_, {.threads = threads});
    std::vector<std::uint64_t> all;
    for (const double v : e.theta) all.push_back(std::bit_cast<std::uint64_t>(v));
    for (const double v : e.covariance.reshaped()) all.push_back(std::bit_cast<std::uint64_t>(v));
    return all;
  }
  /// What a process does: the first one's part, or to serve.
  template <typename First>
  void share(const Ranks& ranks, const First& first) {
    SharedWork work(ranks, 7, 1, [&](std::span<const double> request, std::vector<double>& reply) {
      ++computed_[ranks.rank()];
      // However busy the machine is: the first leaves something to the others.
      for (int i = 0; i < 10000 && ranks.first() && computed_[1] + computed_[2] == 0; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      SharedModel::responses_of(model_)(request, reply);
    });
    if (!ranks.first()) return static_cast<void>(work.serve());
    first(SharedModel(model_, work), work.threads());
    work.finish();
  }

  FirstOrder model_{{input(1.0), input(2.5)}, 0.1};
  std::vector<RowMatrix> measured_;
  std::array<std::atomic<int>, 3> computed_{};
};

TEST_F(SharedModelTest, ASearchComesToTheSameBitsOnAnyNumberOfProcesses) {
  const std::vector<std::uint64_t> expected = estimate(model_, 1);
  for (const std::size_t size : {1U, 2U, 3U}) {
    std::vector<std::uint64_t> found;
    test::run_ranks(size, [&](const Ranks& ranks) {
      share(ranks, [&](const SharedModel& model, int threads) { found = estimate(model, threads); });
    });
    EXPECT_EQ(found, expected) << size;
  }
  EXPECT_GT(computed_[1] + computed_[2], 0);
}

TEST_F(SharedModelTest, PassesOnDerivativesAndRunsThatDidNotFinish) {
  model_.refuses_growth = true;
  const Eigen::Vector3d theta(1.0, 0.5, 0.0), growing(-1.0, 0.5, 0.0);
  const std::vector<Eigen::Index> active = {2, 0};
  ModelResponse expected;
  ASSERT_TRUE(model_.respond(1, theta, active, expected));
  test::run_ranks(2, [&](const Ranks& ranks) {
    share(ranks, [&](const SharedModel& model, int) {
      numerics::parallel_for(8, 2, [&](std::size_t i) {
        ModelResponse response;
        if (i % 2 == 0) {
          EXPECT_TRUE(model.respond(1, theta, active, response));
          EXPECT_EQ(response.output, expected.output);
          EXPECT_EQ(response.sensitivity, expected.sensitivity);
        } else {
          EXPECT_FALSE(model.respond(0, growing, {}, response));
        }
      });
    });
  });
}

TEST_F(SharedModelTest, AProgressAllowsTheThreadsOfAll) {
  Progress outer;
  const numerics::RanksProgress progress(outer, 5);
  EXPECT_EQ(progress.threads(), 5);
  EXPECT_FALSE(progress.interrupted());
}

}  // namespace
}  // namespace veridyn::estimation
