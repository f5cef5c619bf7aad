#include "veridyn/estimation/output_error/correlated_noise_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/output_error/example_models.hpp"
#include "veridyn/estimation/output_error/autodiff_model.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::Column;
using testing_support::Table;

/// A level and slow waves, which correlated noise resembles.
class Waves final : public AutodiffModel<Waves> {
 public:
  Waves(Eigen::Index samples, std::size_t count) : samples_(samples) {
    for (std::size_t i = 0; i < count; ++i) parameters_.push_back({.name = "wave " + std::to_string(i)});
  }
  [[nodiscard]] std::span<const ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return 1; }
  [[nodiscard]] Eigen::Index samples(std::size_t) const override { return samples_; }
  [[nodiscard]] std::span<const ModelParameter> initial_conditions(std::size_t) const override { return {}; }
  template <typename Scalar>
  bool simulate(std::size_t, const Column<Scalar>& theta, Table<Scalar>& output) const {
    for (Eigen::Index k = 0; k < samples_; ++k) {
      output(k, 0) = Scalar(0.0);
      for (Eigen::Index i = 0; i < theta.size(); ++i) output(k, 0) += theta(i) * wave(k, i);
    }
    return true;
  }
  [[nodiscard]] double wave(Eigen::Index k, Eigen::Index i) const {
    return std::cos(kPi * static_cast<double>(i) * (static_cast<double>(k) + 0.5) / static_cast<double>(samples_));
  }

 private:
  Eigen::Index samples_;
  std::vector<ModelParameter> parameters_;
  std::vector<ModelOutput> outputs_{{"y", "m"}};
};

RowMatrix first_order_noise(Eigen::Index samples, double phi, double sigma, std::uint64_t seed) {
  numerics::RandomStream random(seed, "noise");
  RowMatrix noise(samples, 1);
  double value = random.normal();
  for (Eigen::Index k = 0; k < samples; ++k) {
    if (k > 0) value = phi * value + std::sqrt(1.0 - phi * phi) * random.normal();
    noise(k, 0) = sigma * value;
  }
  return noise;
}

OutputErrorOptions given(double sigma) {
  return {.noise = OutputNoise::kGiven,
          .noise_start = Eigen::VectorXd::Constant(1, sigma),
          .covariance = CovarianceKind::kWhite,
          .max_relaxations = 1};
}

// (S'R^-1 S)^-1 S'R^-1 z with R written out, a missing value and all: another formulation than the whitened model's.
TEST(CorrelatedNoiseModel, GivesTheEstimateAndErrorBarOfGeneralisedLeastSquares) {
  constexpr Eigen::Index n = 60, count = 3;
  constexpr double phi = 0.7, sigma = 0.2;
  const Waves model(n, count);
  RowMatrix measured = first_order_noise(n, phi, sigma, 1);
  std::vector<Eigen::Index> there;
  for (Eigen::Index k = 0; k < n; ++k) {
    measured(k, 0) += 1.0 - 0.5 * model.wave(k, 1);
    if (k == 20 || k == 21)
      measured(k, 0) = kNaN;
    else
      there.push_back(k);
  }
  const auto m = static_cast<Eigen::Index>(there.size());
  Eigen::MatrixXd R(m, m), S(m, count);
  Eigen::VectorXd z(m);
  for (Eigen::Index a = 0; a < m; ++a) {
    const Eigen::Index k = there[a];
    z(a) = measured(k, 0);
    for (Eigen::Index i = 0; i < count; ++i) S(a, i) = model.wave(k, i);
    for (Eigen::Index b = 0; b < m; ++b)
      R(a, b) = sigma * sigma * std::pow(phi, std::abs(static_cast<double>(k - there[b])));
  }
  const numerics::Cholesky root(R);
  const Eigen::MatrixXd P =
      numerics::Cholesky(S.transpose() * root.solve(S)).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(count, count)));
  const Eigen::VectorXd theta = P * S.transpose() * root.solve(z);
  const CorrelatedNoiseModel white(model, {measured}, Eigen::VectorXd::Constant(1, phi));
  const OutputErrorEstimate e = output_error(white, white.whitened(std::vector<RowMatrix>{measured}), given(sigma));
  ASSERT_TRUE(e.usable());
  for (Eigen::Index i = 0; i < count; ++i) {
    EXPECT_NEAR(e.theta(i), theta(i), 1e-8);
    EXPECT_NEAR(e.covariance_white(i, i), P(i, i), 1e-8 * P(i, i));
  }
  EXPECT_LT((white.restored(0, e.predicted[0]).row(0) - S.row(0) * theta).norm(), 1e-8);
  ModelResponse own;
  ASSERT_TRUE(model.respond(0, e.theta, {}, own));
  EXPECT_LT((white.restored(0, e.predicted[0]) - own.output).cwiseAbs().maxCoeff(), 1e-10);
}

// Ten waves take most of the slow part of the noise into the fit: the residual's own correlation is 0.29, its
// noise's 0.6.
TEST(NoiseCorrelation, IsNotTooSmallWhereManyUnknownsWereFitted) {
  constexpr double phi = 0.6, sigma = 0.1;
  constexpr int kRecordings = 40;
  const Waves model(80, 10);
  double mean = 0.0, residual = 0.0;
  for (int r = 0; r < kRecordings; ++r) {
    const std::vector<RowMatrix> measured{first_order_noise(80, phi, sigma, 10 + static_cast<std::uint64_t>(r))};
    const OutputErrorEstimate e = output_error(model, measured, given(sigma));
    const auto found = noise_correlation(model, measured, e, Eigen::VectorXd::Constant(1, sigma), 1);
    ASSERT_TRUE(found);
    mean += found->correlation(0) / kRecordings;
    residual += e.outputs[0].lag1 / kRecordings;
  }
  EXPECT_LT(residual, 0.45);
  // One recording's has a standard deviation of about sqrt((1 - phi^2)/70) = 0.1, the mean's of 0.015.
  EXPECT_NEAR(mean, phi, 0.05);
}

// Of white noise the gain is that of chance: half a point mass at zero, half chi-square with one degree of freedom.
TEST(NoiseCorrelation, OfWhiteNoiseIsRarelyLikelierThanNone) {
  const Waves model(120, 4);
  int likelier = 0;
  for (std::uint64_t r = 0; r < 200; ++r) {
    const std::vector<RowMatrix> measured{first_order_noise(120, 0.0, 0.1, 1000 + r)};
    const OutputErrorEstimate e = output_error(model, measured, given(0.1));
    const auto found = noise_correlation(model, measured, e, Eigen::VectorXd::Constant(1, 0.1), 1);
    ASSERT_TRUE(found);
    EXPECT_GE(found->gain, 0.0);
    likelier += found->gain > 3.84 ? 1 : 0;
  }
  // 2.5 % of 200, and the chance about it: below 13 in 99.9 % of such trials.
  EXPECT_LE(likelier, 13);
}

}  // namespace
}  // namespace veridyn::estimation
