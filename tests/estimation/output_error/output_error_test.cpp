#include "veridyn/estimation/output_error/output_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/estimation/output_error/example_models.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/regression/ordinary_least_squares.hpp"

namespace veridyn::estimation {
namespace {

using namespace testing_support;

TEST(OutputError, FindsTheParametersOfNoiselessDataToRounding) {
  const FirstOrder model(doublets(3, 120), 0.05);
  const OutputErrorEstimate e = output_error(model, truth_of(model));
  ASSERT_TRUE(e.usable()) << e.message;
  EXPECT_NEAR(e.theta(0), kA, 1e-9);
  EXPECT_NEAR(e.theta(1), kB, 1e-9);
  ASSERT_EQ(e.segment_parameters.size(), 3u);
  EXPECT_NEAR(e.segment_parameters[2].value, 0.5, 1e-9);
  EXPECT_EQ(e.segment_parameters[2].name, "x0");
}

TEST(OutputError, IsOrdinaryLeastSquaresOnAStaticModel) {
  // The same normal equations, s^2 and Morelli & Klein sum, written twice: through regression and through a model.
  std::mt19937_64 generator(4);
  const Index N = 600;
  RowMatrix X(N, 3);
  X.col(0).setOnes();
  for (Index j = 1; j < 3; ++j) X.col(j) = correlated_noise(generator, N, 0.9);
  const VectorXd z = X * Eigen::Vector3d(0.3, -1.2, 0.7) + 0.5 * correlated_noise(generator, N, 0.7);
  RegressionData data;
  data.regressors = X;
  data.regressand = z;
  data.parameter_names = {"a", "b", "c"};
  data.segment.assign(static_cast<std::size_t>(N), 0);
  std::fill(data.segment.begin() + 250, data.segment.end(), 1);
  const RegressionEstimate ols = estimate(data, Method::kOls);

  const Static model({{X.topRows(250)}, {X.bottomRows(N - 250)}});
  const OutputErrorEstimate oe = output_error(model, {z.head(250), z.tail(N - 250)});
  ASSERT_TRUE(oe.usable()) << oe.message;
  EXPECT_EQ(oe.lag_window, ols.lag_window);
  for (Index i = 0; i < 3; ++i) {
    // The search stops at a relative change of the cost of 1e-10, some 1e-4 sigma at worst.
    EXPECT_NEAR(oe.theta(i), ols.theta(i), 1e-5 * ols.parameters[i].sigma);
    for (Index j = 0; j < 3; ++j) {
      const double scale = std::sqrt(ols.covariance(i, i) * ols.covariance(j, j));
      EXPECT_NEAR(oe.covariance_white(i, j), ols.covariance_white(i, j), 1e-8 * scale);
      EXPECT_NEAR(oe.covariance(i, j), ols.covariance(i, j), 1e-7 * scale);
    }
  }
  EXPECT_GT(ols.parameters[1].sigma, 1.5 * ols.parameters[1].sigma_white);  // or the autocorrelated part was not tested
  EXPECT_NEAR(oe.degrees_of_freedom, ols.degrees_of_freedom, 1e-9);
}

// Without a step: the information at a place that another search found.
TEST(OutputError, WithoutStepsSaysWhatTheDataSayWhereItBegins) {
  std::mt19937_64 generator(4);
  RowMatrix X(200, 2);
  X.col(0).setOnes();
  X.col(1) = correlated_noise(generator, 200, 0.5);
  const VectorXd z = X * Eigen::Vector2d(0.3, -1.2) + 0.1 * correlated_noise(generator, 200, 0.0);
  const Static model({{X}});
  OutputErrorOptions options{
      .noise = OutputNoise::kGiven, .noise_start = VectorXd::Constant(1, 0.1), .max_relaxations = 1, .max_steps = 0};
  options.search_start = Eigen::Vector2d(0.4, -1.0);
  const OutputErrorEstimate there = output_error(model, {z}, options);
  ASSERT_TRUE(there.usable()) << there.message;
  EXPECT_EQ(there.theta, options.search_start);
  const Eigen::MatrixXd expected = 0.01 * Eigen::MatrixXd(X.transpose() * X).inverse();
  EXPECT_LT((there.covariance_white - expected).norm(), 1e-9 * expected.norm());
}

TEST(OutputError, UnknownsOfASegmentAreEliminatedAsTheirColumnsWouldBe) {
  // A bias per segment is a column of ones there: OLS with those columns, error bars of autocorrelated residuals
  // included.
  std::mt19937_64 generator(14);
  const Index N = 500, first = 180;
  RowMatrix X = RowMatrix::Zero(N, 4);
  for (Index j = 0; j < 2; ++j) X.col(j) = correlated_noise(generator, N, 0.95);
  X.col(0).array() += 2.0;  // far from its mean: the bias takes much of its information
  X.col(2).head(first).setOnes();
  X.col(3).tail(N - first).setOnes();
  RegressionData data;
  data.regressors = X;
  data.regressand = X * Eigen::Vector4d(0.3, -1.2, 0.7, -0.4) + 0.5 * correlated_noise(generator, N, 0.7);
  data.parameter_names = {"a", "b", "bias1", "bias2"};
  data.segment.assign(static_cast<std::size_t>(N), 0);
  std::fill(data.segment.begin() + first, data.segment.end(), 1);
  const RegressionEstimate ols = estimate(data, Method::kOls);
  const RowMatrix shared = X.leftCols(2);
  const Static model({{shared.topRows(first)}, {shared.bottomRows(N - first)}});
  const OutputErrorEstimate oe =
      output_error(model, {data.regressand.head(first), data.regressand.tail(N - first)}, {.output_biases = {"y0"}});
  ASSERT_TRUE(oe.usable()) << oe.message;
  ASSERT_GT(oe.lag_window, 0);
  for (Index i = 0; i < 2; ++i) {
    const Parameter& p = ols.parameters[i];
    EXPECT_NEAR(oe.theta(i), ols.theta(i), 1e-5 * p.sigma);
    EXPECT_NEAR(oe.parameters[i].sigma, p.sigma, 1e-6 * p.sigma);
    EXPECT_NEAR(oe.parameters[i].sigma_white, p.sigma_white, 1e-6 * p.sigma);
  }
  EXPECT_NEAR(oe.segment_parameters[1].value, ols.theta(3), 1e-4);
}

TEST(OutputError, WithFullNoiseIsSeeminglyUnrelatedRegression) {
  // Two outputs of correlated noise and one parameter each: the maximum-likelihood estimate is the fixed point of
  // Zellner's generalised least squares, here iterated with Kronecker products.
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  const Index N = 300;
  RowMatrix X0 = RowMatrix::Zero(N, 2), X1 = RowMatrix::Zero(N, 2);
  X0.col(0) = correlated_noise(generator, N, 0.5);
  X1.col(1) = correlated_noise(generator, N, 0.5);
  RowMatrix z(N, 2);
  for (Index k = 0; k < N; ++k) {
    const double e0 = normal(generator), e1 = 0.9 * e0 + 0.3 * normal(generator);
    z(k, 0) = 1.5 * X0(k, 0) + e0;
    z(k, 1) = -0.7 * X1(k, 1) + 2.0 * e1;
  }
  const Static model({{X0, X1}});
  const OutputErrorEstimate e =
      output_error(model, {z}, {.noise = OutputNoise::kFull, .covariance = CovarianceKind::kWhite, .tolerance = 1e-9});
  ASSERT_EQ(e.termination, OutputErrorTermination::kConverged) << e.message;
  Eigen::Vector2d theta(0.0, 0.0);
  Eigen::Matrix2d R = Eigen::Matrix2d::Identity(), normal_matrix;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix2d P = R.inverse();
    normal_matrix.setZero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (Index k = 0; k < N; ++k) {
      const Eigen::Matrix2d S = (Eigen::Matrix2d() << X0.row(k), X1.row(k)).finished();
      normal_matrix += S.transpose() * P * S;
      right += S.transpose() * P * z.row(k).transpose();
    }
    theta = normal_matrix.inverse() * right;
    R.setZero();
    for (Index k = 0; k < N; ++k) {
      const Eigen::Vector2d r(z(k, 0) - X0.row(k).dot(theta), z(k, 1) - X1.row(k).dot(theta));
      R += r * r.transpose() / static_cast<double>(N);
    }
  }
  EXPECT_NEAR(e.theta(0), theta(0), 1e-8);
  EXPECT_NEAR(e.theta(1), theta(1), 1e-8);
  EXPECT_LT((e.noise_covariance - R).cwiseAbs().maxCoeff(), 1e-7);
  const double inflation = 600.0 / 598.0;
  EXPECT_LT((e.covariance - inflation * normal_matrix.inverse()).cwiseAbs().maxCoeff(), 1e-8);
  // A correlation of 0.95 is worth a factor of three in the error bars: diagonal R must not give the same.
  const OutputErrorEstimate diagonal = output_error(model, {z}, {.covariance = CovarianceKind::kWhite});
  EXPECT_GT(diagonal.parameters[0].sigma, 2.0 * e.parameters[0].sigma);
}

TEST(OutputError, MissingValuesOfOneOutputAreLeftOutOrFilledByTheirExpectation) {
  // With y1 missing in every other sample and full R, the EM fixed point has a zero gradient of the likelihood of what
  // was observed: checked by differences of the likelihood itself.
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  const Index N = 200;
  RowMatrix X0 = RowMatrix::Zero(N, 2), X1 = RowMatrix::Zero(N, 2), z(N, 2);
  X0.col(0) = correlated_noise(generator, N, 0.5);
  X1.col(1) = correlated_noise(generator, N, 0.5);
  for (Index k = 0; k < N; ++k) {
    const double e0 = normal(generator);
    z(k, 0) = X0(k, 0) + e0;
    z(k, 1) = k % 2 == 0 ? X1(k, 1) + 0.8 * e0 + 0.6 * normal(generator) : std::nan("");
  }
  Static model({{X0, X1}});
  const OutputErrorEstimate e =
      output_error(model, {z}, {.noise = OutputNoise::kFull, .max_relaxations = 400, .tolerance = 1e-10});
  ASSERT_TRUE(e.usable()) << e.message;
  EXPECT_EQ(e.values, 300);
  const auto likelihood = [&](const Eigen::Vector2d& theta, const Eigen::Matrix2d& R) {
    double sum = 0.0;
    for (Index k = 0; k < N; ++k) {
      const Eigen::Vector2d r(z(k, 0) - X0.row(k).dot(theta), z(k, 1) - X1.row(k).dot(theta));
      if (std::isfinite(r(1)))
        sum += 0.5 * r.dot(R.inverse() * r) + 0.5 * std::log(R.determinant());
      else
        sum += 0.5 * r(0) * r(0) / R(0, 0) + 0.5 * std::log(R(0, 0));
    }
    return sum;
  };
  const Eigen::Matrix2d R = e.noise_covariance;
  const Eigen::Vector2d theta = e.theta;
  EXPECT_NEAR(e.negative_log_likelihood, likelihood(theta, R), 1e-8);
  const double h = 1e-4;
  for (Index i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = h * Eigen::Vector2d::Unit(i);
    EXPECT_NEAR((likelihood(theta + step, R) - likelihood(theta - step, R)) / (2.0 * h), 0.0, 1e-3);
  }
  for (const auto& [i, j] : {std::pair{0, 0}, std::pair{0, 1}, std::pair{1, 1}}) {
    Eigen::Matrix2d up = R, down = R;
    up(i, j) += h;
    down(i, j) -= h;
    up(j, i) = up(i, j);
    down(j, i) = down(i, j);
    EXPECT_NEAR((likelihood(theta, up) - likelihood(theta, down)) / (2.0 * h), 0.0, 1e-2) << i << j;
  }
}

/// Share of 95 % intervals that hold the truth, over seeds and both parameters.
double coverage(double rho, CovarianceKind kind, int seeds) {
  int held = 0;
  const FirstOrder model(doublets(4, 250), 0.05);
  const std::vector<RowMatrix> truth = truth_of(model);
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 generator(static_cast<std::uint64_t>(seed) + 1000);
    std::vector<RowMatrix> z = truth;
    add_noise(z, generator, 0.05, 0.2, rho);
    const OutputErrorEstimate e = output_error(model, z, {.covariance = kind, .threads = 1});
    EXPECT_EQ(e.termination, OutputErrorTermination::kConverged) << e.message;
    held += e.parameters[0].low95 < kA && kA < e.parameters[0].high95;
    held += e.parameters[1].low95 < kB && kB < e.parameters[1].high95;
  }
  return held / (2.0 * seeds);
}

