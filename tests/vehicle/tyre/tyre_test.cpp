// Laws that every tyre keeps; a new one joins with one line in `Tyres`.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"
#include "veridyn/vehicle/tyre/magic_formula.hpp"
#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"

namespace veridyn::vehicle {
namespace {

using Jet = ceres::Jet<double, 4>;  // load, slip ratio, slip angle, camber

/// A tyre with every coefficient at work, about as large as those of a car.
template <typename Scalar>
MagicFormulaTyre<Scalar> whole_tyre(CombinedSlip combined) {
  MagicFormulaTyre<Scalar> tyre;
  tyre.combined_slip = combined;
  tyre.range.load_min = 200.0;
  tyre.range.load_max = 9000.0;
  MagicFormulaCoefficients<Scalar>& c = tyre.coefficients;
  std::size_t index = 0;
  for (const auto& field : kMagicFormulaFields<Scalar>) {
    const double wiggle = 0.02 * std::sin(1.0 + static_cast<double>(index++));
    c.*field.member += Scalar(wiggle);
  }
  c.PKX2 = Scalar(0.4);
  c.PKX3 = Scalar(0.15);
  c.PEX1 = Scalar(0.3);
  c.PEX2 = Scalar(0.1);
  c.PEY1 = Scalar(-0.4);
  c.PEY3 = Scalar(0.3);
  c.PEY4 = Scalar(-3.0);
  c.PDX2 = Scalar(-0.1);
  c.PDY2 = Scalar(-0.12);
  c.PDY3 = Scalar(-1.2);
  c.RBX1 = Scalar(11.0);
  c.RBX2 = Scalar(-9.0);
  c.RCX1 = Scalar(1.1);
  c.RBY1 = Scalar(6.5);
  c.RBY2 = Scalar(3.0);
  c.RCY1 = Scalar(1.05);
  c.RVY5 = Scalar(1.9);
  c.RVY6 = Scalar(-8.0);
  return tyre;
}

struct LinearCase {
  static constexpr bool kLimited = false, kSymmetric = true;
  template <typename Scalar>
  static LinearTyre<Scalar> make() {
    return {Scalar(50000.0), Scalar(90000.0)};
  }
};
struct LimitedLinearCase {
  static constexpr bool kLimited = true, kSymmetric = true;
  template <typename Scalar>
  static LinearTyre<Scalar> make() {
    return {Scalar(50000.0), Scalar(91000.0), Scalar(0.9)};
  }
};
struct FialaCase {
  static constexpr bool kLimited = true, kSymmetric = true;
  template <typename Scalar>
  static FialaTyre<Scalar> make() {
    return {Scalar(50000.0), Scalar(90000.0), Scalar(0.9)};
  }
};
struct SimpleMagicFormulaCase {
  static constexpr bool kLimited = true, kSymmetric = true;
  template <typename Scalar>
  static SimpleMagicFormulaTyre<Scalar> make() {
    SimpleMagicFormulaTyre<Scalar> tyre;
    tyre.E = Scalar(-0.6);
    tyre.stiffness_saturation = Scalar(0.5);
    tyre.mu_load = Scalar(0.15);
    return tyre;
  }
};
struct WeightingCase {
  static constexpr bool kLimited = true, kSymmetric = false;
  template <typename Scalar>
  static MagicFormulaTyre<Scalar> make() {
    return whole_tyre<Scalar>(CombinedSlip::kWeighting);
  }
};
struct SymmetricWeightingCase {
  static constexpr bool kLimited = true, kSymmetric = true;
  template <typename Scalar>
  static MagicFormulaTyre<Scalar> make() {
    return WeightingCase::make<Scalar>().symmetric();
  }
};
struct EquivalentSlipCase {
  static constexpr bool kLimited = true, kSymmetric = false;
  template <typename Scalar>
  static MagicFormulaTyre<Scalar> make() {
    return whole_tyre<Scalar>(CombinedSlip::kEquivalentSlip);
  }
};
struct DefaultMagicFormulaCase {
  static constexpr bool kLimited = true, kSymmetric = true;
  template <typename Scalar>
  static MagicFormulaTyre<Scalar> make() {
    return {};
  }
};

template <typename Case>
class EveryTyre : public ::testing::Test {};
using Tyres = ::testing::Types<LinearCase, LimitedLinearCase, FialaCase, SimpleMagicFormulaCase, WeightingCase,
                               SymmetricWeightingCase, EquivalentSlipCase, DefaultMagicFormulaCase>;
TYPED_TEST_SUITE(EveryTyre, Tyres);

constexpr double kLoads[] = {60.0, 1500.0, 4200.0, 7000.0};
constexpr double kRatios[] = {-0.8, -0.07, 0.0, 0.02, 0.15};
constexpr double kAngles[] = {-0.6, -0.05, 0.0, 0.012, 0.11};
constexpr double kCambers[] = {-0.06, 0.0, 0.04};

template <typename Check>
void everywhere(Check check) {
  for (const double load : kLoads) {
    for (const double ratio : kRatios) {
      for (const double angle : kAngles) {
        for (const double camber : kCambers) {
          SCOPED_TRACE(::testing::Message()
                       << "load " << load << " kappa " << ratio << " alpha " << angle << " camber " << camber);
          check(load, ratio, angle, camber);
        }
      }
    }
  }
}

TYPED_TEST(EveryTyre, IsATyreForNumbersAndForDerivatives) {
  static_assert(TyreModel<decltype(TypeParam::template make<double>()), double>);
  static_assert(TyreModel<decltype(TypeParam::template make<Jet>()), Jet>);
}

TYPED_TEST(EveryTyre, TransmitsNothingWithoutLoadAndStaysFiniteNearby) {
  if constexpr (TypeParam::kLimited) {
    const auto tyre = TypeParam::template make<double>();
    for (const double ratio : {-1.4, 0.0, 0.1}) {
      for (const double angle : {-1.5, 0.0, 0.02}) {
        const auto none = tyre.forces(0.0, ratio, angle, 0.01);
        EXPECT_EQ(none.Fx, 0.0);
        EXPECT_EQ(none.Fy, 0.0);
        for (const double load : {1e-140, 1e-9, 1e-3, 1.0}) {
          const auto f = tyre.forces(load, ratio, angle, 0.01);
          EXPECT_LE(std::hypot(f.Fx, f.Fy), 2.0 * load) << load;
        }
      }
    }
  } else {
    GTEST_SKIP() << "this tyre does not know its load";
  }
}

template <typename Tyre>
double tyre_mu(const Tyre& tyre, double load) {
  if constexpr (requires { tyre.mu_load; }) {
    return tyre.mu / (1.0 + tyre.mu_load * (load / tyre.nominal_load - 1.0));
  } else if constexpr (requires { tyre.mu; }) {
    return tyre.mu;
  } else {
    return std::numeric_limits<double>::quiet_NaN();  // of tyres with more than one
  }
}

TYPED_TEST(EveryTyre, StaysWithinItsFriction) {
  if constexpr (TypeParam::kLimited) {
    const auto tyre = TypeParam::template make<double>();
    everywhere([&](double load, double ratio, double angle, double camber) {
      const auto f = tyre.forces(load, ratio, angle, camber);
      if constexpr (requires { tyre.coefficients; }) {
        const auto t = tyre.at(load, camber);
        const double limit = t.share * t.Fz;
        // Vertical shifts, and the pure forces at rest that an equivalent slip leaves alone, come on top.
        const auto rest = tyre.forces(load, 0.0, 0.0, camber);
        const double shifts = t.share * (std::abs(t.SV_x) + std::abs(t.SV_y)) + std::abs(rest.Fx) + std::abs(rest.Fy);
        // Measured weights do not know the ellipse: those of this tyre exceed it by up to 15 %.
        const double excess = tyre.combined_slip == CombinedSlip::kWeighting ? 0.15 : 1e-12;
        EXPECT_LE(std::hypot(f.Fx / t.mu_x, f.Fy / t.mu_y), limit * (1.0 + excess) + shifts / t.mu_y);
        return;
      }
      EXPECT_LE(std::hypot(f.Fx, f.Fy), tyre_mu(tyre, load) * load * (1.0 + 1e-14));
    });
  } else {
    GTEST_SKIP() << "this tyre has no friction limit";
  }
}

TYPED_TEST(EveryTyre, TurnsItsSideForceWithItsSlipAngle) {
  const auto tyre = TypeParam::template make<double>();
  if constexpr (TypeParam::kSymmetric) {
    everywhere([&](double load, double ratio, double angle, double camber) {
      const auto one = tyre.forces(load, ratio, angle, camber);
      const auto other = tyre.forces(load, ratio, -angle, -camber);
      EXPECT_NEAR(one.Fx, other.Fx, 1e-13 * load);
      EXPECT_NEAR(one.Fy, -other.Fy, 1e-13 * load);
    });
  } else {
    const auto right = tyre.on_other_side();
    double most = 0.0;
    everywhere([&](double load, double ratio, double angle, double camber) {
      const auto one = tyre.forces(load, ratio, angle, camber);
      const auto other = right.forces(load, ratio, -angle, -camber);
      EXPECT_NEAR(one.Fx, other.Fx, 1e-13 * load);
      EXPECT_NEAR(one.Fy, -other.Fy, 1e-13 * load);
      most = std::max(most, std::abs(one.Fy + tyre.forces(load, ratio, -angle, -camber).Fy) / load);
    });
    EXPECT_GT(most, 1e-3) << "the tyre of this case was to be one-sided";
  }
}

TYPED_TEST(EveryTyre, PushesToTheSideItSlipsFrom) {
  const auto tyre = TypeParam::template make<double>();
  for (const double load : kLoads) {
    EXPECT_GT(tyre.forces(load, 0.0, 0.06, 0.0).Fy, 0.0);
    EXPECT_LT(tyre.forces(load, 0.0, -0.06, 0.0).Fy, 0.0);
    EXPECT_GT(tyre.forces(load, 0.06, 0.0, 0.0).Fx, 0.0);
    EXPECT_LT(tyre.forces(load, -0.06, 0.0, 0.0).Fx, 0.0);
    EXPECT_GT(tyre.cornering_stiffness(load), 0.0);
  }
}

TYPED_TEST(EveryTyre, HasTheSlopeItSaysAtZeroSlip) {
  const auto tyre = TypeParam::template make<double>();
  const auto differentiable = TypeParam::template make<Jet>();
  const double step = 1e-8;  // differences: rounding 1e-8, a brush tyre's |alpha| alpha at 60 N 3e-6
  for (const double load : kLoads) {
    const double stiffness = tyre.cornering_stiffness(load);
    const double slope = (tyre.forces(load, 0.0, step, 0.0).Fy - tyre.forces(load, 0.0, -step, 0.0).Fy) / (2.0 * step);
    EXPECT_NEAR(slope / stiffness, 1.0, 1e-5) << load;
    const auto f = differentiable.forces(Jet(load), Jet(0.0, 1), Jet(0.0, 2), Jet(0.0));
    EXPECT_NEAR(f.Fy.v[2] / stiffness, 1.0, 1e-12) << load;
  }
}

TYPED_TEST(EveryTyre, IsDifferentiatedCorrectlyInItsInputs) {
  const auto tyre = TypeParam::template make<double>();
  const auto differentiable = TypeParam::template make<Jet>();
  everywhere([&](double load, double ratio, double angle, double camber) {
    const double x[4] = {load, ratio, angle, camber};
    const auto f = differentiable.forces(Jet(load, 0), Jet(ratio, 1), Jet(angle, 2), Jet(camber, 3));
    const auto value = tyre.forces(load, ratio, angle, camber);
    EXPECT_NEAR(f.Fx.a, value.Fx, 1e-12 * load);
    EXPECT_NEAR(f.Fy.a, value.Fy, 1e-12 * load);
    for (int i = 0; i < 4; ++i) {
      EXPECT_TRUE(std::isfinite(f.Fx.v[i]) && std::isfinite(f.Fy.v[i])) << i;
      // At zero the one-sided slopes of camber and of the equivalent slip differ.
      if (x[i] == 0.0) continue;
      const double step = i == 0 ? 1e-3 : 1e-6;
      double up[4] = {x[0], x[1], x[2], x[3]};
      double down[4] = {x[0], x[1], x[2], x[3]};
      up[i] += step;
      down[i] -= step;
      const auto a = tyre.forces(up[0], up[1], up[2], up[3]);
      const auto b = tyre.forces(down[0], down[1], down[2], down[3]);
      // Central differences: rounding 1e-16 load/step, third derivatives of the order (50/rad)^3 step^2.
      const double tolerance = i == 0 ? 1e-8 : 4e-7 * std::max(load, 1500.0);
      EXPECT_NEAR(f.Fx.v[i], (a.Fx - b.Fx) / (2.0 * step), tolerance) << "dFx by input " << i;
      EXPECT_NEAR(f.Fy.v[i], (a.Fy - b.Fy) / (2.0 * step), tolerance) << "dFy by input " << i;
    }
  });
}

TYPED_TEST(EveryTyre, IsContinuous) {
  const auto tyre = TypeParam::template make<double>();
  // Random walks of short steps: no jump larger than the steepest slope allows.
  double x[4] = {};
  const double widths[4] = {9500.0, 1.6, 1.5, 0.2};
  auto last = tyre.forces(0.5 * widths[0], 0.0, 0.0, 0.0);
  for (int n = 1; n < 20000; ++n) {
    const double t = 1e-4 * n;
    x[0] = 0.5 * widths[0] * (1.0 + std::sin(3.1 * t));
    x[1] = 0.5 * widths[1] * std::pow(std::sin(5.3 * t), 3);
    x[2] = 0.5 * widths[2] * std::pow(std::sin(7.7 * t), 3);
    x[3] = 0.5 * widths[3] * std::sin(11.9 * t);
    const auto now = tyre.forces(x[0], x[1], x[2], x[3]);
    const double jump = std::hypot(now.Fx - last.Fx, now.Fy - last.Fy);
    // At most some 400 kN per unit of slip, 1.3 N/N of load, at most 6e-4 of slip and 1.5 N of load a step.
    ASSERT_LT(jump, 300.0) << "at step " << n;
    last = now;
  }
}

// Derivatives by the coefficients: automatic against central differences.
template <typename Tyre, typename JetTyre, typename Real, typename Dual>
void check_coefficient(Tyre tyre, JetTyre dual, Real real, Dual dual_member, const char* name) {
  using J = ceres::Jet<double, 1>;
  dual_member(dual).v[0] = 1.0;
  const double size = std::max(1.0, std::abs(real(tyre)));
  const double step = 1e-6 * size;
  for (const double load : {1500.0, 6000.0}) {
    for (const double ratio : {-0.06, 0.03}) {
      for (const double angle : {-0.08, 0.05}) {
        for (const double camber : {-0.03, 0.05}) {
          const auto f = dual.forces(J(load), J(ratio), J(angle), J(camber));
          Tyre up = tyre;
          Tyre down = tyre;
          real(up) += step;
          real(down) -= step;
          const auto a = up.forces(load, ratio, angle, camber);
          const auto b = down.forces(load, ratio, angle, camber);
          const double tolerance = 2e-6 * load / size;
          EXPECT_NEAR(f.Fx.v[0], (a.Fx - b.Fx) / (2.0 * step), tolerance) << name;
          EXPECT_NEAR(f.Fy.v[0], (a.Fy - b.Fy) / (2.0 * step), tolerance) << name;
        }
      }
    }
  }
}

// A wheel off the ground: models hand over what their springs say, which may be below 0.
TEST(LiftedTyre, TransmitsNothing) {
  const auto expect_none = [](const auto& tyre) {
    const auto f = tyre.forces(-50.0, 0.1, 0.1, 0.01);
    EXPECT_EQ(f.Fx, 0.0);
    EXPECT_EQ(f.Fy, 0.0);
    EXPECT_EQ(tyre.cornering_stiffness(-50.0), 0.0);
  };
  expect_none(FialaCase::make<double>());
  expect_none(SimpleMagicFormulaCase::make<double>());
  expect_none(WeightingCase::make<double>());
  expect_none(EquivalentSlipCase::make<double>());
}

TEST(TyreCoefficients, OfTheMagicFormulaAreDifferentiatedCorrectly) {
  using J = ceres::Jet<double, 1>;
  for (const CombinedSlip combined : {CombinedSlip::kWeighting, CombinedSlip::kEquivalentSlip, CombinedSlip::kNone}) {
    const auto tyre = whole_tyre<double>(combined);
    for (std::size_t i = 0; i < kMagicFormulaFields<double>.size(); ++i) {
      const auto real = kMagicFormulaFields<double>[i];
      const auto dual = kMagicFormulaFields<J>[i];
      check_coefficient(
          tyre, tyre.template cast<J>(), [&](auto& t) -> double& { return t.coefficients.*real.member; },
          [&](auto& t) -> J& { return t.coefficients.*dual.member; }, real.name.data());
    }
  }
}

TEST(TyreCoefficients, OfTheSimpleTyresAreDifferentiatedCorrectly) {
  using J = ceres::Jet<double, 1>;
  const auto magic = SimpleMagicFormulaCase::make<double>();
  const auto fiala = FialaCase::make<double>();
#define CHECK_MEMBER(object, name)                                                                                 \
  check_coefficient(                                                                                               \
      object, object.cast<J>(), [&](auto& t) -> double& { return t.name; }, [&](auto& t) -> J& { return t.name; }, \
      #name)
  CHECK_MEMBER(magic, stiffness);
  CHECK_MEMBER(magic, slip_stiffness);
  CHECK_MEMBER(magic, mu);
  CHECK_MEMBER(magic, C);
  CHECK_MEMBER(magic, E);
  CHECK_MEMBER(magic, nominal_load);
  CHECK_MEMBER(magic, stiffness_saturation);
  CHECK_MEMBER(magic, mu_load);
  CHECK_MEMBER(fiala, stiffness);
  CHECK_MEMBER(fiala, slip_stiffness);
  CHECK_MEMBER(fiala, mu);
#undef CHECK_MEMBER
}

}  // namespace
}  // namespace veridyn::vehicle
