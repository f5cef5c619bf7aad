#include "veridyn/vehicle/tyre/magic_formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "tests/support/folders.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/io/tables/table.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

/// The tyre that the published program has: of Sedan_Pac02Tire.tir, without all that depends on load, its slip
/// stiffnesses in proportion to it, all scaling factors 1.
MagicFormulaTyre<double> load_independent(MagicFormulaTyre<double> tyre) {
  MagicFormulaCoefficients<double>& c = tyre.coefficients;
  for (const auto& field : kMagicFormulaFields<double>) {
    if (field.name.front() == 'L') c.*field.member = 1.0;
  }
  for (double* zero : {&c.PDX2, &c.PEX2, &c.PEX3, &c.PEX4, &c.PKX2, &c.PKX3, &c.PHX2, &c.PVX2, &c.PDY2, &c.PEY2,
                       &c.PEY3, &c.PEY4, &c.PKY3, &c.PHY2, &c.PVY2, &c.PVY4}) {
    *zero = 0.0;
  }
  // 2 x/(1 + x^2) with x = F_z/(PKY2 F_z0): for a large PKY2 that is 2 x to 1e-12.
  c.PKY1 *= 0.5e6;
  c.PKY2 = 1e6;
  // The file has no combined slip; these are the program's.
  c.RBX1 = 13.276;
  c.RBX2 = -13.778;
  c.RCX1 = 1.2568;
  c.REX1 = 0.65225;
  c.RHX1 = 0.0050722;
  c.RBY1 = 7.1433;
  c.RBY2 = 9.1916;
  c.RBY3 = -0.027856;
  c.RCY1 = 1.0719;
  c.REY1 = -0.27572;
  c.RHY1 = 5.7448e-6;
  c.RVY1 = -0.027825;
  c.RVY3 = -0.27568;
  c.RVY4 = 12.12;
  c.RVY5 = 1.9;
  c.RVY6 = -10.704;
  tyre.combined_slip = CombinedSlip::kWeighting;
  return tyre;
}

struct Row {
  double load, s, alpha, gamma, Fx0, Fy0, mu_y, Fx, Fy;
};

class PublishedTyre : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto table = test::shared_folder() / "reference/tyre_reference.csv";
    const auto tir = test::shared_folder() / "data/vehicle/chrono/Sedan_Pac02Tire.tir";
    if (!std::filesystem::exists(table) || !std::filesystem::exists(tir))
      GTEST_SKIP() << "needs the shared reference values, which are not part of the project: " << table.string();
    tyre = load_independent(read_tir(tir).tyre);
    const io::Table values = io::read_table(table);
    for (std::size_t i = 0; i < values.rows(); ++i) {
      const auto at = [&](const char* name) { return values.at(name).value[i]; };
      rows.push_back({at("Fz"), at("s"), at("alpha"), at("gamma"), at("Fx0"), at("Fy0"), at("mu_y"), at("Fx_comb"),
                      at("Fy_comb")});
    }
    ASSERT_EQ(rows.size(), 504U);
  }
  /// As the program has it: without camber it drops the shifts, which belong to the sign of the camber there.
  [[nodiscard]] MagicFormulaTyre<double> at_camber(double gamma) const {
    MagicFormulaTyre<double> same = tyre;
    if (gamma == 0.0) same.coefficients.PHY1 = same.coefficients.PVY1 = 0.0;
    return same;
  }
  /// Its longitudinal force, with the vertical shift where it put it: inside the sine.
  [[nodiscard]] double Fx0_with_its_error(double load, double kappa) const {
    const auto t = tyre.at(load, 0.0);
    const MagicFormulaCoefficients<double>& c = tyre.coefficients;
    const double D = t.mu_x * t.Fz;
    const double y = t.K_x / (c.PCX1 * D) * (kappa + t.SH_x);
    return D * std::sin(magic_formula::angle(c.PCX1, c.PEX1, y) + t.SV_x);
  }
  static constexpr double kDigits = 1e-10;  // the table has twelve
  MagicFormulaTyre<double> tyre;
  std::vector<Row> rows;
};

void expect_relative(double value, double reference, double tolerance) {
  EXPECT_LE(std::abs(value - reference), tolerance * std::abs(reference) + 1e-9) << value << " is not " << reference;
}

TEST_F(PublishedTyre, HasOurLateralForceAtPureSlip) {
  for (const Row& row : rows) {
    const MagicFormulaTyre<double> same = at_camber(row.gamma);
    expect_relative(same.Fy0(row.load, row.alpha, row.gamma), row.Fy0, kDigits);
    expect_relative(same.mu_y(row.load, row.gamma), row.mu_y, kDigits);
    if (row.s == 0.0) expect_relative(same.combined(row.load, 0.0, row.alpha, row.gamma).Fy, row.Fy0, 1e-10);
    // In our convention the same tyre answers to the opposite slip angle.
    if (row.s == 0.0) expect_relative(same.forces(row.load, 0.0, -row.alpha, row.gamma).Fy, row.Fy0, 1e-10);
  }
}