TEST(OutputError, IntervalsCoverTheTruthInNinetyFivePercentUnderWhiteNoise) {
  // Standard error of the share over 2 x 150 trials: 0.013.
  EXPECT_NEAR(coverage(0.0, CovarianceKind::kWhite, 150), 0.95, 0.04);
  EXPECT_NEAR(coverage(0.0, CovarianceKind::kAutocorrelated, 150), 0.95, 0.04);
}

TEST(OutputError, IntervalsCoverTheTruthUnderColouredNoiseOnlyWhenCorrectedForIt) {
  EXPECT_LT(coverage(0.9, CovarianceKind::kWhite, 60), 0.75);
  EXPECT_NEAR(coverage(0.9, CovarianceKind::kAutocorrelated, 150), 0.95, 0.04);
}

TEST(OutputError, GivesTheSameBitsOnAnyNumberOfThreads) {
  const FirstOrder model(doublets(5, 150), 0.05);
  std::vector<RowMatrix> z = truth_of(model);
  std::mt19937_64 generator(3);
  add_noise(z, generator, 0.1, 0.3, 0.5);
  const OutputErrorEstimate one = output_error(model, z, {.threads = 1});
  for (const int threads : {2, 3, 8}) {
    const OutputErrorEstimate many = output_error(model, z, {.threads = threads});
    EXPECT_EQ(one.theta, many.theta);
    EXPECT_EQ(one.covariance, many.covariance);
    EXPECT_EQ(one.noise_covariance, many.noise_covariance);
  }
}

