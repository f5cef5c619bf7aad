#include "veridyn/numerics/linear_systems/washout.hpp"

#include <gtest/gtest.h>

#include "veridyn/numerics/linear_systems/causal_filter.hpp"

namespace veridyn::numerics {
namespace {

// Another formulation: the transfer function, discretised by the matrix exponential for inputs linear in each step.
TEST(Washout, IsTheHighPassOfASignalThatIsLinearInEachStep) {
  constexpr double kT = 0.07;
  CausalFilter high(high_pass(1.0 / kT));
  double x = 0.4, y = high.reset(x);
  EXPECT_EQ(y, 0.0);
  for (int k = 1; k <= 40; ++k) {
    const double step = 0.001 * (1 + k % 9), next = std::sin(0.3 * k) + 0.02 * k;
    y = washed_out(y, next - x, step / kT);
    x = next;
    EXPECT_NEAR(y, high.step(x, step), 1e-12);
  }
  EXPECT_EQ(washed_out(0.3, 0.2, 0.0), 0.5);
}

}  // namespace
}  // namespace veridyn::numerics
