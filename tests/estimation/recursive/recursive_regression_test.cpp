#include "veridyn/estimation/recursive/recursive_regression.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

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
