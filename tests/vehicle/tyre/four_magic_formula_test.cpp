#include "veridyn/vehicle/tyre/four_magic_formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

using MagicTyre = MagicFormulaTyre<double>;

/// A tyre with every coefficient of its forces.
MagicTyre full_tyre(CombinedSlip combined, std::mt19937_64& random) {
  const auto about = [&](double x) { return x * std::uniform_real_distribution(0.5, 1.5)(random); };
  MagicTyre t;
  MagicFormulaCoefficients<double>& c = t.coefficients;
  c.PDX2 = about(-0.05), c.PDX3 = about(0.1), c.PEX1 = about(0.4), c.PEX2 = about(0.2), c.PEX3 = about(0.07);
  c.PEX4 = about(-0.1), c.PKX2 = about(-0.5), c.PHX1 = about(1e-3), c.PHX2 = about(4e-4);
  c.PVX1 = about(-1e-3), c.PVX2 = about(1e-3);
  c.PDY2 = about(-0.1), c.PDY3 = about(1.0), c.PEY1 = about(-0.5), c.PEY2 = about(-0.3), c.PEY3 = about(-0.4);
  c.PEY4 = about(-5.0), c.PKY3 = about(0.3), c.PHY1 = about(2e-3), c.PHY2 = about(1e-4), c.PHY3 = about(0.03);
  c.PVY1 = about(0.03), c.PVY2 = about(-0.01), c.PVY3 = about(-0.3), c.PVY4 = about(-0.7);
  c.LMUX = about(1.0), c.LKX = about(1.0), c.LEX = about(0.5), c.LHX = about(1.0), c.LVX = about(1.0);
  c.LMUY = about(1.0), c.LKY = about(1.0), c.LEY = about(0.5), c.LHY = about(1.0), c.LVY = about(1.0);
  c.LGAX = about(1.0), c.LGAY = about(1.0), c.LFZO = about(1.0);
  c.RBX1 = 12.0, c.RCX1 = 1.0, c.RBY1 = 10.0, c.RCY1 = 1.0;
  t.combined_slip = combined;
  t.range = {.load_min = about(200.0),
             .load_max = about(9000.0),
             .slip_ratio_min = -1.2,
             .slip_ratio_max = 1.5,
             .slip_angle_min = -1.0,
             .slip_angle_max = 1.1,
             .camber_min = -0.3,
             .camber_max = 0.25};
  return t;
}

TEST(FourMagicFormulaTyres, AreTheTyresOneByOne) {
  std::mt19937_64 random(11);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  for (const CombinedSlip combined : {CombinedSlip::kEquivalentSlip, CombinedSlip::kNone, CombinedSlip::kWeighting}) {
    for (int set = 0; set < 50; ++set) {
      PerWheel<MagicTyre> tyres;
      for (MagicTyre& t : tyres) {
        t = full_tyre(combined, random);
        t.mirrored = random() % 2 == 0;
      }
      if (set % 10 == 9) tyres[2].coefficients.PKX3 = 0.3;
      const FourTyres<MagicTyre> four(tyres);
      for (int k = 0; k < 400; ++k) {
        WheelArray<double> load, ratio, angle, Fx, Fy;
        for (Eigen::Index w = 0; w < 4; ++w) {
          const auto kind = random() % 8;
          const double reach = std::pow(10.0, between(-6.0, 0.7));
          load[w] = kind == 0 ? 0.0 : kind == 1 ? between(-100.0, 300.0) : between(300.0, 15000.0);
          ratio[w] = kind == 2 || kind == 3 ? 0.0 : between(-reach, reach);
          angle[w] = kind == 3 || kind == 4 ? 0.0 : between(-reach, reach);
        }
        const double camber = k % 3 == 0 ? 0.0 : between(-0.4, 0.4);
        four.forces(load, ratio, angle, camber, Fx, Fy);
        for (Eigen::Index w = 0; w < 4; ++w) {
          const TyreForces<double> one = tyres[w].forces(load[w], ratio[w], angle[w], camber);
          const double tolerance = 2e-13 * std::max(load[w], 100.0);
          ASSERT_NEAR(Fx[w], one.Fx, tolerance) << "set " << set << " case " << k << " wheel " << w;
          ASSERT_NEAR(Fy[w], one.Fy, tolerance) << "set " << set << " case " << k << " wheel " << w;
        }
      }
    }
  }
}

TEST(FourMagicFormulaTyres, OfAFileMirrorAMirroredStateBitForBit) {
  const TirFile file = parse_tir(testing::small_tir(), "small.tir");
  const MagicTyre left = file.on(TyreSide::kLeft), right = file.on(TyreSide::kRight);
  const FourTyres<MagicTyre> four({left, right, left, right});
  std::mt19937_64 random(3);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  for (int k = 0; k < 1000; ++k) {
    WheelArray<double> load, ratio, angle, Fx, Fy, mirrored_Fx, mirrored_Fy;
    for (Eigen::Index w = 0; w < 4; ++w)
      load[w] = between(0.0, 8000.0), ratio[w] = between(-0.2, 0.2), angle[w] = between(-0.3, 0.3);
    const auto other_side = [](const WheelArray<double>& x) { return WheelArray<double>(x[1], x[0], x[3], x[2]); };
    const double camber = between(-0.1, 0.1);
    four.forces(load, ratio, angle, camber, Fx, Fy);
    four.forces(other_side(load), other_side(ratio), -other_side(angle), -camber, mirrored_Fx, mirrored_Fy);
    EXPECT_TRUE((other_side(mirrored_Fx) == Fx).all());
    EXPECT_TRUE((-other_side(mirrored_Fy) == Fy).all());
  }
}

}  // namespace
}  // namespace veridyn::vehicle
