#include "veridyn/estimation/recursive/recursive_regression.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/ordinary_least_squares.hpp"
#include "veridyn/estimation/regression/pca_total_least_squares.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::simulate_regression;

constexpr double kLastDigits = 1e-9;

Eigen::MatrixXd correlated_errors(Eigen::Index n, double ratio) {
  Eigen::MatrixXd W = ratio * Eigen::MatrixXd::Identity(n + 1, n + 1);
  W.row(0).setZero();
  W.col(0).setZero();
  for (Eigen::Index i = 1; i < n; ++i) W(i, i + 1) = W(i + 1, i) = 0.3 * ratio;
  return W;
}

void feed(RecursiveRegression& recursive, const RegressionData& data) {
  for (Eigen::Index k = 0; k < data.rows(); ++k) {
    const auto result = recursive.update(
        std::span(data.regressors.row(k).data(), static_cast<std::size_t>(data.parameters())), data.regressand(k));
    ASSERT_TRUE(result.accepted);
  }
}

// |a - b| over the largest element: the tolerance is on digits of the whole.
double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

struct Case {
  Method method;
  Eigen::Index n;
};
class RecursiveRegressionOfAnyMethod : public ::testing::TestWithParam<Case> {
 protected:
  static RegressionData data(unsigned seed, Eigen::Index rows = 800) {
    const Eigen::Index n = GetParam().n;
    auto simulated = simulate_regression(seed, Eigen::VectorXd::LinSpaced(n, -1.0, 2.0), correlated_errors(n, 0.02),
                                         {.rows = rows, .regressor_rho = 0.5});
    return simulated.data;
  }
  static RecursiveOptions options(const RegressionData& data, double lambda) {
    RecursiveOptions o;
    o.method = GetParam().method;
    o.forgetting.lambda = lambda;
    o.forgetting.lambda_min = std::min(0.5, lambda);
    o.covariance = CovarianceKind::kWhite;
    o.error_covariance = data.error_covariance;
    return o;
  }
};

TEST_P(RecursiveRegressionOfAnyMethod, IsTheBatchEstimateOfTheSameRowsWhenNothingIsForgotten) {
  const RegressionData d = data(1);
  RecursiveRegression recursive(d.parameter_names, options(d, 1.0));
  feed(recursive, d);
  const RegressionEstimate batch = estimate(d, GetParam().method, {.covariance = CovarianceKind::kWhite});
  ASSERT_TRUE(batch.usable());
  ASSERT_TRUE(recursive.usable());
  EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits);
  EXPECT_LT(relative(recursive.covariance(), batch.covariance), kLastDigits);
  EXPECT_EQ(recursive.excited_directions(), d.parameters());
  if (GetParam().method != Method::kOls) {
    EXPECT_NEAR(recursive.error_scale(), batch.error_scale, kLastDigits * batch.error_scale);
    for (std::size_t j = 0; j < batch.singular_values.size(); ++j) {
      EXPECT_NEAR(recursive.singular_values()(static_cast<Eigen::Index>(j)), batch.singular_values[j],
                  kLastDigits * batch.singular_values[j]);
    }
  }
}

TEST_P(RecursiveRegressionOfAnyMethod, IsTheBatchEstimateOfRowsWeightedByTheRootOfLambda) {
  RegressionData d = data(2);
  const double lambda = 0.998;  // all directions stay excited
  RecursiveRegression recursive(d.parameter_names, options(d, lambda));
  feed(recursive, d);
  d.row_scale.resize(d.rows());
  for (Eigen::Index k = 0; k < d.rows(); ++k)
    d.row_scale(k) = std::pow(lambda, -0.5 * static_cast<double>(d.rows() - 1 - k));
  const RegressionEstimate batch = estimate(d, GetParam().method, {.covariance = CovarianceKind::kWhite});
  EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits);
  EXPECT_NEAR(recursive.effective_samples(), (1.0 - std::pow(lambda, 800.0)) / (1.0 - lambda), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Methods, RecursiveRegressionOfAnyMethod,
                         ::testing::Values(Case{Method::kOls, 4}, Case{Method::kGtls, 4}, Case{Method::kPcaGtls, 4},
                                           Case{Method::kOls, 7}, Case{Method::kGtls, 7}, Case{Method::kPcaGtls, 7},
                                           Case{Method::kOls, 1}, Case{Method::kGtls, 2}, Case{Method::kGtls, 8}));

