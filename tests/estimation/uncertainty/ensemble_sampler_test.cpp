#include "veridyn/estimation/uncertainty/ensemble_sampler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class SamplerThreads : public Progress {
 public:
  explicit SamplerThreads(int count) : count_(count) {}
  [[nodiscard]] int threads() const override { return count_; }

 private:
  int count_;
};

/// Point by point on `threads` threads.
LogDensities point_by_point(LogDensity density, int threads) {
  return [density = std::move(density), threads](std::span<const Eigen::VectorXd> points, std::span<double> values) {
    numerics::parallel_for(points.size(), threads, [&](std::size_t i) { values[i] = density(points[i]); });
  };
}

VectorXd mean_of(const EnsembleSample& s) { return s.draws.colwise().mean().transpose(); }
MatrixXd covariance_of(const EnsembleSample& s) {
  const MatrixXd centred = s.draws.rowwise() - s.draws.colwise().mean();
  return centred.transpose() * centred / static_cast<double>(s.draws.rows());
}

EnsembleSample sampled(const LogDensity& density, const NormalApproximation& start, bool near,
                       const EnsembleOptions& options, int threads = 2) {
  SamplerThreads progress(threads);
  return sample_ensemble(point_by_point(density, threads), ensemble_start(density, start, options),
                         near ? std::optional(start) : std::nullopt, options, progress);
}

/// Five coordinates, neighbours correlated, scales from 1 to 10^4.
class Normal5 {
 public:
  Normal5() : mean_(VectorXd::LinSpaced(5, -2.0, 2.0)), covariance_(5, 5) {
    for (Index i = 0; i < 5; ++i)
      for (Index j = 0; j < 5; ++j)
        covariance_(i, j) =
            std::pow(10.0, static_cast<double>(i + j)) * std::pow(0.8, std::abs(static_cast<double>(i - j)));
    information_ = covariance_.inverse();
  }
  [[nodiscard]] LogDensity density() const {
    return [this](const VectorXd& x) { return -0.5 * (x - mean_).dot(information_ * (x - mean_)); };
  }
  [[nodiscard]] const VectorXd& mean() const { return mean_; }
  [[nodiscard]] const MatrixXd& covariance() const { return covariance_; }

 private:
  VectorXd mean_;
  MatrixXd covariance_, information_;
};

TEST(EnsembleSampler, HasMeanAndCovarianceOfANormalDensityWithAndWithoutItsApproximation) {
  const Normal5 normal;
  // Half the size and off by a standard deviation: an approximation that is poor.
  const NormalApproximation start{normal.mean() + normal.covariance().diagonal().cwiseSqrt(),
                                  0.5 * normal.covariance()};
  for (const bool near : {false, true}) {
    const EnsembleSample s = sampled(normal.density(), start, near, {.steps = 10000, .effective = 2000});
    ASSERT_TRUE(s.converged) << s.message;
    const VectorXd sd = normal.covariance().diagonal().cwiseSqrt();
    // Four standard errors of as many independent draws as it says it has; those of a variance have a relative error of
    // sqrt(2/n).
    const double error = 4.0 / std::sqrt(s.effective);
    for (Index i = 0; i < 5; ++i) {
      EXPECT_NEAR(mean_of(s)(i), normal.mean()(i), error * sd(i)) << near << " " << i;
      for (Index j = 0; j < 5; ++j)
        EXPECT_NEAR(covariance_of(s)(i, j), normal.covariance()(i, j), 1.5 * error * sd(i) * sd(j)) << i << j;
    }
    EXPECT_GT(s.acceptance, 0.1);
  }
}

TEST(EnsembleSampler, FollowsABentValleyThatItsApproximationDoesNotKnow) {
  // x ~ N(0, 1), y | x ~ N(x^2, 0.5^2): mean of y is 1, its variance 2 + 0.25.
  const LogDensity banana = [](const VectorXd& v) {
    return -0.5 * v(0) * v(0) - 0.5 * std::pow((v(1) - v(0) * v(0)) / 0.5, 2);
  };
  const NormalApproximation start{VectorXd::Zero(2), Eigen::Vector2d(1.0, 0.25).asDiagonal()};
  const EnsembleSample s = sampled(banana, start, true, {.steps = 20000, .effective = 1000});
  ASSERT_TRUE(s.converged) << s.message;
  EXPECT_NEAR(mean_of(s)(0), 0.0, 4.0 / std::sqrt(s.effective));
  EXPECT_NEAR(mean_of(s)(1), 1.0, 4.0 * 1.5 / std::sqrt(s.effective));
  EXPECT_NEAR(covariance_of(s)(0, 0), 1.0, 6.0 / std::sqrt(s.effective));
  // (y - 1)^2 has a standard deviation of about 7: y has a long tail.
  EXPECT_NEAR(covariance_of(s)(1, 1), 2.25, 4.0 * 7.0 / std::sqrt(s.effective));
}

TEST(EnsembleSampler, StaysWithinBoundsAndHasTheTruncatedMean) {
  // The right half of a normal density: mean sqrt(2/pi).
  const LogDensity half = [](const VectorXd& x) { return x(0) < 0.0 ? -kInfinity : -0.5 * x.squaredNorm(); };
  const NormalApproximation start{Eigen::Vector2d(0.1, 0.0), MatrixXd::Identity(2, 2)};
  const EnsembleSample s = sampled(half, start, true, {.effective = 4000});
  ASSERT_TRUE(s.converged) << s.message;
  EXPECT_GE(s.draws.col(0).minCoeff(), 0.0);
  EXPECT_NEAR(mean_of(s)(0), std::sqrt(2.0 / kPi), 4.0 * 0.6 / std::sqrt(s.effective));
  EXPECT_NEAR(mean_of(s)(1), 0.0, 4.0 / std::sqrt(s.effective));
}

TEST(EnsembleSampler, HasTheSameBitsOnAnyNumberOfThreadsAndOthersWithAnotherSeed) {
  const Normal5 normal;
  const NormalApproximation start{normal.mean(), normal.covariance()};
  const EnsembleOptions options{.steps = 60, .effective = 100000};
  const EnsembleSample one = sampled(normal.density(), start, true, options, 1);
  const EnsembleSample three = sampled(normal.density(), start, true, options, 3);
  EXPECT_EQ(one.draws, three.draws);
  EXPECT_FALSE(one.converged);
  EXPECT_THAT(one.message, testing::HasSubstr("too few"));
  const EnsembleSample other = sampled(normal.density(), start, true, {.steps = 60, .effective = 100000, .seed = 2}, 1);
  EXPECT_NE(one.draws, other.draws);
}

TEST(EnsembleSampler, RefusesWhatCannotBeSampled) {
  const LogDensity nowhere = [](const VectorXd&) { return -kInfinity; };
  const NormalApproximation start{VectorXd::Zero(2), MatrixXd::Identity(2, 2)};
  EXPECT_THROW((void)ensemble_start(nowhere, start, {}), InputError);
  const NormalApproximation flat{VectorXd::Zero(2), MatrixXd::Zero(2, 2)};
  const LogDensity anywhere = [](const VectorXd&) { return 0.0; };
  EXPECT_THROW((void)ensemble_start(anywhere, flat, {}), InputError);
  EXPECT_THROW(EnsembleOptions{.walkers = 7}.validate(2), InputError);
  EXPECT_THROW(EnsembleOptions{.walkers = 8}.validate(5), InputError);
  EXPECT_THROW(EnsembleOptions{.steps = 0}.validate(2), InputError);
}

}  // namespace
}  // namespace veridyn::estimation
