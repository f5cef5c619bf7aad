#include "veridyn/numerics/linear_systems/discretisation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

const TransferFunction kBand = high_pass(0.8, 1.0) * low_pass(6.0);

TEST(Held, OfAFirstOrderLagIsItsClosedForm) {
  const StateSpace s = realise(low_pass(2.0));
  const double h = 0.3, decay = std::exp(-2.0 * h);
  const HeldSystem zero = held(s, h, Hold::kZeroOrder), first = held(s, h, Hold::kFirstOrder);
  EXPECT_NEAR(zero.Phi(0, 0), decay, 1e-15);
  EXPECT_NEAR((s.C * zero.Gamma)(0, 0), 1.0 - decay, 1e-15);
  EXPECT_EQ(zero.Slope(0, 0), 0.0);
  // Of the ramp t/h: 1 - (1 - decay)/(2 h).
  EXPECT_NEAR((s.C * first.Slope)(0, 0), 1.0 - (1.0 - decay) / (2.0 * h), 1e-15);
}

TEST(Held, StepsAddUp) {
  const StateSpace s = realise(kBand);
  const HeldSystem whole = held(s, 0.05, Hold::kZeroOrder), part = held(s, 0.02, Hold::kZeroOrder),
                   rest = held(s, 0.03, Hold::kZeroOrder);
  EXPECT_LT((rest.Phi * part.Phi - whole.Phi).norm(), 1e-14);
  EXPECT_LT((rest.Phi * part.Gamma + rest.Gamma - whole.Gamma).norm(), 1e-14);
  EXPECT_LT((held(s, 0.0, Hold::kFirstOrder).Phi - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-16);
  EXPECT_THROW((void)held(s, -0.1, Hold::kZeroOrder), InputError);
  EXPECT_THROW((void)held(s, kNaN, Hold::kZeroOrder), InputError);
}

TEST(Bilinear, MeetsTheContinuousResponseWhereItIsWarped) {
  const StateSpace s = realise(kBand);
  for (const double w : {0.5, 3.0, 20.0}) {
    EXPECT_NEAR(std::abs(bilinear(s, 0.05, w).response(w, 0.05)(0, 0) - kBand.response(w)), 0.0, 1e-13) << w;
    // Elsewhere it is that of the warped frequency.
    const double warped = w / std::tan(0.025 * w) * std::tan(0.025 * 7.0);
    EXPECT_NEAR(std::abs(bilinear(s, 0.05, w).response(7.0, 0.05)(0, 0) - kBand.response(warped)), 0.0, 1e-13) << w;
  }
  const double tustin = 2.0 / 0.05 * std::tan(0.025 * 7.0);
  EXPECT_NEAR(std::abs(bilinear(s, 0.05).response(7.0, 0.05)(0, 0) - kBand.response(tustin)), 0.0, 1e-13);
}

TEST(Bilinear, RefusesFrequenciesBeyondHalfTheRateAndPolesOfItsOwn) {
  const StateSpace s = realise(kBand);
  EXPECT_THROW((void)bilinear(s, 0.1, 40.0), InputError);
  EXPECT_THROW((void)bilinear(s, 0.0), InputError);
  const StateSpace unstable{Eigen::MatrixXd::Constant(1, 1, 20.0), Eigen::MatrixXd::Ones(1, 1),
                            Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd::Zero(1, 1)};
  EXPECT_THROW((void)bilinear(unstable, 0.1), InputError);
}

}  // namespace
}  // namespace veridyn::numerics
