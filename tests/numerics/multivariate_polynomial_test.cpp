#include "veridyn/numerics/multivariate_polynomial.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

MultivariatePolynomial random_polynomial(int arguments, int order, RandomStream& random) {
  std::vector<double> c(MultivariatePolynomial::terms(arguments, order));
  for (double& x : c) x = random.normal();
  return {arguments, order, c};
}

// The documentation's example of three arguments and order 3.
TEST(MultivariatePolynomial, HasItsTermsInTheOrderOfOpenSim) {
  const std::vector<MultivariatePolynomial::Powers> powers = MultivariatePolynomial::powers(3, 3);
  ASSERT_EQ(powers.size(), 20U);
  ASSERT_EQ(MultivariatePolynomial::terms(3, 3), 20U);
  const auto is = [&](std::size_t term, int x, int y, int z) {
    return powers[term][0] == x && powers[term][1] == y && powers[term][2] == z;
  };
  EXPECT_TRUE(is(0, 0, 0, 0) && is(1, 0, 0, 1) && is(2, 0, 0, 2) && is(3, 0, 0, 3) && is(4, 0, 1, 0));
  EXPECT_TRUE(is(5, 0, 1, 1) && is(6, 0, 1, 2) && is(7, 0, 2, 0) && is(8, 0, 2, 1) && is(9, 0, 3, 0));
  EXPECT_TRUE(is(10, 1, 0, 0) && is(11, 1, 0, 1) && is(19, 3, 0, 0));
}

TEST(MultivariatePolynomial, HasTheDocumentedValueAndDerivatives) {
  const MultivariatePolynomial p(2, 2, {1.0, 2.0, 3.0, 4.0, 5.0, 6.0});
  const double at[2] = {2.0, 3.0};
  double gradient[2], hessian[4];
  EXPECT_EQ(p.value(at), 96.0);
  EXPECT_EQ(p.evaluate(at, gradient), 96.0);
  EXPECT_EQ(gradient[0], 4.0 + 5.0 * 3.0 + 12.0 * 2.0);
  EXPECT_EQ(gradient[1], 2.0 + 6.0 * 3.0 + 5.0 * 2.0);
  EXPECT_EQ(p.evaluate(at, gradient, hessian), 96.0);
  EXPECT_EQ(hessian[0], 12.0);
  EXPECT_EQ(hessian[1], 5.0);
  EXPECT_EQ(hessian[2], 5.0);
  EXPECT_EQ(hessian[3], 6.0);
  EXPECT_EQ(p.scaled(0.5).value(at), 48.0);
}

// Against the sum over all terms, and automatic derivatives of the value and of the gradient.
TEST(MultivariatePolynomial, AgreesWithTheSumOfItsTermsAndWithAutomaticDerivatives) {
  using Jet = ceres::Jet<double, 6>;
  RandomStream random(3, "polynomials");
  for (int n = 0; n <= 6; ++n) {
    for (const int order : {0, 1, 2, 5, 9}) {
      if (n == 6 && order > 5) continue;
      SCOPED_TRACE(testing::Message() << n << " arguments, order " << order);
      const MultivariatePolynomial p = random_polynomial(n, order, random);
      const std::vector<MultivariatePolynomial::Powers> powers = MultivariatePolynomial::powers(n, order);
      std::array<double, 6> x{};
      std::array<Jet, 6> jets;
      for (int k = 0; k < n; ++k) {
        x[k] = random.uniform(-1.2, 1.2);
        jets[k] = Jet(x[k], k);
      }
      double expected = 0.0, size = 0.0;
      for (std::size_t t = 0; t < powers.size(); ++t) {
        double term = p.coefficients()[t];
        for (int k = 0; k < n; ++k) term *= std::pow(x[k], powers[t][k]);
        expected += term;
        size += std::abs(term);
      }
      std::array<double, 6> gradient{}, again{};
      std::array<double, 36> hessian{};
      std::array<Jet, 6> gradient_jets;
      const double rounding = 1e-13 * (1.0 + size) * 81.0;
      EXPECT_NEAR(p.value(x.data()), expected, rounding);
      EXPECT_NEAR(p.evaluate(x.data(), gradient.data()), expected, rounding);
      EXPECT_NEAR(p.evaluate(x.data(), again.data(), hessian.data()), expected, rounding);
      const Jet value = p.value(jets.data());
      static_cast<void>(p.evaluate(jets.data(), gradient_jets.data()));
      for (int k = 0; k < n; ++k) {
        EXPECT_NEAR(gradient[k], value.v(k), rounding);
        EXPECT_NEAR(again[k], value.v(k), rounding);
        for (int l = 0; l < n; ++l) EXPECT_NEAR(hessian[k * n + l], gradient_jets[k].v(l), rounding) << k << " " << l;
      }
    }
  }
}

}  // namespace
}  // namespace veridyn::numerics
