#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "veridyn/vehicle/tyre/four_tyres.hpp"

namespace veridyn::vehicle::testing {

/// Loads and slips of four wheels, from none to far beyond what tyres hold, wheels off the ground and free of slip
/// among them.
struct WheelCase {
  WheelArray<double> load, ratio, angle;
};
inline WheelCase any_wheel_case(std::mt19937_64& random) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  WheelCase out;
  for (Eigen::Index w = 0; w < 4; ++w) {
    const auto kind = random() % 8;
    const double reach = std::pow(10.0, between(-6.0, 0.7));
    out.load[w] = kind == 0 ? 0.0 : kind == 1 ? between(-100.0, 300.0) : between(300.0, 15000.0);
    out.ratio[w] = kind == 2 || kind == 3 ? 0.0 : between(-reach, reach);
    out.angle[w] = kind == 3 || kind == 4 ? 0.0 : between(-reach, reach);
  }
  return out;
}

/// Four tyres at once against the tyres one by one: `relative` of each force and `per_load` of the load apart at most.
template <typename Tyre>
void expect_tyres_one_by_one(const PerWheel<Tyre>& tyres, std::mt19937_64& random, double relative, double per_load) {
  const FourTyres<Tyre> four(tyres);
  for (int k = 0; k < 1000; ++k) {
    const WheelCase at = any_wheel_case(random);
    WheelArray<double> Fx, Fy;
    four.forces(at.load, at.ratio, at.angle, 0.02, Fx, Fy);
    for (Eigen::Index w = 0; w < 4; ++w) {
      const TyreForces<double> one = tyres[w].forces(at.load[w], at.ratio[w], at.angle[w], 0.02);
      const double tolerance = per_load * std::max(at.load[w], 0.0);
      ASSERT_NEAR(Fx[w], one.Fx, relative * std::abs(one.Fx) + tolerance) << "case " << k << " wheel " << w;
      ASSERT_NEAR(Fy[w], one.Fy, relative * std::abs(one.Fy) + tolerance) << "case " << k << " wheel " << w;
    }
  }
}

/// Mirrored slips on wheels changed over give the mirrored forces of the other side, bit for bit. @param tyre of all
template <typename Tyre>
void expect_mirrored_bits(const Tyre& tyre, std::mt19937_64& random) {
  const FourTyres<Tyre> four({tyre, tyre, tyre, tyre});
  const auto other_side = [](const WheelArray<double>& x) { return WheelArray<double>(x[1], x[0], x[3], x[2]); };
  for (int k = 0; k < 1000; ++k) {
    const WheelCase at = any_wheel_case(random);
    WheelArray<double> Fx, Fy, mirrored_Fx, mirrored_Fy;
    four.forces(at.load, at.ratio, at.angle, 0.0, Fx, Fy);
    four.forces(other_side(at.load), other_side(at.ratio), -other_side(at.angle), 0.0, mirrored_Fx, mirrored_Fy);
    EXPECT_TRUE((other_side(mirrored_Fx) == Fx).all());
    EXPECT_TRUE((-other_side(mirrored_Fy) == Fy).all());
  }
}

}  // namespace veridyn::vehicle::testing