TEST(RecursiveRegression, WithUnknownDirectionsIsTheBatchPcaAroundTheEstimateBefore) {
  // theta2 and theta3 hardly move: not excited.
  auto simulated =
      simulate_regression(3, Eigen::Vector4d(0.2, 1.0, -0.5, 0.3), correlated_errors(4, 0.02), {.rows = 600});
  RegressionData& d = simulated.data;
  d.regressors.rightCols(1) *= 0.05;
  d.regressors.col(2) = d.regressors.col(1) * 0.7 + 0.02 * d.regressors.col(2);
  RecursiveOptions options{.error_covariance = d.error_covariance, .covariance = CovarianceKind::kWhite};
  options.forgetting.lambda = 1.0;
  RecursiveRegression recursive(d.parameter_names, options);
  Eigen::VectorXd before = recursive.theta();
  AugmentedQr qr(5);
  int partial = 0;
  for (Eigen::Index k = 0; k < d.rows(); ++k) {
    Eigen::Matrix<double, 1, 5, Eigen::RowMajor> row;
    row << d.regressors.row(k), d.regressand(k);
    qr.append(row);
    recursive.update(std::span(row.data(), 4), row(4));
    if (k > 100 && k % 50 == 0) {
      const auto batch = pca_total_least_squares(qr.triangle(), d.error_covariance, static_cast<double>(k + 1), 1.0,
                                                 true, before, Eigen::VectorXd::Ones(4));
      ASSERT_EQ(recursive.excited_directions(), batch.excited_directions);
      ASSERT_LT(relative(recursive.theta(), batch.theta), kLastDigits) << k;
      partial += batch.excited_directions < 4 ? 1 : 0;
      ASSERT_EQ(recursive.unexcited().cols(), batch.unexcited.cols());
      // Same subspace.
      const Eigen::MatrixXd U = recursive.unexcited();
      EXPECT_LT((U - batch.unexcited * (batch.unexcited.transpose() * U)).norm(), 1e-8);
    }
    before = recursive.theta();
  }
  EXPECT_GT(partial, 5);
}

// Rows of a and b, one after the other.
RegressionData joined(const RegressionData& a, const RegressionData& b) {
  RegressionData both = a;
  both.regressors.resize(a.rows() + b.rows(), a.parameters());
  both.regressors << a.regressors, b.regressors;
  both.regressand.resize(a.rows() + b.rows());
  both.regressand << a.regressand, b.regressand;
  return both;
}