TEST_F(PublishedTyre, AddsTheVerticalShiftOfTheLongitudinalForceInsideTheSine) {
  double most = 0.0;
  for (const Row& row : rows) {
    const double kappa = -row.s;
    // With its error ours is theirs, so coefficients and formula are the same but for that.
    expect_relative(Fx0_with_its_error(row.load, kappa), row.Fx0, kDigits);
    // The shift is a force, F_z PVX1 (4.E9, 4.E18): as an angle it is 0.06 rad at 7 kN, wrong by its unit.
    const double ours = tyre.Fx0(row.load, kappa, 0.0);
    most = std::max(most, std::abs(ours - row.Fx0) / row.load);
  }
  // D_x times that angle, less the shift itself.
  EXPECT_NEAR(most, (1.1739 * 7000.0 - 1.0) * 8.8098e-6, 5e-5);
}

TEST_F(PublishedTyre, ConfusesTheSignOfItsSlipAtCombinedSlip) {
  double most = 0.0;
  for (const Row& row : rows) {
    const MagicFormulaTyre<double> same = at_camber(row.gamma);
    const auto weight = [&](double kappa) {
      const auto f = same.combined(row.load, kappa, row.alpha, row.gamma);
      return TyreForces<double>{f.Fx / same.Fx0(row.load, kappa, row.gamma), f.Fy};
    };
    // The pure force takes kappa = -s, the weights s itself. With that confusion ours is theirs,
    const double shares = weight(row.s).Fx;
    expect_relative(shares * row.Fx0, row.Fx, 1e-9);
    expect_relative(weight(row.s).Fy, row.Fy, 1e-9);
    // and without it the force that a driven wheel adds sideways has the other sign.
    const double ours = weight(-row.s).Fy;
    most = std::max(most, std::abs(ours - row.Fy) / row.load);
  }
  EXPECT_GT(most, 0.04);
}

TEST(MagicFormula, KnowsEachCoefficientOnce) {
  std::set<std::string_view> names;
  std::set<std::size_t> places;
  MagicFormulaCoefficients<double> c;
  for (const auto& field : kMagicFormulaFields<double>) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    EXPECT_TRUE(places.insert(static_cast<std::size_t>(&(c.*field.member) - &c.FNOMIN)).second) << field.name;
  }
}

// The formula of the book written once more, straight down, for one point of everything at once.
TEST(MagicFormula, IsTheFormulaOfTheBook) {
  const MagicFormulaTyre<double> tyre = parse_tir(testing::small_tir(), "small").tyre;
  const double Fz = 5000.0, kappa = 0.04, alpha = -0.07, gamma = 0.03;
  const double dfz = (Fz - 4000.0) / 4000.0;
  // (4.E9) to (4.E18)
  const double mux = (1.15 - 0.08 * dfz) * 0.9;
  const double Kx = Fz * 21.0 * std::exp(0.2 * dfz);
  const double Bx = Kx / (1.6 * mux * Fz);
  const double kx = kappa + 0.001;
  const double Fx0 = mux * Fz * std::sin(1.6 * std::atan(Bx * kx - 0.4 * (Bx * kx - std::atan(Bx * kx))));
  EXPECT_NEAR(tyre.Fx0(Fz, kappa, gamma), Fx0, 1e-11 * Fz);
  // (4.E19) to (4.E29)
  const double muy = (1.0 - 0.15 * dfz) * 0.95;
  const double Ky = -18.5 * 4000.0 * std::sin(2.0 * std::atan(Fz / (1.8 * 4000.0))) * (1.0 - 0.3 * gamma);
  const double By = Ky / (1.3 * muy * Fz);
  const double ay = alpha + 0.0025 + 0.03 * gamma;
  const double SVy = Fz * (0.03 - 0.3 * gamma) * 0.95;
  const double Fy0 = muy * Fz * std::sin(1.3 * std::atan(By * ay + 0.7 * (By * ay - std::atan(By * ay)))) + SVy;
  EXPECT_NEAR(tyre.Fy0(Fz, alpha, gamma), Fy0, 1e-11 * Fz);
  // (4.E50) to (4.E57)
  const double Gx = std::cos(1.1 * std::atan(12.5 * std::cos(std::atan(-10.0 * kappa)) * alpha));
  // (4.E58) to (4.E67)
  const double Gy = std::cos(1.05 * std::atan(7.0 * std::cos(std::atan(2.5 * alpha)) * kappa));
  const double SVyk = muy * Fz * -0.03 * std::sin(1.9 * std::atan(-10.0 * kappa));
  const TyreForces<double> f = tyre.combined(Fz, kappa, alpha, gamma);
  EXPECT_NEAR(f.Fx, Gx * Fx0, 1e-11 * Fz);
  EXPECT_NEAR(f.Fy, Gy * Fy0 + SVyk, 1e-11 * Fz);
}

