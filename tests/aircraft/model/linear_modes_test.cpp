#include "veridyn/aircraft/model/linear_modes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

/// Two oscillations in the plane of symmetry, a pair and two real ones beside it, uncoupled.
LinearModel made() {
  LinearModel model;
  model.A.setZero();
  model.B.setZero();
  const auto pair = [&](Eigen::Index i, Eigen::Index j, double real, double imag) {
    model.A(i, i) = model.A(j, j) = real;
    model.A(i, j) = imag, model.A(j, i) = -imag;
  };
  pair(2, 4, -3.0, 5.0);   // w q
  pair(0, 7, -0.02, 0.4);  // u theta
  pair(1, 5, -0.5, 4.0);   // v r
  model.A(3, 3) = -12.0;   // p
  model.A(6, 6) = 0.01;    // phi
  return model;
}

TEST(LinearModes, AreNamedByBlockAndSpeed) {
  const std::vector<LinearMode> modes = linear_modes(made());
  ASSERT_EQ(modes.size(), 5u);
  const auto s_of = [&](Mode mode) { return std::ranges::find(modes, mode, &LinearMode::mode)->s; };
  using Complex = std::complex<double>;
  EXPECT_LT(std::abs(s_of(Mode::kShortPeriod) - Complex(-3.0, 5.0)), 1e-12);
  EXPECT_LT(std::abs(s_of(Mode::kPhugoid) - Complex(-0.02, 0.4)), 1e-12);
  EXPECT_LT(std::abs(s_of(Mode::kDutchRoll) - Complex(-0.5, 4.0)), 1e-12);
  EXPECT_LT(std::abs(s_of(Mode::kRoll) - Complex(-12.0, 0.0)), 1e-12);
  EXPECT_LT(std::abs(s_of(Mode::kSpiral) - Complex(0.01, 0.0)), 1e-12);
}

TEST(LinearModes, WithoutAnOscillationTheMiddleTwoAreTheDutchRoll) {
  LinearModel model = made();
  model.A(1, 5) = model.A(5, 1) = 0.0;
  model.A(1, 1) = -0.5, model.A(5, 5) = -0.7;
  int dutch = 0;
  for (const LinearMode& mode : linear_modes(model)) {
    dutch += mode.mode == Mode::kDutchRoll ? 1 : 0;
    if (mode.mode == Mode::kSpiral) EXPECT_NEAR(mode.s.real(), 0.01, 1e-12);
    if (mode.mode == Mode::kRoll) EXPECT_NEAR(mode.s.real(), -12.0, 1e-12);
  }
  EXPECT_EQ(dutch, 2);
}

// left' A = s left' within a block: what makes a mode's size independent of the others.
TEST(LinearModes, LeftEigenvectorsSeparateThem) {
  const Subject s = builtin_subject("aerosonde");
  Subject symmetric = s;
  const Trim trim = find_trim(symmetric, {.airspeed = 25.0});
  ASSERT_TRUE(trim.usable());
  LinearModel model = linearise(symmetric, trim);
  // Without what couples the two planes.
  for (const Eigen::Index i : {0, 2, 4, 7})
    for (const Eigen::Index j : {1, 3, 5, 6}) model.A(i, j) = model.A(j, i) = 0.0;
  for (const LinearMode& mode : linear_modes(model)) {
    const Eigen::VectorXcd image = model.A.transpose().cast<std::complex<double>>() * mode.left;
    EXPECT_LT((image - mode.s * mode.left).norm(), 1e-9 * image.norm()) << words_of(mode.mode);
  }
}

}  // namespace
}  // namespace veridyn::aircraft
