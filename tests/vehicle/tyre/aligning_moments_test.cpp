#include "veridyn/vehicle/tyre/aligning_moments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

// A brush of bristles over the contact of length 2 a: each is bent in proportion to its way from the leading edge,
// until the parabolic pressure lets it slide. Force and moment by adding up its bristles.
TEST(AligningMoments, OfFialasTyreAreThoseOfItsBristles) {
  const double a = 0.09, load = 4000.0, mu = 0.9;
  const FialaTyre<double> tyre{.stiffness = 55000.0, .mu = mu, .pneumatic_trail = a / 3.0};
  for (const double angle : {0.002, 0.03, -0.08, 0.15, 0.3}) {
    const double bristle = tyre.stiffness * angle / (2.0 * a * a);  // force per length, per way
    double force = 0.0, moment = 0.0;
    constexpr int kBristles = 200000;
    for (int i = 0; i < kBristles; ++i) {
      const double x = a - 2.0 * a * (i + 0.5) / kBristles, width = 2.0 * a / kBristles;
      const double most = mu * 0.75 * load / a * (1.0 - x * x / (a * a));
      const double bent = std::clamp(bristle * (a - x), -most, most);
      force += bent * width;
      moment += x * bent * width;
    }
    EXPECT_NEAR(tyre.forces(load, 0.0, angle, 0.0).Fy, force, 1e-6 * load) << angle;
    EXPECT_NEAR(aligning_moment(tyre, load, 0.0, angle, 0.0), moment, 1e-6 * load * a) << angle;
  }
}

TEST(AligningMoments, OfLinearTyresAreTheTrailTimesTheForce) {
  const LinearTyre<double> tyre{.stiffness = 50000.0, .mu = 0.8, .pneumatic_trail = 0.03};
  EXPECT_NEAR(aligning_moment(tyre, 4000.0, 0.0, 0.02, 0.0), -0.03 * 1000.0, 1e-12);
  EXPECT_NEAR(aligning_moment(tyre, 4000.0, 0.0, -0.5, 0.0), 0.03 * 3200.0, 1e-10);
}

TEST(AligningMoments, OfTheSimpleFormulaBeginWithATrailInProportionToTheLoadAndEnd) {
  const SimpleMagicFormulaTyre<double> tyre{.pneumatic_trail = 0.03};
  for (const double load : {2000.0, 4000.0, 6000.0}) {
    const double angle = 1e-5, force = tyre.forces(load, 0.0, angle, 0.0).Fy;
    EXPECT_NEAR(aligning_moment(tyre, load, 0.0, angle, 0.0) / force, -0.03 * load / 4000.0, 1e-5);
    EXPECT_EQ(aligning_moment(tyre, load, 0.0, 0.5, 0.0), 0.0);  // everything slides
    EXPECT_EQ(aligning_moment(tyre, load, 0.0, -0.03, 0.0), -aligning_moment(tyre, load, 0.0, 0.03, 0.0));
  }
  EXPECT_EQ(aligning_moment(tyre, 0.0, 0.0, 0.1, 0.0), 0.0);
}

TEST(AligningMoments, OfFourTyresAreThoseOfEachOnTheGround) {
  const MagicFormulaTyre<double> tyre = parse_tir(testing::small_tir(), "small").tyre;
  const PerWheel<MagicFormulaTyre<double>> tyres{tyre, tyre.on_other_side(), tyre, tyre.on_other_side()};
  const WheelArray<double> load(3000.0, 5000.0, 0.0, 4000.0), ratio(0.0, 0.01, 0.0, -0.02), angle(0.02, 0.05, 0.1, 0.0);
  const WheelArray<double> moments = aligning_moments(tyres, load, ratio, angle, 0.01);
  EXPECT_EQ(moments[2], 0.0);
  for (const Eigen::Index i : {0, 1, 3}) {
    EXPECT_EQ(moments[i], aligning_moment(tyres[i], load[i], ratio[i], angle[i], 0.01)) << i;
  }
}

}  // namespace
}  // namespace veridyn::vehicle
