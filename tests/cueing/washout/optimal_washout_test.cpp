#include "veridyn/cueing/washout/optimal_washout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "veridyn/cueing/perception/perception.hpp"

namespace veridyn::cueing {
namespace {

OptimalWashout made(const char* platform, const OptimalDesign& design = {}) {
  return {design, built_in_platform(platform)};
}

TEST(OptimalWashout, AnswersASineAsItsClosedLoopDoes) {
  // Simulated sample by sample against the closed loop's transfer functions.
  OptimalChannel surge = made("hexapod").channels()[1];
  const double omega = 2.0, step = 0.01;
  const std::complex<double> expected = surge.response(omega)(1, 0);  // acceleration over force
  surge.step({0.0, 0.0}, std::nullopt);
  std::complex<double> fit = 0.0;
  long count = 0;
  const double size = 1e-3;  // far from the limit of the tilt's rate
  for (long k = 1; k < 12000; ++k) {
    const double t = static_cast<double>(k) * step;
    const PairedOutput out = surge.step({size * std::sin(omega * t), 0.0}, step);
    const double last_periods = 20.0 * 2.0 * kPi / omega;
    if (t < 120.0 - last_periods) continue;
    fit += 2.0 * out.acceleration / size * std::complex<double>(std::sin(omega * t), std::cos(omega * t));
    ++count;
  }
  fit /= static_cast<double>(count);
  EXPECT_LT(std::abs(fit - expected), 2e-3 * std::abs(expected));
}

TEST(OptimalWashout, TheWeightOfTravelTradesItForWhatIsFelt) {
  const auto cost = [](const OptimalDesign& design) {
    OptimalChannel c = made("hexapod", design).channels()[1];
    Perception vehicle(vestibular_model("young_meiry")), rider(vestibular_model("young_meiry"));
    c.step({0.0, 0.0}, std::nullopt);
    vehicle.reset({0, 0, 0}, {0, 0, 0});
    rider.reset({0, 0, 0}, {0, 0, 0});
    double sum = 0.0;
    for (int k = 1; k < 3000; ++k) {
      const double force = 0.05 * std::exp(-0.01 * k);
      const PairedOutput o = c.step({force, 0.0}, 0.01);
      const auto v = vehicle.step({force, 0, 0}, {0, 0, 0}, 0.01);
      const auto p = rider.step({o.acceleration + kGravity * o.tilt, 0, 0}, {0, o.tilt_rate, 0}, 0.01);
      sum += std::pow((p.force.x() - v.force.x()) / 0.17, 2) + std::pow((p.rate.y() - v.rate.y()) / (2.0 * kDegree), 2);
    }
    return sum;
  };
  OptimalDesign more;
  more.shift_weight = 300.0;
  OptimalDesign less;
  less.shift_weight = 3.0;
  EXPECT_LT(cost(less), cost({}));
  EXPECT_LT(cost({}), cost(more));
}

TEST(OptimalWashout, TheTiltForAForceKeepsItsRate) {
  OptimalDesign design;
  design.tilt_rate = 3.0 * kDegree;
  OptimalChannel c = made("three_axis", design).channels()[1];
  c.step({0.0, 0.0}, std::nullopt);
  double before = 0.0, fastest = 0.0;
  for (int k = 0; k < 500; ++k) {
    const double tilt = c.step({5.0, 0.0}, 0.01).tilt;
    fastest = std::max(fastest, std::abs(tilt - before) / 0.01);
    before = tilt;
  }
  EXPECT_NEAR(fastest, 3.0 * kDegree, 1e-9);
}

}  // namespace
}  // namespace veridyn::cueing
