#include "veridyn/estimation/regression/augmented_qr.hpp"

#include <random>

#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace {
using namespace veridyn::estimation;

Eigen::MatrixXd positive_rows(Eigen::MatrixXd R) {
  for (Eigen::Index i = 0; i < R.rows(); ++i) {
    if (R(i, i) < 0.0) R.row(i) *= -1.0;
  }
  return R;
}

TEST(AugmentedQr, EqualsTheTriangleOfTheWholeMatrixWhateverTheBlocks) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  const RowMatrix D = RowMatrix::NullaryExpr(1003, 7, [&]() { return normal(generator); });
  const Eigen::MatrixXd expected = positive_rows(veridyn::numerics::HouseholderQr(D).R());
  for (const Eigen::Index block : {1, 5, 64, 512, 5000}) {
    AugmentedQr qr(7, block);
    qr.append(D.topRows(400));
    qr.append(D.bottomRows(603));
    EXPECT_EQ(qr.rows(), 1003.0);
    EXPECT_LT((positive_rows(qr.triangle()) - expected).norm(), 1e-13 * expected.norm()) << "block " << block;
  }
}

// Laeuchli's matrix: X'X loses 1 + eps^2 to rounding, a QR does not.
TEST(AugmentedQr, KeepsTheDigitsThatNormalEquationsLose) {
  const double eps = 1e-9;
  RowMatrix D(4, 3);
  D << 1, 1, 1, eps, 0, 0, 0, eps, 0, 0, 0, eps;
  const Eigen::MatrixXd R = positive_rows([&] {
    AugmentedQr qr(3, 2);
    qr.append(D);
    return qr.triangle();
  }());
  // Closed form by Gram-Schmidt: |second column minus its projection| = eps sqrt((2 + eps^2)/(1 + eps^2)) = sqrt(2)
  // eps, third sqrt(3/2) eps.
  EXPECT_NEAR(R(1, 1) / eps, std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(R(2, 2) / eps, std::sqrt(1.5), 1e-6);
}

TEST(AugmentedQr, ForgettingWeightsSquares) {
  const RowMatrix D = RowMatrix::Random(60, 3);
  AugmentedQr qr(3, 16);
  qr.append(D.topRows(40));
  qr.scale(std::sqrt(0.25));
  qr.append(D.bottomRows(20));
  const Eigen::MatrixXd expected =
      0.25 * D.topRows(40).transpose() * D.topRows(40) + D.bottomRows(20).transpose() * D.bottomRows(20);
  const Eigen::MatrixXd R = qr.triangle();
  EXPECT_LT((R.transpose() * R - expected).norm(), 1e-13 * expected.norm());
  EXPECT_DOUBLE_EQ(qr.rows(), 30.0);
}

TEST(AugmentedQr, DividesRowsByTheirScale) {
  RegressionData data;
  data.regressors = RowMatrix::Random(50, 2);
  data.regressand = Eigen::VectorXd::Random(50);
  data.row_scale = Eigen::VectorXd::LinSpaced(50, 0.5, 2.0);
  const Eigen::MatrixXd R = triangle_of(data);
  Eigen::MatrixXd D(50, 3);
  D << data.regressors, data.regressand;
  D = (data.row_scale.cwiseInverse().asDiagonal() * D).eval();
  EXPECT_LT((R.transpose() * R - D.transpose() * D).norm(), 1e-12);
}

}  // namespace