TEST(RecursiveRegression, StartedFromABatchEstimateIsTheBatchEstimateOfBothRecordings) {
  const Eigen::Vector4d truth(0.2, 1.0, -0.5, 0.3);
  const Eigen::MatrixXd W = correlated_errors(4, 0.02);
  const RegressionData first = simulate_regression(5, truth, W, {.rows = 1500}).data;
  const RegressionData second = simulate_regression(6, truth, W, {.rows = 500}).data;
  for (const Method method : {Method::kOls, Method::kGtls, Method::kPcaGtls}) {
    const RegressionOptions white{.covariance = CovarianceKind::kWhite};
    const RegressionEstimate before = estimate(first, method, white);
    const RegressionEstimate both = estimate(joined(first, second), method, white);
    RecursiveOptions options{.method = method, .error_covariance = W, .covariance = CovarianceKind::kWhite};
    options.forgetting.lambda = 1.0;
    RecursiveRegression recursive(first.parameter_names, options);
    const double s = method == Method::kOls ? before.residual_sd : 0.0;
    recursive.start(before.theta, before.covariance, 1500.0, s);
    EXPECT_LT(relative(recursive.theta(), before.theta), 1e-8);
    feed(recursive, second);
    if (method == Method::kOls) {
      // Rows P_0^-1/2 hold X'X and the residual of the first recording exactly.
      EXPECT_LT(relative(recursive.theta(), both.theta), kLastDigits);
      EXPECT_LT(relative(recursive.covariance(), both.covariance), kLastDigits);
    } else {
      // The second-order term of P_0, 2 % here, is taken for less information; the answer differs by far less than its
      // error bar.
      for (Eigen::Index i = 0; i < 4; ++i) {
        const double sigma = std::sqrt(both.covariance(i, i));
        EXPECT_NEAR(recursive.theta()(i), both.theta(i), 0.15 * sigma);
        EXPECT_NEAR(recursive.sigma()(i), sigma, 0.1 * sigma);
      }
      EXPECT_NEAR(recursive.effective_samples(), 2000.0, 1e-9);
    }
  }
}

TEST(RecursiveRegression, RefusesRowsThatAreNotFiniteAndStaysAsItWas) {
  const RegressionData d = simulate_regression(8, Eigen::Vector3d(0.5, 1.0, -1.0), correlated_errors(3, 0.01)).data;
  RecursiveRegression recursive(d.parameter_names, {.error_covariance = d.error_covariance});
  feed(recursive, d);
  RecursiveRegression copy = recursive;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::array<double, 4>> bad{
      {nan, 1, 1, 1}, {1, inf, 1, 1}, {1, 1, -inf, 1}, {1, 1, 1, nan}, {1, 1e200, 1, 1}};
  for (const auto& row : bad) {
    const auto result = recursive.update(std::span(row.data(), 3), row[3]);
    EXPECT_FALSE(result.accepted);
    EXPECT_TRUE(std::isnan(result.innovation));
  }
  EXPECT_EQ(recursive.refused(), bad.size());
  EXPECT_EQ(recursive.theta(), copy.theta());
  EXPECT_EQ(recursive.covariance(), copy.covariance());
  EXPECT_EQ(recursive.effective_samples(), copy.effective_samples());
}

TEST(RecursiveRegression, CoversTheTruthAndPredictsItsInnovation) {
  // White errors, forgetting: 95 % intervals hold the truth and innovations over their sigma have unit variance.
  const Eigen::Vector3d truth(0.2, 1.0, -0.5);
  const Eigen::MatrixXd W = correlated_errors(3, 0.3);
  int held = 0, white_held = 0, all = 0;
  double squares = 0.0, count = 0.0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    const RegressionData d = simulate_regression(100 + seed, truth, W, {.rows = 3000, .regressor_rho = 0.5}).data;
    RecursiveOptions options{.method = Method::kGtls, .error_covariance = W};
    options.forgetting.lambda = 0.9985;
    RecursiveRegression recursive(d.parameter_names, options);
    for (Eigen::Index k = 0; k < d.rows(); ++k) {
      const auto u = recursive.update(std::span(d.regressors.row(k).data(), 3), d.regressand(k));
      if (k < 1000) continue;
      squares += std::pow(u.innovation / u.innovation_sigma, 2);
      count += 1.0;
    }
    const RegressionEstimate e = recursive.estimate();
    for (Eigen::Index i = 0; i < 3; ++i) {
      held += truth(i) > e.parameters[static_cast<std::size_t>(i)].low95 &&
              truth(i) < e.parameters[static_cast<std::size_t>(i)].high95;
      white_held += std::abs(truth(i) - e.theta(i)) < 1.96 * std::sqrt(e.covariance_white(i, i));
      ++all;
    }
  }
  // 450 draws at 0.95 (parameters of a run are correlated): three standard errors are 0.03 to 0.05.
  EXPECT_NEAR(static_cast<double>(held) / all, 0.95, 0.04);
  EXPECT_NEAR(static_cast<double>(white_held) / all, 0.95, 0.04);
  EXPECT_NEAR(squares / count, 1.0, 0.02);
}

