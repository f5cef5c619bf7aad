#include "veridyn/muscle/actuator/activation_dynamics.hpp"

#include <gtest/gtest.h>

namespace veridyn::muscle {
namespace {

TEST(ActivationDynamics, MatchesPrintedRates) {
  struct Row {
    double u, a, fast, slow, smooth, sharp;
  };
  for (const Row& r : {Row{1.0, 0.1, 138.461538462, 92.3076923077, 54.7339439415, 92.3076910503},
                       Row{0.5, 0.2, 37.5, 25.0, 14.814905534, 24.9480749137},
                       Row{0.1, 0.5, -12.5, -10.0, -14.5734719113, -8.33769288503}}) {
    EXPECT_NEAR(activation_rate(r.u, r.a, 0.010, 0.040), r.fast, 1e-8);
    EXPECT_NEAR(activation_rate(r.u, r.a, 0.015, 0.050), r.slow, 1e-8);
    EXPECT_NEAR(smooth_activation_rate(r.u, r.a, 0.015, 0.060, 0.1), r.smooth, 1e-8);
    EXPECT_NEAR(smooth_activation_rate(r.u, r.a, 0.015, 0.060, 10.0), r.sharp, 1e-8);
  }
  EXPECT_NEAR(activation_rate(0.0, 1.0, 0.010, 0.040), -50.0, 1e-12);
  EXPECT_NEAR(smooth_activation_rate(0.0, 1.0, 0.015, 0.060, 0.1), -33.3333333333, 1e-9);
}

}  // namespace
}  // namespace veridyn::muscle
