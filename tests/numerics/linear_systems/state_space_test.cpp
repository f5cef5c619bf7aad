#include "veridyn/numerics/linear_systems/state_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"

namespace veridyn::numerics {
namespace {

double difference(const StateSpace& s, const TransferFunction& t) {
  double largest = 0.0;
  for (const double w : {0.0, 0.01, 0.3, 1.0, 7.0, 200.0})
    largest =
        std::max(largest, std::abs(s.response(w)(0, 0) - t.response(w)) / std::max(1e-3, std::abs(t.response(w))));
  return largest;
}

TEST(StateSpace, RealisesTransferFunctions) {
  const TransferFunction gain{{3.0}, {2.0}};
  EXPECT_EQ(realise(gain).states(), 0);
  EXPECT_LT(difference(realise(gain), gain), 1e-15);
  // Poles four decades apart, and one that is three times the same.
  for (const TransferFunction& t :
       {low_pass(0.01) * low_pass(100.0), high_pass(0.8, 1.0) * high_pass(0.2), 2.0 * low_pass(5.0),
        TransferFunction{{1.0, 2.0}, {4.0, 3.0, 2.0, 1.0}}, high_pass(2.0, 0.3) + low_pass(0.5)}) {
    EXPECT_LT(difference(realise(t), t), 1e-12);
  }
}

StateSpace with_two_outputs(StateSpace s) {
  s.C = s.C.replicate(2, 1).eval();
  s.D = s.D.replicate(2, 1).eval();
  return s;
}

TEST(StateSpace, PolesAreThoseOfTheDenominator) {
  const Eigen::VectorXcd poles = general_eigenvalues(realise(low_pass(3.0) * low_pass(2.0, 0.6)).A);
  ASSERT_EQ(poles.size(), 3);
  std::vector<double> real(3), imaginary(3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    real[i] = poles(i).real();
    imaginary[i] = poles(i).imag();
  }
  std::ranges::sort(real);
  std::ranges::sort(imaginary);
  EXPECT_NEAR(real[0], -3.0, 1e-12);
  EXPECT_NEAR(real[1], -1.2, 1e-12);
  EXPECT_NEAR(imaginary[2], 1.6, 1e-12);
  EXPECT_NEAR(imaginary[0], -1.6, 1e-12);
}

TEST(StateSpace, AnIntegratorHasItsPoleAtZero) {
  const TransferFunction t = TransferFunction{{1.0}, {1.0, 0.0}} * low_pass(2.0);
  const StateSpace s = realise(t);
  EXPECT_NEAR(std::abs(s.response(0.7)(0, 0) - t.response(0.7)), 0.0, 1e-15);
  EXPECT_NEAR(general_eigenvalues(s.A).real().maxCoeff(), 0.0, 1e-15);
}

TEST(StateSpace, InSeries) {
  const TransferFunction a = high_pass(1.0, 0.7), b = 0.4 * low_pass(3.0);
  EXPECT_LT(difference(in_series(realise(a), realise(b)), a * b), 1e-13);
  EXPECT_THROW((void)in_series(with_two_outputs(realise(b)), realise(a)), InputError);
}

TEST(StateSpace, RefusesWhatDoesNotFit) {
  StateSpace s = realise(low_pass(1.0, 1.0));
  s.validate();
  s.B.resize(3, 1);
  EXPECT_THROW(s.validate(), InputError);
}

}  // namespace
}  // namespace veridyn::numerics
