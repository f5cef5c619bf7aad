#include "veridyn/vehicle/model/compliance_steer.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::vehicle {
namespace {

using Wheels = WheelArray<double>;

// F = C (alpha + x), x = c F: x = c C alpha/(1 - c C).
TEST(ComplianceSteer, OfLinearTyresIsTheClosedForm) {
  const Wheels c(-6e-6, 4e-6, 0.0, -1e-5), alpha(0.03, 0.03, -0.02, 0.1);
  const double C = 60000.0;
  int calls = 0;
  const auto force_at = [&](const Wheels& turned, Wheels& force) {
    force = C * (alpha + turned);
    ++calls;
  };
  const Wheels gain = c * C;
  const Wheels steer = compliance_steer<double>(c, gain, force_at);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(steer[i], c[i] * C * alpha[i] / (1.0 - c[i] * C), 1e-13);
  EXPECT_EQ(calls, 2);
}

// A force that saturates: the wheel gives way by c F at the force that it then has, and derivatives follow.
TEST(ComplianceSteer, BalancesForcesThatSaturateWithTheirDerivatives) {
  using Jet = ceres::Jet<double, 1>;
  for (const double c : {-8e-6, 8e-6}) {
    for (const double alpha : {0.0, 1e-9, 0.01, -0.06, 0.3}) {
      const auto force = [](const auto& angle) {
        using std::tanh;
        return 5000.0 * tanh(angle * 12.0);
      };
      WheelArray<Jet> compliance, gain;
      compliance.setConstant(Jet(c));
      gain.setConstant(Jet(c * 60000.0));
      int calls = 0;
      const auto force_at = [&](const WheelArray<Jet>& turned, WheelArray<Jet>& out) {
        for (Eigen::Index i = 0; i < 4; ++i) out[i] = force(Jet(alpha, 0) + turned[i]);
        ++calls;
      };
      const Jet steer = compliance_steer<Jet>(compliance, gain, force_at)[0];
      EXPECT_NEAR(steer.a, c * force(alpha + steer.a), 1e-13) << c << ' ' << alpha;
      const double slope = 60000.0 / std::pow(std::cosh(12.0 * (alpha + steer.a)), 2);
      EXPECT_NEAR(steer.v(0), c * slope / (1.0 - c * slope), 1e-9) << c << ' ' << alpha;
      // With numbers it ends earlier.
      int fewer = 0;
      const Wheels plain = compliance_steer<double>(Wheels::Constant(c), Wheels::Constant(c * 60000.0),
                                                    [&](const Wheels& turned, Wheels& out) {
                                                      for (Eigen::Index i = 0; i < 4; ++i)
                                                        out[i] = force(alpha + turned[i]);
                                                      ++fewer;
                                                    });
      EXPECT_NEAR(plain[0], steer.a, 2e-13);
      EXPECT_LE(fewer, 8) << c << ' ' << alpha;
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
