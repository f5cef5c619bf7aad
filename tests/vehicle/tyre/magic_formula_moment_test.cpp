#include "veridyn/vehicle/tyre/magic_formula_moment.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/support/folders.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

/// The small tyre with a trail, a residual moment and an arm of F_x.
MagicFormulaTyre<double> trailing_tyre() {
  std::string text = testing::small_tir();
  text += R"([ALIGNING_COEFFICIENTS]
QBZ1 = 9.5
QBZ2 = -2.0
QBZ4 = 0.1
QBZ5 = -0.3
QBZ9 = 12.0
QCZ1 = 1.15
QDZ1 = 0.12
QDZ2 = -0.007
QDZ3 = -0.3
QDZ4 = 1.5
QDZ6 = -0.006
QDZ7 = 0.002
QDZ8 = -0.17
QEZ1 = -2.0
QEZ2 = -0.5
QEZ4 = 0.3
QHZ1 = 0.003
QHZ3 = 0.13
SSZ1 = 0.02
SSZ2 = -0.01
SSZ3 = 0.4
)";
  return parse_tir(text, "small").tyre;
}

// The printed formula, straight down, at pure slip: our slip angle 0.05 is -0.05 of the file.
TEST(AligningMoment, IsTheFormulaOfTheBookAtPureSlip) {
  const MagicFormulaTyre<double> tyre = trailing_tyre();
  const double Fz = 5000.0, alpha = -0.05, gamma = 0.03, dfz = 0.25, R0 = 0.31;
  const double Fy0 = tyre.Fy0(Fz, alpha, gamma);
  const double Bt = (9.5 - 2.0 * dfz) * (1.0 + 0.1 * gamma - 0.3 * gamma) / 0.95;
  const double at = alpha + 0.003 + 0.13 * gamma;
  const double Dt = Fz * (0.12 - 0.007 * dfz) * (1.0 - 0.3 * gamma + 1.5 * gamma * gamma) * R0 / 4000.0;
  const double Et = (-2.0 - 0.5 * dfz) * (1.0 + 0.3 * 2.0 / 3.14159265358979323846 * std::atan(Bt * 1.15 * at));
  const double t = Dt * std::cos(1.15 * std::atan(Bt * at - Et * (Bt * at - std::atan(Bt * at)))) * std::cos(alpha);
  const double Ky = -18.5 * 4000.0 * std::sin(2.0 * std::atan(Fz / (1.8 * 4000.0))) * (1.0 - 0.3 * gamma);
  const double SHf = 0.0025 + 0.03 * gamma + Fz * (0.03 - 0.3 * gamma) * 0.95 / Ky;
  const double Dr = Fz * ((-0.006 + 0.002 * dfz) - 0.17 * gamma) * R0 * 0.95;
  const double Mzr = Dr * std::cos(std::atan(12.0 / 0.95 * (alpha + SHf))) * std::cos(alpha);
  const double s = (0.02 - 0.01 * Fy0 / 4000.0 + 0.4 * gamma) * R0;
  const double expected = -t * Fy0 + Mzr + s * tyre.combined(Fz, 0.0, alpha, gamma).Fx;
  EXPECT_NEAR(aligning_moment(tyre, Fz, 0.0, 0.05, gamma), expected, 1e-9);
}

TEST(AligningMoment, TurnsTheWheelWhereItGoes) {
  const MagicFormulaTyre<double> tyre = trailing_tyre().symmetric();
  // The wheel points to the left of its way: pushed left, it is turned back to the right, and less so when it slides.
  const double small = aligning_moment(tyre, 4000.0, 0.0, 0.03, 0.0);
  EXPECT_LT(small, -20.0);
  EXPECT_GT(aligning_moment(tyre, 4000.0, 0.0, 0.4, 0.0), small);
  EXPECT_NEAR(aligning_moment(tyre, 4000.0, 0.0, -0.03, 0.0), -small, 1e-10);
  // Its trail is that of the moment over the force: some centimetres.
  const double trail = -small / tyre.forces(4000.0, 0.0, 0.03, 0.0).Fy;
  EXPECT_GT(trail, 0.02);
  EXPECT_LT(trail, 0.05);
}

TEST(AligningMoment, KeepsTheLawsOfTheForces) {
  const MagicFormulaTyre<double> tyre = trailing_tyre();
  const MagicFormulaTyre<double> other = tyre.on_other_side();
  using Jet = ceres::Jet<double, 4>;
  const auto dual = tyre.cast<Jet>();
  for (const double load : {100.0, 3000.0, 8000.0}) {
    for (const double kappa : {-0.05, 0.02}) {
      for (const double alpha : {-0.07, 0.04}) {
        for (const double camber : {-0.02, 0.05}) {
          const double moment = aligning_moment(tyre, load, kappa, alpha, camber);
          EXPECT_NEAR(aligning_moment(other, load, kappa, -alpha, -camber), -moment, 1e-10 * load);
          const Jet d = aligning_moment(dual, Jet(load, 0), Jet(kappa, 1), Jet(alpha, 2), Jet(camber, 3));
          const double h = 1e-6;
          EXPECT_NEAR(d.v[2],
                      (aligning_moment(tyre, load, kappa, alpha + h, camber) -
                       aligning_moment(tyre, load, kappa, alpha - h, camber)) /
                          (2.0 * h),
                      1e-6 * load);
          EXPECT_NEAR(d.v[1],
                      (aligning_moment(tyre, load, kappa + h, alpha, camber) -
                       aligning_moment(tyre, load, kappa - h, alpha, camber)) /
                          (2.0 * h),
                      1e-6 * load);
        }
      }
    }
  }
  EXPECT_EQ(aligning_moment(tyre, 0.0, 0.05, 0.05, 0.01), 0.0);
  EXPECT_EQ(aligning_moment(parse_tir(testing::small_tir(), "small").tyre, 4000.0, 0.05, 0.05, 0.01), 0.0);
  // Pure slip is the limit of combined slip.
  EXPECT_NEAR(aligning_moment(tyre, 4000.0, 1e-12, 0.05, 0.01), aligning_moment(tyre, 4000.0, 0.0, 0.05, 0.01), 1e-7);
}

TEST(AligningMoment, OfRealTyresIsOfTheirSize) {
  const std::filesystem::path folder = test::shared_folder() / "data/vehicle/chrono";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "needs the shared tyre files, which are not part of the project: " << folder.string();
  const TirFile sedan = read_tir(folder / "Sedan_Pac02Tire.tir");
  const auto tyre = sedan.tyre.symmetric();
  // Pneumatic trail at small slip: a quarter of the contact patch or so, 3 to 6 cm of a car tyre at nominal load.
  const double trail = -aligning_moment(tyre, 4850.0, 0.0, 0.01, 0.0) / tyre.forces(4850.0, 0.0, 0.01, 0.0).Fy;
  EXPECT_GT(trail, 0.02);
  EXPECT_LT(trail, 0.06);
}

}  // namespace
}  // namespace veridyn::vehicle
