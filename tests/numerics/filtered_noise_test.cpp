#include "veridyn/numerics/filtered_noise.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

// x = 2 h a - 3 h' b, y = h'' b, z = h a + h b: each entry in closed form from the taps.
TEST(FilteredNoise, IsTheSumOverTaps) {
  const ModulatingKernel kernel = modulating_kernel(100.0, 5.0);
  const std::array<double, 3> variances{0.5, 2.0, 0.0};
  FilteredNoise noise(3, variances, kernel.smooth.taps.size());
  noise.add(0, 0, 2.0, kernel.smooth);
  noise.add(0, 1, -3.0, kernel.first);
  noise.add(1, 1, 1.0, kernel.second);
  noise.add(1, 2, 1e6, kernel.second);  // a source without noise
  noise.add(2, 0, 0.25, kernel.smooth);
  noise.add(2, 0, 0.75, kernel.smooth);
  noise.add(2, 1, 1.0, kernel.smooth);
  const auto product = [](const FirKernel& a, const FirKernel& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.taps.size(); ++i) sum += a.taps[i] * b.taps[i];
    return sum;
  };
  const FirKernel &h = kernel.smooth, &d = kernel.first, &dd = kernel.second;
  const Eigen::MatrixXd W = noise.covariance();
  EXPECT_NEAR(W(0, 0), 0.5 * 4.0 * h.noise_gain() + 2.0 * 9.0 * d.noise_gain(), 1e-9 * W(0, 0));
  EXPECT_NEAR(W(1, 1), 2.0 * dd.noise_gain(), 1e-9 * W(1, 1));
  EXPECT_NEAR(W(2, 2), 2.5 * h.noise_gain(), 1e-9 * W(2, 2));
  EXPECT_NEAR(W(0, 2), 0.5 * 2.0 * h.noise_gain() - 2.0 * 3.0 * product(d, h), 1e-9 * W(2, 2));
  EXPECT_NEAR(W(1, 2), 2.0 * product(dd, h), 1e-9 * std::abs(W(1, 2)));
  EXPECT_EQ((W - W.transpose()).norm(), 0.0);
}

// What the filters of the library make of white noise has that covariance.
TEST(FilteredNoise, IsWhatFiltersLeaveOfNoise) {
  const ModulatingKernel kernel = modulating_kernel(100.0, 5.0);
  const std::array<double, 1> variances{4.0};
  FilteredNoise noise(2, variances, kernel.smooth.taps.size());
  noise.add(0, 0, 1.0, kernel.smooth);
  noise.add(1, 0, 0.1, kernel.second);
  const Eigen::MatrixXd W = noise.covariance();
  RandomStream random(1, "noise");
  std::vector<double> x(200'000);
  for (double& value : x) value = 2.0 * random.normal();
  const std::vector<double> smooth = filter(x, kernel.smooth), second = filter(x, kernel.second);
  Eigen::Matrix2d S = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Eigen::Vector2d v(smooth[k], 0.1 * second[k]);
    S += v * v.transpose() / static_cast<double>(x.size());
  }
  // About 200000/20 independent samples: 1.4 % of a variance is one standard deviation.
  for (Eigen::Index i = 0; i < 2; ++i)
    for (Eigen::Index j = 0; j < 2; ++j) EXPECT_NEAR(S(i, j) / W(i, j), 1.0, 0.06) << i << j;
}

}  // namespace
}  // namespace veridyn::numerics