TEST(OutputError, NamesWhatTheDataDoNotDetermineInsteadOfANumber) {
  RowMatrix X(100, 3);
  std::mt19937_64 generator(5);
  X.col(0) = correlated_noise(generator, 100, 0.5);
  X.col(1) = X.col(0);  // only theta0 + theta1 can be known
  X.col(2) = correlated_noise(generator, 100, 0.5);
  const VectorXd z = X * Eigen::Vector3d(1.0, 0.5, -2.0) + 0.1 * correlated_noise(generator, 100, 0.0);
  const Static model({{X}});
  const OutputErrorEstimate e = output_error(model, {z});
  ASSERT_TRUE(e.usable()) << e.message;
  ASSERT_EQ(e.unidentifiable.size(), 1u);
  EXPECT_THAT(e.unidentifiable[0].text, ::testing::AnyOf("0.71 theta0 - 0.71 theta1", "0.71 theta1 - 0.71 theta0"));
  EXPECT_THAT(e.message, ::testing::HasSubstr("not identifiable: 0.71"));
  EXPECT_EQ(e.parameters[0].status, ParameterStatus::kNotExcited);
  EXPECT_TRUE(std::isinf(e.parameters[0].sigma));
  EXPECT_EQ(e.parameters[2].status, ParameterStatus::kIdentified);
  EXPECT_NEAR(e.theta(0) + e.theta(1), 1.5, 0.05);
  EXPECT_NEAR(e.theta(2), -2.0, 5.0 * e.parameters[2].sigma);
  EXPECT_TRUE(std::isfinite(e.parameters[2].sigma));
}

