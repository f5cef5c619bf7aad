#include "veridyn/vehicle/tracking/axle_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/vehicle/simulated_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;

template <typename Tyre>
RollingBicycle<double, Tyre> on(Tyre front, Tyre rear) {
  const VehicleParameters<double> p = family_car();
  front.stiffness = p.C_f;
  rear.stiffness = p.C_r;
  return {.bicycle = {.parameters = p, .front = front, .rear = rear}, .roll = {.gradient = 0.009}};
}

// A brush tyre with x = C alpha/(3 mu F_z): F = mu F_z (1 - (1 - x)^3).
TEST(ForcesWithoutLimit, AreThoseOfTheClosedFormForABrushTyre) {
  const AnyRollingBicycle car = on(FialaTyre<double>{.mu = 0.9}, FialaTyre<double>{.mu = 0.9});
  const PerWheel<double> load = static_loads(family_car(), kGravity);
  const std::array limit{0.9 * load[kFrontLeft], 0.9 * load[kRearLeft]};
  for (const double share : {0.01, 0.2, 0.5, 0.7}) {
    const std::array force{share * limit[0], -share * limit[1]};
    const std::array<double, 2> found = forces_without_limit(car, force, 0.0);
    const double expected = 3.0 * (1.0 - std::cbrt(1.0 - share));
    // The tyre's slip is the tangent of the angle.
    EXPECT_NEAR(found[0] / limit[0], expected, 2e-3 * expected) << share;
    EXPECT_NEAR(found[1] / limit[1], -expected, 2e-3 * expected) << share;
  }
}

TEST(ForcesWithoutLimit, AreThoseOfAMagicFormulaTyreAtItsSlip) {
  const PerWheel<double> load = static_loads(family_car(), kGravity);
  const auto car = on(SimpleMagicFormulaTyre<double>{.mu = 1.0, .C = 1.4, .nominal_load = load[kFrontLeft]},
                      SimpleMagicFormulaTyre<double>{.mu = 1.0, .C = 1.4, .nominal_load = load[kRearLeft]});
  for (const double slip : {-0.04, 0.005, 0.03}) {
    const std::array<double, 2> force = car.bicycle.tyre_forces({slip, slip});
    const std::array<double, 2> found = forces_without_limit(car, force, 0.0);
    EXPECT_NEAR(found[0], family_car().C_f * slip, 1e-6 * std::abs(found[0])) << slip;
    EXPECT_NEAR(found[1], family_car().C_r * slip, 1e-6 * std::abs(found[1])) << slip;
  }
}

// What load that moves takes off the force, n = shifted/(g gradient): F = C alpha (1 - loss n^2 (1 +- balance)).
TEST(ForcesWithoutLimit, GiveBackWhatAnAxleLosesByLoadThatMoves) {
  const PerWheel<double> load = static_loads(family_car(), kGravity);
  auto car = on(SimpleMagicFormulaTyre<double>{.mu = 1e3, .nominal_load = load[kFrontLeft]},
                SimpleMagicFormulaTyre<double>{.mu = 1e3, .nominal_load = load[kRearLeft]});
  car.load_transfer = {.effect = LoadTransfer<double>::Effect::kLoss, .loss = 0.2, .balance = 0.3};
  const double n = 0.5, shifted = n * kGravity * car.roll.gradient;
  const std::array<double, 2> found = forces_without_limit(car, {500.0, 500.0}, shifted);
  EXPECT_NEAR(found[0], 500.0 / (1.0 - 0.2 * n * n * 1.3), 0.1);
  EXPECT_NEAR(found[1], 500.0 / (1.0 - 0.2 * n * n * 0.7), 0.1);
}

TEST(ForcesWithoutLimit, StayFiniteWhereTheTyreCannotPushSoHard) {
  const AnyRollingBicycle car = on(FialaTyre<double>{.mu = 0.9}, FialaTyre<double>{.mu = 0.9});
  const std::array<double, 2> found = forces_without_limit(car, {1e5, -1e5}, 0.0);
  EXPECT_NEAR(found[0], 2e5, 1.0);
  EXPECT_NEAR(found[1], -2e5, 1.0);
}

TEST(ForcesWithoutLimit, AreTheForcesOfLinearTyres) {
  const AnyRollingBicycle car = on(LinearTyre<double>{}, LinearTyre<double>{});
  EXPECT_TRUE(is_linear(car));
  EXPECT_FALSE(is_linear(on(FialaTyre<double>{}, FialaTyre<double>{})));
  EXPECT_EQ(forces_without_limit(car, {123.0, -4e4}, 0.05), (std::array{123.0, -4e4}));
  EXPECT_EQ(stiffnesses_of(car), (std::array{family_car().C_f, family_car().C_r}));
}

}  // namespace
}  // namespace veridyn::vehicle
