// Counts calls of operator new, hence in a file of its own: `update` and what a display reads must not call it.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/counting_new.hpp"
#include "veridyn/estimation/recursive/change_detection.hpp"
#include "veridyn/estimation/recursive/recursive_regression.hpp"

namespace veridyn::estimation {
namespace {

TEST(RecursiveRegression, DoesNotAllocateInAnUpdateNorForItsErrorBars) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  for (const Method method : {Method::kOls, Method::kGtls, Method::kPcaGtls}) {
    for (const bool moves : {true, false}) {  // without: dependent and unexcited columns, the slow ways
      RecursiveOptions options{.method = method, .error_covariance = 0.01 * Eigen::MatrixXd::Identity(8, 8)};
      options.error_covariance(0, 0) = options.error_covariance(1, 1) = 0.0;
      options.error_covariance(3, 4) = options.error_covariance(4, 3) = 0.005;
      options.forgetting.variable = true;
      RecursiveRegression recursive({"a", "b", "c", "d", "e", "f", "g"}, options);
      ChangeDetector detector({});
      std::array<double, 7> x{};
      double sum = 0.0;
      const long before = allocations;
      for (int k = 0; k < 2000; ++k) {
        for (double& value : x) value = normal(generator);
        x[0] = 1.0;
        if (!moves) x[1] = x[2] = 2.0;
        const auto u = recursive.update(x, x[3] - x[4] + 0.1 * normal(generator));
        sum += recursive.theta()(0) + recursive.sigma()(1) + recursive.covariance_white()(0, 0) +
               recursive.singular_values().sum() + recursive.unexcited_share()(0) +
               static_cast<double>(recursive.unexcited().cols()) + recursive.residual_sd();
        if (detector.update(0.01 * k, u.innovation / u.innovation_sigma)) sum += 1.0;
      }
      EXPECT_EQ(allocations, before) << to_string(method);
      EXPECT_NE(sum, 0.0);
    }
  }
}

}  // namespace
}  // namespace veridyn::estimation