TEST(OutputError, APriorIsWorthAsManyDataAsItsSigmaSays) {
  // One parameter, unit regressor: posterior precision = N / R + 1 / sigma^2, mean in proportion.
  std::mt19937_64 generator(6);
  const RowMatrix X = RowMatrix::Ones(50, 1);
  const VectorXd z = VectorXd::Constant(50, 2.0) + correlated_noise(generator, 50, 0.0);
  Static model({{X}});
  model.unknowns[0] = {.name = "m", .start = 1.0, .prior_sigma = 0.1};
  const OutputErrorOptions options{
      .noise = OutputNoise::kGiven, .noise_start = VectorXd::Constant(1, 0.5), .covariance = CovarianceKind::kWhite};
  const OutputErrorEstimate e = output_error(model, {z}, options);
  ASSERT_TRUE(e.usable());
  const double data = 50.0 / 0.25, prior = 100.0;
  EXPECT_NEAR(e.theta(0), (data * z.mean() + prior * 1.0) / (data + prior), 1e-6);
  EXPECT_NEAR(e.covariance(0, 0), 1.0 / (data + prior), 1e-12);
  EXPECT_NEAR(e.learned_share(0), 1.0 - prior / (data + prior), 1e-9);
}

TEST(OutputError, KeepsBoundsAndFixedParameters) {
  FirstOrder model(doublets(2, 120), 0.05);
  const auto z = truth_of(model);
  model.unknowns[0].high = 1.5;  // truth 1.7
  OutputErrorEstimate e = output_error(model, z);
  ASSERT_TRUE(e.usable()) << e.message;
  EXPECT_NEAR(e.theta(0), 1.5, 1e-9);
  model.unknowns[0] = {.name = "a", .start = kA, .fixed = true};
  e = output_error(model, z);
  EXPECT_EQ(e.theta(0), kA);
  EXPECT_EQ(e.parameters[0].status, ParameterStatus::kFixed);
  EXPECT_EQ(e.parameters[0].sigma, 0.0);
  EXPECT_NEAR(e.theta(1), kB, 1e-9);
}

