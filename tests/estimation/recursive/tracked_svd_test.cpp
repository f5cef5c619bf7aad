#include "veridyn/estimation/recursive/tracked_svd.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "veridyn/estimation/recursive/recursive_total_least_squares.hpp"
#include "veridyn/numerics/linear_algebra/singular_values.hpp"

namespace veridyn::estimation {
namespace {

double orthogonality_error(const SmallMatrix& V) {
  return (V.transpose() * V - SmallMatrix::Identity(V.cols(), V.cols())).cwiseAbs().maxCoeff();
}

TEST(TrackedSvd, IsTheDecompositionByEigenOfRandomTriangles) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  for (int m = 1; m <= kMaxRecursiveColumns; ++m) {
    for (const double grading : {1.0, 1e-3}) {
      Eigen::MatrixXd R = Eigen::MatrixXd::Zero(m, m);
      std::array<double, 100> table{};
      for (int i = 0; i < m; ++i) {
        for (int j = i; j < m; ++j) table[10 * i + j] = R(i, j) = normal(generator) * std::pow(grading, i);
      }
      TrackedSvd tracked(m);
      tracked.update(table.data(), 10);
      const Eigen::VectorXd reference = numerics::singular_values(R, numerics::SingularVectors::kNone).values;
      for (int j = 0; j < m; ++j) {
        EXPECT_NEAR(tracked.singular_value(j), reference(j), 1e-11 * reference(j) + 1e-14 * reference(0));
      }
      EXPECT_LT(orthogonality_error(tracked.vectors()), 1e-13);
      const Eigen::MatrixXd B = R * tracked.vectors();
      const Eigen::MatrixXd G = B.transpose() * B;
      for (int i = 0; i < m; ++i) {
        for (int j = 0; j < i; ++j) {
          // The angle by which V is still off.
          EXPECT_LT(std::abs(G(i, j)), 1e-10 * std::abs(G(i, i) - G(j, j)) + 1e-14 * reference(0));
        }
      }
    }
  }
}

TEST(TrackedSvd, TakesDiagonalsOfAnySize) {
  std::array<double, 30> table{};
  table[0] = 1e-80;
  table[11] = 1.0;
  table[22] = 1e-40;
  TrackedSvd tracked(3);
  for (const double size : {1.0, 1e200, 1e-200}) {
    for (double& value : table) value *= size;
    tracked.update(table.data(), 10);
    EXPECT_NEAR(tracked.singular_value(0), table[11], 1e-15 * table[11]);
    for (double& value : table) value /= size;
  }
  EXPECT_LT(orthogonality_error(tracked.vectors()), 1e-15);
}

// One stream of a kind that breaks things, through the whole recursion. Orthogonality and finiteness are looked at all
// the way.
enum class Kind { kRandom, kRankOne, kConstant, kHuge, kTiny, kMixed, kZero };
void soak(Kind kind, std::uint64_t updates, double lambda) {
  constexpr int kColumns = 6;
  std::mt19937_64 generator(static_cast<unsigned>(kind) + 7);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd W = Eigen::MatrixXd::Identity(kColumns, kColumns);
  W(0, 0) = 0.0;
  RecursiveTotalLeastSquares data(W);
  std::array<double, kColumns> row{};
  double worst = 0.0;
  for (std::uint64_t k = 0; k < updates; ++k) {
    const double common = normal(generator);
    for (int j = 0; j < kColumns; ++j) {
      double value = 0.0;
      switch (kind) {
        case Kind::kRandom:
          value = normal(generator) * (j + 1);
          break;
        case Kind::kRankOne:
          value = common * (j + 1);
          break;
        case Kind::kConstant:
          value = 1.0 + j;
          break;
        case Kind::kHuge:
          value = 1e150 * std::clamp(normal(generator) / 6.0, -1.0, 1.0);
          break;
        case Kind::kTiny:
          value = 1e-150 * normal(generator);
          break;
        case Kind::kMixed:  // from row to row, and from column to column
          value = normal(generator) * ((k / 1000) % 3 == 0 ? 1e120 : 1.0) * (j % 2 == 0 ? 1e-30 : 1.0);
          break;
        case Kind::kZero:
          value = k < 100 ? normal(generator) : 0.0;
          break;
      }
      row[j] = value;
    }
    ASSERT_TRUE(data.append(row.data(), lambda)) << k;
    if (k % 97 == 0 || k + 200 > updates) {
      const double error = orthogonality_error(data.svd().vectors());
      ASSERT_TRUE(std::isfinite(error)) << k;  // NaN anywhere in V
      worst = std::max(worst, error);
      for (int j = 0; j < data.noisy_columns(); ++j) {
        ASSERT_TRUE(std::isfinite(data.singular_value(j))) << k;
        if (j > 0) {
          ASSERT_LE(data.singular_value(j), data.singular_value(j - 1)) << k;
        }
      }
      std::array<double, kColumns> b{};
      data.basis(data.noisy_columns() - 1, b.data());
      for (const double value : b) ASSERT_FALSE(std::isnan(value)) << k;
    }
  }
  EXPECT_LT(worst, 1e-12);
}

class TrackedSvdKeepsOrthogonal : public ::testing::TestWithParam<Kind> {};
TEST_P(TrackedSvdKeepsOrthogonal, OverAMillionUpdatesOfAllKindsTogether) {
  soak(GetParam(), 150000, 0.9997);
  soak(GetParam(), 20000, 1.0);
  soak(GetParam(), 5000, 0.5);
}
INSTANTIATE_TEST_SUITE_P(Kinds, TrackedSvdKeepsOrthogonal,
                         ::testing::Values(Kind::kRandom, Kind::kRankOne, Kind::kConstant, Kind::kHuge, Kind::kTiny,
                                           Kind::kMixed, Kind::kZero));

// 1e8 updates in all.
class TrackedSvdSoak : public ::testing::TestWithParam<Kind> {};
TEST_P(TrackedSvdSoak, KeepsOrthogonalOverAHundredMillionUpdates) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "long-running; set VERIDYN_SOAK=1 to run it";
  soak(GetParam(), 14300000, 0.9997);
}
INSTANTIATE_TEST_SUITE_P(Kinds, TrackedSvdSoak,
                         ::testing::Values(Kind::kRandom, Kind::kRankOne, Kind::kConstant, Kind::kHuge, Kind::kTiny,
                                           Kind::kMixed, Kind::kZero));

}  // namespace
}  // namespace veridyn::estimation