TEST(RecursiveRegression, CoversTheTruthWhenTheResidualIsColoured) {
  const Eigen::Vector3d truth(0.2, 1.0, -0.5);
  Eigen::MatrixXd W = correlated_errors(3, 0.05);
  int held = 0, white_held = 0, all = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    const RegressionData d =
        simulate_regression(900 + seed, truth, W, {.rows = 4000, .regressor_rho = 0.95, .error_rho = 0.9}).data;
    RecursiveOptions options{.method = Method::kGtls, .error_covariance = W};
    options.forgetting.lambda = 1.0;
    RecursiveRegression recursive(d.parameter_names, options);
    feed(recursive, d);
    const RegressionEstimate e = recursive.estimate();
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Parameter& p = e.parameters[static_cast<std::size_t>(i)];
      held += truth(i) > p.low95 && truth(i) < p.high95;
      white_held += std::abs(truth(i) - p.value) < 1.96 * p.sigma_white;
      ++all;
    }
  }
  EXPECT_NEAR(static_cast<double>(held) / all, 0.95, 0.045);
  EXPECT_LT(static_cast<double>(white_held) / all, 0.75);
}

// 100 Hz; theta changes at 60 s; regressors swing all the time, or with `quiet` the second one stops from 30 to 90 s.
struct Flight {
  static constexpr double kChange_s = 60.0;
  explicit Flight(unsigned seed, bool quiet) : generator(seed), stops(quiet) {}
  std::array<double, 4> row(double t) {
    std::array<double, 3> x{1.0, std::sin(2.0 * t) + 0.5 * std::sin(5.3 * t + 1.0), std::sin(3.1 * t + 0.4)};
    if (stops && t > 30.0 && t < 90.0) x[2] = 0.0;
    const double theta1 = t < kChange_s ? -1.0 : -0.6;
    std::array<double, 4> r{1.0, x[1], x[2], 0.1 + theta1 * x[1] + 0.5 * x[2]};
    for (std::size_t j = 1; j < 4; ++j) r[j] += 0.05 * normal(generator);
    return r;
  }
  std::mt19937_64 generator;
  std::normal_distribution<double> normal;
  bool stops;
};

RecursiveOptions flight_options(Method method, bool variable) {
  RecursiveOptions options{.method = method, .error_covariance = 0.0025 * Eigen::MatrixXd::Identity(4, 4)};
  options.error_covariance(0, 0) = 0.0;
  options.forgetting.variable = variable;
  return options;
}

// Time after the change from which theta1 stays within 5 % of its new value [s].
double settling_time(RecursiveRegression& recursive, unsigned seed, double end_s) {
  Flight flight(seed, false);
  double outside = Flight::kChange_s;
  for (int k = 0; k * 0.01 < end_s; ++k) {
    const auto r = flight.row(k * 0.01);
    recursive.update(std::span(r.data(), 3), r[3]);
    if (k * 0.01 > Flight::kChange_s && std::abs(recursive.theta()(1) + 0.6) > 0.05 * 0.6) outside = k * 0.01;
  }
  return outside - Flight::kChange_s;
}

TEST(RecursiveRegression, ReachesFivePercentAtLeastFiveTimesSoonerWithVariableForgetting) {
  for (const Method method : {Method::kOls, Method::kGtls, Method::kPcaGtls}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      RecursiveRegression constant({"a", "b", "c"}, flight_options(method, false));
      RecursiveRegression variable({"a", "b", "c"}, flight_options(method, true));
      const double slow = settling_time(constant, seed, 220.0), fast = settling_time(variable, seed, 220.0);
      EXPECT_GT(slow, 5.0 * fast) << to_string(method) << " seed " << seed << ": " << slow << " s against " << fast;
      EXPECT_LT(fast, 10.0);
    }
  }
}