// Where the search presses on a bound the rest of the way is gone along it: to where it ends with that unknown held
// there, and with about as many simulations.
TEST(OutputError, GoesAlongABoundAsIfItsUnknownWereHeldThere) {
  FirstOrder model(doublets(2, 120), 0.05);
  std::vector<RowMatrix> z = truth_of(model);
  std::mt19937_64 generator(7);
  add_noise(z, generator, 0.01, 0.01);
  const auto found = [&](ModelParameter a) {
    model.unknowns[0] = std::move(a);
    return output_error(model, z);
  };
  for (const double bound : {0.8, 1.5, 1.69}) {
    const OutputErrorEstimate held = found({.name = "a", .start = bound, .fixed = true});
    for (const double start : {0.7, bound}) {
      const OutputErrorEstimate e = found({.name = "a", .start = start, .low = 0.1, .high = bound});
      ASSERT_TRUE(e.usable()) << e.message;
      EXPECT_EQ(e.parameters[0].status, ParameterStatus::kAtBound);
      EXPECT_NEAR(e.theta(1), held.theta(1), 1e-3 * held.parameters[1].sigma) << bound;
      EXPECT_LT(e.simulations.with_derivatives, held.simulations.with_derivatives + 2U * 12U) << bound;
    }
  }
  // A search that begins at a bound leaves it where the data say so.
  EXPECT_NEAR(found({.name = "a", .start = 0.5, .low = 0.5, .high = 3.0}).theta(0),
              found({.name = "a", .start = 1.0}).theta(0), 1e-5);
}

TEST(OutputError, FindsTheBiasOfAnOutput) {
  const FirstOrder model(doublets(2, 150), 0.05);
  std::vector<RowMatrix> z = truth_of(model);
  z[0].col(0).array() += 0.1;
  z[0].col(1).array() += 0.4;
  z[1].col(1).array() -= 0.2;
  const OutputErrorEstimate e = output_error(model, z, {.output_biases = {"x", "rate"}});
  ASSERT_TRUE(e.usable()) << e.message;
  EXPECT_NEAR(e.theta(0), kA, 1e-8);
  ASSERT_EQ(e.segment_parameters.size(), 6u);
  EXPECT_EQ(e.segment_parameters[5].name, "bias of rate");
  EXPECT_NEAR(e.segment_parameters[1].value, 0.1, 1e-8);
  EXPECT_NEAR(e.segment_parameters[2].value, 0.4, 1e-8);
  EXPECT_NEAR(e.segment_parameters[5].value, -0.2, 1e-8);
  // Without it the estimate is off, so that the above means something.
  EXPECT_GT(std::abs(output_error(model, z).theta(0) - kA), 1e-3);
}

TEST(OutputError, RefusesStepsThatDivergeAndGoesOn) {
  FirstOrder model(doublets(2, 150), 0.05);
  model.refuses_growth = true;
  const auto z = truth_of(model);
  model.unknowns[0].start = 25.0;  // the first full step overshoots below zero
  const OutputErrorEstimate e = output_error(model, z);
  ASSERT_TRUE(e.usable()) << e.message;
  EXPECT_GT(e.diverged_steps, 0);
  EXPECT_THAT(e.message, ::testing::HasSubstr("refused because a simulation diverged, last that of segment 1"));
  EXPECT_NEAR(e.theta(0), kA, 1e-8);
}

