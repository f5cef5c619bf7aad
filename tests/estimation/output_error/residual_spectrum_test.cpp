#include "veridyn/estimation/output_error/residual_spectrum.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/estimation/simulated_regression.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using testing_support::correlated_noise;

TEST(ResidualSpectrum, ItsSumIsTheDoubleSumOverLags) {
  // Against the double sum written out, two outputs with cross-correlation.
  std::mt19937_64 generator(9);
  RowMatrix w(400, 2);
  w.col(0) = correlated_noise(generator, 400, 0.6);
  w.col(1).tail(398) = (0.6 * w.col(0).head(398) + 0.8 * correlated_noise(generator, 398, 0.3)).eval();
  w.col(1).head(2).setZero();
  const ResidualSpectrum spectrum = residual_spectrum({w}, 20);
  ASSERT_GT(spectrum.window, 0);
  const Index m = 2 * spectrum.window;
  const auto gamma = [&](Index a, Index b, Index lag) {  // E[w_a(k + lag) w_b(k)]
    double sum = 0.0;
    for (Index k = 0; k < 400; ++k)
      if (k + lag >= 0 && k + lag < 400) sum += w(k + lag, a) * w(k, b);
    const double weight =
        std::min(1.0, 2.0 - static_cast<double>(std::abs(lag)) / static_cast<double>(spectrum.window));
    return (lag == 0 ? 1.0 : weight) * sum / 400.0;
  };
  RowMatrix S(2 * 60, 3);
  for (Index j = 0; j < 3; ++j) S.col(j) = correlated_noise(generator, 120, 0.5);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 3);
  for (Index i = 0; i < 60; ++i) {
    for (Index j = 0; j < 60; ++j) {
      if (std::abs(i - j) >= m) continue;
      for (Index a = 0; a < 2; ++a)
        for (Index b = 0; b < 2; ++b) expected += S.row(2 * i + a).transpose() * gamma(a, b, i - j) * S.row(2 * j + b);
    }
  }
  EXPECT_LT((autocorrelated_information(spectrum, S, 2) - expected).norm(), 1e-10 * expected.norm());
}

}  // namespace
}  // namespace veridyn::estimation
