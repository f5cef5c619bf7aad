#include "veridyn/numerics/linear_systems/transfer_function.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

using Complex = std::complex<double>;

TEST(TransferFunction, ResponseIsThatOfItsFactors) {
  const TransferFunction t = 3.0 * high_pass(0.8, 1.0) * low_pass(5.0) * low_pass(2.0, 0.6);
  for (const double w : {0.0, 0.1, 0.8, 2.0, 30.0}) {
    const Complex s(0.0, w);
    const Complex expected = 3.0 * s * s / ((s + 0.8) * (s + 0.8)) * 5.0 / (s + 5.0) * 4.0 / (s * s + 2.4 * s + 4.0);
    EXPECT_NEAR(std::abs(t.response(w) - expected), 0.0, 1e-14 * (1.0 + std::abs(expected))) << w;
  }
}

TEST(TransferFunction, AHighPassAndItsLowPassesAddUpToOne) {
  // s^2 + 2 zeta w s + w^2 over itself.
  const TransferFunction middle{{2.0 * 0.7 * 3.0, 0.0}, {1.0, 2.0 * 0.7 * 3.0, 9.0}};
  const TransferFunction all = high_pass(3.0, 0.7) + low_pass(3.0, 0.7) + middle;
  for (const double w : {0.0, 1.0, 3.0, 100.0}) EXPECT_NEAR(std::abs(all.response(w) - 1.0), 0.0, 1e-13) << w;
  const TransferFunction first = high_pass(0.4) + low_pass(0.4);
  EXPECT_NEAR(std::abs(first.response(0.3) - 1.0), 0.0, 1e-15);
}

TEST(TransferFunction, RefusesWhatIsNoFilter) {
  EXPECT_THROW((void)low_pass(0.0), InputError);
  EXPECT_THROW((void)high_pass(-1.0), InputError);
  EXPECT_THROW((void)low_pass(1.0, 0.0), InputError);
  EXPECT_THROW((void)high_pass(kNaN, 1.0), InputError);
  TransferFunction differentiates{{1.0, 0.0}, {0.0, 2.0}};
  EXPECT_THROW(differentiates.normalise(), InputError);
  TransferFunction nothing{{1.0}, {0.0}};
  EXPECT_THROW(nothing.normalise(), InputError);
  TransferFunction proper{{0.0, 1.0}, {0.0, 1.0, 2.0}};
  proper.normalise();
  EXPECT_THAT(proper.denominator, ::testing::ElementsAre(1.0, 2.0));
}

}  // namespace
}  // namespace veridyn::numerics
