#include "veridyn/numerics/linear_systems/causal_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/counting_new.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

TEST(CausalFilter, StepOfAWashoutIsItsClosedForm) {
  // Of s^2/(s + w)^2: (1 - w t) e^(-w t).
  const double w = 0.8;
  CausalFilter filter(high_pass(w, 1.0), Hold::kZeroOrder);
  EXPECT_EQ(filter.reset(0.0), 0.0);
  double t = 0.0, y = filter.step(1.0, 0.0);
  EXPECT_NEAR(y, 1.0, 1e-15);
  for (const double dt : {0.01, 0.007, 0.031, 0.5, 0.5, 2.0, 1e-4}) {
    t += dt;
    y = filter.step(1.0, dt);
    EXPECT_NEAR(y, (1.0 - w * t) * std::exp(-w * t), 1e-13) << t;
  }
}

TEST(CausalFilter, OfARampOnIrregularStampsIsItsClosedForm) {
  // Of w/(s + w), from rest: t - (1 - e^(-w t))/w.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(0.007, 0.031);
  CausalFilter filter(low_pass(10.0));
  filter.reset(0.0);
  double t = 0.0;
  for (int k = 0; k < 300; ++k) {
    const double dt = step(random);
    t += dt;
    ASSERT_NEAR(filter.step(t, dt), t - (1.0 - std::exp(-10.0 * t)) / 10.0, 1e-13) << t;
  }
}

TEST(CausalFilter, StaysAtRestAfterReset) {
  for (const TransferFunction& t : {low_pass(2.0, 0.7), high_pass(0.8, 1.0), 0.6 * low_pass(2.0) * high_pass(0.1)}) {
    CausalFilter filter(t);
    const double rest = filter.reset(3.5);
    EXPECT_NEAR(rest, 3.5 * t.response(0.0).real(), 1e-14);
    for (int k = 0; k < 100; ++k) ASSERT_NEAR(filter.step(3.5, 0.013), rest, 1e-13);
  }
  // An integrator rests at zero input only.
  CausalFilter position(TransferFunction{{1.0}, {1.0, 0.0}});
  EXPECT_EQ(position.reset(2.0), 0.0);
  EXPECT_NEAR(position.step(2.0, 0.5), 1.0, 1e-15);
}

TEST(CausalFilter, IsLinearAndACopyGoesOnAlike) {
  CausalFilter plain(low_pass(3.0, 0.5) * high_pass(1.0)), mirrored = plain;
  for (int k = 0; k < 50; ++k) {
    const double u = std::sin(0.3 * k);
    ASSERT_EQ(plain.step(u, 0.01), -mirrored.step(-u, 0.01));
  }
  CausalFilter saved = plain;
  for (int k = 0; k < 20; ++k) ASSERT_EQ(plain.step(0.1 * k, 0.02), saved.step(0.1 * k, 0.02));
}

TEST(CausalFilter, TakesWhatItIsGiven) {
  CausalFilter filter(low_pass(3.0)), held = filter;
  filter.reset(1.0);
  held.reset(1.0);
  filter.step(2.0, 0.1);
  held.step(2.0, 0.1);
  EXPECT_EQ(filter.step(kNaN, 0.1), held.step(2.0, 0.1));
  EXPECT_EQ(filter.step(2.0, -1.0), held.output());
  EXPECT_EQ(filter.step(2.0, kNaN), held.output());
  EXPECT_NEAR(filter.step(2.0, 100.0), 2.0, 1e-12);
}

TEST(CausalFilter, DoesNotAllocate) {
  CausalFilter filter(high_pass(0.8, 1.0) * low_pass(2.0, 1.0) * high_pass(0.2));
  double sum = 0.0;
  const long before = allocations.load();
  for (int k = 0; k < 1000; ++k) sum += filter.step(std::sin(0.01 * k), k % 3 == 0 ? 0.016 : 0.017);
  EXPECT_EQ(allocations.load(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(CausalFilter, RefusesWhatItCannotHold) {
  StateSpace two_outputs = realise(low_pass(1.0));
  two_outputs.C = two_outputs.C.replicate(2, 1).eval();
  two_outputs.D = two_outputs.D.replicate(2, 1).eval();
  EXPECT_THROW(CausalFilter{two_outputs}, InputError);
  TransferFunction seven = low_pass(1.0);
  for (int i = 0; i < 6; ++i) seven = seven * low_pass(1.0);
  EXPECT_THROW(CausalFilter{seven}, InputError);
}

}  // namespace
}  // namespace veridyn::numerics