TEST(OutputError, NamesTheSegmentThatDivergesAtTheStart) {
  FirstOrder model(doublets(2, 50), 0.05);
  const auto z = truth_of(model);
  model.refuses_growth = true;
  model.unknowns[0].start = -1.0;
  const OutputErrorEstimate e = output_error(model, z);
  EXPECT_EQ(e.termination, OutputErrorTermination::kDivergedAtStart);
  EXPECT_FALSE(e.usable());
  EXPECT_EQ(e.message, "the simulation of segment 1 diverges at the starting values");
  EXPECT_TRUE(std::isinf(e.parameters[0].sigma));
}

TEST(OutputError, StopsWhenTheCallerAsks) {
  class Impatient : public Progress {
   public:
    bool update(double) override { return false; }
    bool interrupted() const override { return true; }
  } progress;
  const FirstOrder model(doublets(2, 50), 0.05);
  const OutputErrorEstimate e = output_error(model, truth_of(model), {}, progress);
  EXPECT_EQ(e.termination, OutputErrorTermination::kInterrupted);
  EXPECT_FALSE(e.usable());
  EXPECT_FALSE(e.has_estimate());
  EXPECT_EQ(e.message, "interrupted");
}

TEST(OutputError, LeavesWhereItStoodWhenItIsStoppedOnTheWay) {
  class Patient : public Progress {
   public:
    explicit Patient(int questions) : left_(questions) {}
    bool update(double) override { return !interrupted(); }
    bool interrupted() const override { return --left_ < 0; }

   private:
    mutable int left_;
  };
  const FirstOrder model(doublets(2, 50), 0.05);
  auto z = truth_of(model);
  std::mt19937_64 generator(3);
  add_noise(z, generator, 0.01, 0.02);
  const OutputErrorEstimate whole = output_error(model, z);
  double last = kInfinity;
  // A question before any step, then one after each: every step has made the data likelier.
  for (const int questions : {1, 2, 3, 4}) {
    Patient progress(questions);
    const OutputErrorEstimate e = output_error(model, z, {}, progress);
    ASSERT_EQ(e.termination, OutputErrorTermination::kInterrupted) << questions;
    EXPECT_FALSE(e.usable());
    ASSERT_TRUE(e.has_estimate());
    EXPECT_GT(e.accepted_steps, 0);
    EXPECT_LT(e.negative_log_likelihood, last) << questions;
    last = e.negative_log_likelihood;
    EXPECT_TRUE(std::isfinite(e.parameters[0].sigma) && e.parameters[0].sigma > 0.0);
    EXPECT_EQ(e.outputs.size(), whole.outputs.size());
    EXPECT_THAT(e.message, ::testing::StartsWith("interrupted after 1 relaxation"));
  }
  EXPECT_GT(last, whole.negative_log_likelihood);
}

TEST(OutputError, SaysWhatIsWrongWithItsInput) {
  FirstOrder model(doublets(2, 50), 0.05);
  auto z = truth_of(model);
  const auto message = [&](const OutputErrorOptions& options) -> std::string {
    try {
      static_cast<void>(output_error(model, z, options));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message({.output_biases = {"ratee"}}),
            "output_error.output_biases: 'ratee' is not an output of the model (did you mean 'rate'?)");
  EXPECT_EQ(message({.tolerance = std::nan("")}), "output_error.tolerance: is nan; must be > 0");
  EXPECT_THAT(message({.noise = OutputNoise::kGiven}), ::testing::HasSubstr("noise_start: is empty"));
  z[1].conservativeResize(49, 2);
  EXPECT_EQ(message({}), "output_error.measured: segment 2: is 49 x 2; must be 50 samples x 2 outputs");
  z.pop_back();
  EXPECT_EQ(message({}), "output_error.measured: has 1 segments; the model has 2 and needs at least one");
  model.unknowns[1].start = std::nan("");
  z = {RowMatrix::Zero(50, 2), RowMatrix::Zero(50, 2)};
  EXPECT_EQ(message({}), "output_error.parameters: b: start is nan; must be finite");
}

TEST(OutputError, TooFewValuesAreSaidToBe) {
  const Static model({{RowMatrix::Ones(2, 3)}});
  const OutputErrorEstimate e = output_error(model, {RowMatrix::Ones(2, 1)});
  EXPECT_EQ(e.termination, OutputErrorTermination::kTooFewSamples);
  EXPECT_EQ(e.message, "2 measured values for 3 unknowns");
}

}  // namespace
}  // namespace veridyn::estimation