TEST(MagicFormula, SharesFrictionByTheEquivalentSlip) {
  MagicFormulaTyre<double> tyre;  // symmetric, no shifts
  tyre.coefficients.PDX1 = 1.2;
  tyre.combined_slip = CombinedSlip::kEquivalentSlip;
  const double load = 3500.0;
  for (const double scale : {0.02, 0.1, 0.5, 2.0}) {
    const double kappa = 0.3 * scale;
    const double alpha = -0.2 * scale;
    const TyreForces<double> f = tyre.combined(load, kappa, alpha, 0.0);
    const auto t = tyre.at(load, 0.0);
    // Along the vector of normalised slips, and no longer than the ellipse.
    const double x = t.K_x * kappa / t.mu_x;
    const double y = t.K_y * alpha / t.mu_y;
    const double curve_x = tyre.Fx0(load, std::hypot(x, y) * t.mu_x / t.K_x, 0.0);
    EXPECT_NEAR(f.Fx, x / std::hypot(x, y) * curve_x, 1e-9);
    EXPECT_LE(std::hypot(f.Fx / t.mu_x, f.Fy / t.mu_y), load * (1.0 + 1e-12));
  }
}

TEST(MagicFormula, ReducesToPureSlipWhateverTheWayOfCombining) {
  MagicFormulaTyre<double> tyre = parse_tir(testing::small_tir(), "small").tyre;
  for (const CombinedSlip way : {CombinedSlip::kWeighting, CombinedSlip::kEquivalentSlip, CombinedSlip::kNone}) {
    tyre.combined_slip = way;
    for (const double tiny : {0.0, 1e-13, -1e-13}) {
      EXPECT_NEAR(tyre.combined(4500.0, tiny, 0.08, 0.02).Fy, tyre.Fy0(4500.0, 0.08, 0.02), 1e-7);
      EXPECT_NEAR(tyre.combined(4500.0, 0.05, tiny, 0.02).Fx, tyre.Fx0(4500.0, 0.05, 0.02), 1e-7);
    }
  }
}

TEST(MagicFormula, ScalesForcesBelowItsLeastLoadAndKeepsThemAboveItsLargest) {
  const MagicFormulaTyre<double> tyre = parse_tir(testing::small_tir(), "small").tyre;
  const TyreForces<double> least = tyre.forces(200.0, 0.03, 0.05, 0.01);
  const TyreForces<double> half = tyre.forces(100.0, 0.03, 0.05, 0.01);
  EXPECT_NEAR(half.Fx, 0.5 * least.Fx, 1e-12);
  EXPECT_NEAR(half.Fy, 0.5 * least.Fy, 1e-12);
  EXPECT_EQ(tyre.forces(9000.0, 0.03, 0.05, 0.01).Fy, tyre.forces(20000.0, 0.03, 0.05, 0.01).Fy);
}

TEST(MagicFormula, MakesASymmetricAxleOfATyreAndItsMirrorImage) {
  const TirFile file = parse_tir(testing::small_tir(), "small");
  const MagicFormulaTyre<double> left = file.on(TyreSide::kLeft);
  const MagicFormulaTyre<double> right = file.on(TyreSide::kRight);
  EXPECT_EQ(file.side, TyreSide::kRight);
  EXPECT_TRUE(left.mirrored);
  EXPECT_FALSE(right.mirrored);
  // Straight ahead the shifts push against each other,
  EXPECT_GT(std::abs(left.forces(4000.0, 0.0, 0.0, 0.0).Fy), 10.0);
  EXPECT_EQ(left.forces(4000.0, 0.0, 0.0, 0.0).Fy, -right.forces(4000.0, 0.0, 0.0, 0.0).Fy);
  // and a tyre made symmetric has none, yet leans as before.
  const MagicFormulaTyre<double> even = file.tyre.symmetric();
  EXPECT_EQ(even.forces(4000.0, 0.0, 0.0, 0.0).Fy, 0.0);
  EXPECT_NE(even.forces(4000.0, 0.0, 0.0, 0.05).Fy, 0.0);
}

}  // namespace
}  // namespace veridyn::vehicle