TEST(RecursiveRegression, HoldsWhatIsNotExcitedAndSaysSo) {
  Flight flight(4, true);
  RecursiveOptions options = flight_options(Method::kPcaGtls, true);
  options.forgetting.lambda = 0.998;
  RecursiveRegression recursive({"a", "b", "c"}, options);
  double held = 0.0;
  for (int k = 0; k < 12000; ++k) {
    const double t = k * 0.01;
    const auto r = flight.row(t);
    recursive.update(std::span(r.data(), 3), r[3]);
    if (k == 2900) {
      EXPECT_EQ(recursive.excited_directions(), 3);
      EXPECT_NEAR(recursive.theta()(2), 0.5, 0.05);
      EXPECT_EQ(recursive.status(2), ParameterStatus::kIdentified);
    }
    if (k == 5500) held = recursive.theta()(2);
    if (k == 8900) {
      // 34 s, an abrupt change of another parameter and its forgetting later.
      EXPECT_EQ(recursive.excited_directions(), 2);
      EXPECT_EQ(recursive.unexcited_text(), "c");
      EXPECT_EQ(recursive.status(2), ParameterStatus::kNotExcited);
      EXPECT_GT(recursive.sigma()(2), 5.0);
      EXPECT_LT(recursive.sigma()(1), 0.05);
      EXPECT_NEAR(recursive.theta()(2), held, 0.02);
      EXPECT_NEAR(recursive.theta()(2), 0.5, 0.06);
      EXPECT_NEAR(recursive.theta()(1), -0.6, 0.03);
    }
  }
  EXPECT_EQ(recursive.excited_directions(), 3);
  EXPECT_EQ(recursive.status(2), ParameterStatus::kIdentified);
  EXPECT_NEAR(recursive.theta()(2), 0.5, 0.03);
}

TEST(RecursiveRegression, HoldsThePriorOfExactRegressorsThatAreDependent) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  RecursiveOptions options{.error_covariance = Eigen::MatrixXd::Zero(4, 4), .prior = Eigen::Vector3d(0.0, 0.0, 0.0)};
  options.error_covariance(2, 2) = options.error_covariance(3, 3) = 0.01;
  RecursiveRegression recursive({"constant", "deflection", "alpha"}, options);
  RecursiveOptions least = options;
  least.method = Method::kGtls;
  RecursiveRegression gtls({"constant", "deflection", "alpha"}, least);
  for (int k = 0; k < 500; ++k) {
    const double alpha = normal(generator);
    const std::array<double, 3> x{1.0, 0.5, alpha + 0.1 * normal(generator)};
    const double z = 1.0 + 2.0 * alpha + 0.1 * normal(generator);
    recursive.update(x, z);
    gtls.update(x, z);
  }
  // Nearest to 0 on theta0 + theta1/2 = 1: (0.8, 0.4).
  EXPECT_NEAR(recursive.theta()(0), 0.8, 0.02);
  EXPECT_NEAR(recursive.theta()(1), 0.4, 0.02);
  EXPECT_NEAR(recursive.theta()(2), 2.0, 0.03);
  EXPECT_EQ(recursive.excited_directions(), 2);
  EXPECT_EQ(gtls.termination(), EstimateTermination::kRankDeficient);
  EXPECT_TRUE(std::isinf(gtls.sigma()(0)));
  // The deflection moves: all is determined.
  for (int k = 0; k < 500; ++k) {
    const double alpha = normal(generator), de = normal(generator);
    recursive.update(std::array{1.0, de, alpha + 0.1 * normal(generator)},
                     0.5 + de + 2.0 * alpha + 0.1 * normal(generator));
  }
  EXPECT_EQ(recursive.excited_directions(), 3);
  EXPECT_NEAR(recursive.theta()(0), 0.5, 0.03);
  EXPECT_NEAR(recursive.theta()(1), 1.0, 0.03);
}

