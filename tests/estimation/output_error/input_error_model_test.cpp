#include "veridyn/estimation/output_error/input_error_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "veridyn/estimation/output_error/autodiff_model.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

RowMatrix normal_matrix(Eigen::Index rows, Eigen::Index cols, std::uint64_t seed) {
  numerics::RandomStream random(seed, "matrix");
  RowMatrix m(rows, cols);
  for (double& value : m.reshaped()) value = random.normal();
  return m;
}

// R^-1/2 R R^-1/2 is the identity, R being put together from its definition.
TEST(ErrorWhitening, MakesResidualsIndependentOfStandardDeviationOne) {
  const RowMatrix H = normal_matrix(24, 5, 1);
  const Eigen::VectorXd sigma = (Eigen::VectorXd(2) << 0.3, 2.0).finished();
  const ErrorWhitening whitening(H, sigma, RowMatrix::Zero(12, 2));
  RowMatrix R = H * H.transpose();
  for (Eigen::Index i = 0; i < 24; ++i) R(i, i) += sigma(i % 2) * sigma(i % 2);
  RowMatrix root = RowMatrix::Identity(24, 24);
  whitening.apply(root);
  EXPECT_LT((root * R * root.transpose() - RowMatrix::Identity(24, 24)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(ErrorWhitening, LeavesMissingValuesOut) {
  RowMatrix measured = RowMatrix::Zero(6, 1);
  measured(2, 0) = std::nan("");
  const RowMatrix H = normal_matrix(6, 3, 2);
  const Eigen::VectorXd sigma = Eigen::VectorXd::Constant(1, 0.5);
  RowMatrix with = RowMatrix::Ones(6, 1), other = with;
  other(2, 0) = 100.0;
  const ErrorWhitening whitening(H, sigma, measured);
  whitening.apply(with);
  whitening.apply(other);
  for (const Eigen::Index k : {0, 1, 3, 4, 5}) EXPECT_DOUBLE_EQ(with(k, 0), other(k, 0));
}

/// y = a f(k), whose recorded input f has an error that is alike over ten samples.
class Gain final : public AutodiffModel<Gain> {
 public:
  explicit Gain(Eigen::VectorXd input) : input_(std::move(input)) {}
  [[nodiscard]] std::span<const ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return 1; }
  [[nodiscard]] Eigen::Index samples(std::size_t) const override { return input_.size(); }
  [[nodiscard]] std::span<const ModelParameter> initial_conditions(std::size_t) const override { return {}; }
  template <typename Scalar>
  bool simulate(std::size_t, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
                Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const {
    for (Eigen::Index k = 0; k < input_.size(); ++k) output(k, 0) = theta(0) * input_(k);
    return true;
  }

 private:
  Eigen::VectorXd input_;
  std::vector<ModelParameter> parameters_{{.name = "gain", .start = 1.0}};
  std::vector<ModelOutput> outputs_{{"y", "1"}};
};

// The textbook's generalised least squares, (f'R^-1 f)^-1, by another formulation than the whitened model's.
TEST(InputErrorModel, GivesTheEstimateAndErrorBarOfGeneralisedLeastSquares) {
  constexpr Eigen::Index n = 100;
  Eigen::VectorXd f(n);
  for (Eigen::Index k = 0; k < n; ++k) f(k) = 1.0 + 0.8 * std::sin(0.07 * static_cast<double>(k));
  RowMatrix H = RowMatrix::Zero(n, 10);
  for (Eigen::Index k = 0; k < n; ++k) H(k, k / 10) = 0.2 * f(k);
  const Eigen::VectorXd sigma = Eigen::VectorXd::Constant(1, 0.05);
  const RowMatrix noise = normal_matrix(n, 1, 3), errors = normal_matrix(10, 1, 4);
  const RowMatrix measured = 2.0 * f + H * errors + 0.05 * noise;
  const Gain model(f);
  const InputErrorModel whitened(model, {ErrorWhitening(H, sigma, measured)});
  OutputErrorOptions options{
      .noise = OutputNoise::kGiven, .noise_start = Eigen::VectorXd::Ones(1), .covariance = CovarianceKind::kWhite};
  const OutputErrorEstimate estimate = output_error(whitened, {whitened.whitened(0, measured)}, options);
  ASSERT_TRUE(estimate.usable());
  Eigen::MatrixXd R = H * H.transpose();
  R.diagonal().array() += sigma(0) * sigma(0);
  const Eigen::VectorXd weighted = R.llt().solve(f);
  const double variance = 1.0 / f.dot(weighted);
  EXPECT_NEAR(estimate.theta(0), variance * weighted.dot(measured.col(0)), 1e-8);
  EXPECT_NEAR(estimate.parameters[0].sigma, std::sqrt(variance), 1e-8);
  // White noise of the residual's size would have said six times less.
  EXPECT_GT(estimate.parameters[0].sigma, 3.0 * 0.05 / f.norm());
}

}  // namespace
}  // namespace veridyn::estimation