TEST(RecursiveRegression, PinsWhatThePriorWeightPins) {
  auto simulated = simulate_regression(9, Eigen::Vector3d(0.5, 1.0, -1.0), correlated_errors(3, 0.02));
  const RegressionData& d = simulated.data;
  const Eigen::Vector3d prior(0.0, 0.0, -0.9), weight(1.0, 1.0, std::numeric_limits<double>::infinity());
  RecursiveOptions options{.error_covariance = d.error_covariance,
                           .prior = prior,
                           .prior_weight = weight,
                           .covariance = CovarianceKind::kWhite};
  options.forgetting.lambda = 1.0;
  RecursiveRegression recursive(d.parameter_names, options);
  feed(recursive, d);
  const RegressionEstimate batch =
      estimate(d, Method::kPcaGtls, {.covariance = CovarianceKind::kWhite, .prior = prior, .prior_weight = weight});
  EXPECT_EQ(recursive.theta()(2), -0.9);
  EXPECT_EQ(recursive.status(2), ParameterStatus::kFixed);
  EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits);
  EXPECT_LT(relative(recursive.covariance(), batch.covariance), kLastDigits);
}

TEST(RecursiveRegression, SurvivesFlightsThatBreakThings) {
  // No NaN in what a user sees, whatever comes: zero, constant, huge and tiny rows.
  std::mt19937_64 generator(12);
  std::normal_distribution<double> normal;
  for (const Method method : {Method::kOls, Method::kGtls, Method::kPcaGtls}) {
    RecursiveRegression recursive({"a", "b", "c"}, flight_options(method, true));
    for (int k = 0; k < 6000; ++k) {
      const double size = std::array{1.0, 0.0, 1e140, 1e-140, 1.0, 1e3}[static_cast<std::size_t>(k / 1000)];
      const std::array<double, 3> x{size, size * normal(generator), k % 2000 < 500 ? size : size * normal(generator)};
      recursive.update(x, size * normal(generator));
      for (Eigen::Index i = 0; i < 3; ++i) {
        ASSERT_TRUE(std::isfinite(recursive.theta()(i))) << to_string(method) << k;
        ASSERT_FALSE(std::isnan(recursive.sigma()(i))) << to_string(method) << k;
      }
    }
  }
}

TEST(RecursiveRegression, SaysWhatIsWrongWithItsOptions) {
  const auto message = [](const RecursiveOptions& options, std::size_t n = 2) -> std::string {
    try {
      RecursiveRegression recursive(n == 2 ? std::vector<std::string>{"a", "b"} : std::vector<std::string>(n, "a"),
                                    options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({.method = Method::kTls}),
            "recursive.method: is TLS; must be OLS, GTLS (TLS is GTLS with its identity W) or PCA-GTLS");
  EXPECT_EQ(message({}), "recursive.error_covariance: is missing; PCA-GTLS needs it (OLS does not)");
  EXPECT_EQ(message({}, 9), "recursive: 9 parameters; must be 1 to 8 (the batch estimators have no limit)");
  EXPECT_EQ(message({.method = Method::kOls, .forgetting = {.lambda = 1.5}}),
            "forgetting.lambda: is 1.5; must be in (0, 1]");
  RecursiveRegression fine({"a", "b"}, {.method = Method::kOls});
  EXPECT_THROW(fine.start(Eigen::Vector2d(0, 0), -Eigen::Matrix2d::Identity()), InputError);
  EXPECT_THROW(fine.start(Eigen::Vector3d(0, 0, 0), Eigen::Matrix3d::Identity()), InputError);
}

}  // namespace
}  // namespace veridyn::estimation
