#include "veridyn/vehicle/similarity/scaled_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/vehicle/cars.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"
#include "veridyn/vehicle/similarity/scaled_drive.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"

namespace veridyn::vehicle {
namespace {

using testing::road_car;

SimulationOptions options_of(double speed, const ScaleFactors& factors) {
  return {.duration = 12.0 * factors.time(),
          .step = 1e-3 * factors.time(),
          .output_step = 0.05 * factors.time(),
          .speed = speed * factors.speed};
}

/// The reference manoeuvre of prototype and twin, the twin's scaled back; the largest difference over the largest
/// value.
template <typename Tyre>
double largest_difference(const FourWheelModel<double, Tyre>& prototype, const FourWheelModel<double, Tyre>& twin,
                          const ScaleFactors& factors) {
  Progress silent;
  const double speed = 20.0;
  const Manoeuvre m = reference_manoeuvre();
  const VehicleTrajectory full = simulate(prototype, *m.driver, nullptr, options_of(speed, {}), silent);
  ScaledDriver driver(*m.driver, factors);
  const VehicleTrajectory back =
      scaled(simulate(twin, driver, nullptr, options_of(speed, factors), silent), factors.inverse());
  EXPECT_EQ(full.end, DriveEnd::kCompleted);
  EXPECT_EQ(full.size(), back.size());
  double worst = 0.0;
  const auto see = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      most = std::max(most, std::abs(a[i]));
      difference = std::max(difference, std::abs(a[i] - b[i]));
    }
    if (most > 0.0) worst = std::max(worst, difference / most);
  };
  see(full.time, back.time);
  see(full.x, back.x);
  see(full.yaw, back.yaw);
  see(full.r, back.r);
  see(full.lateral_acceleration, back.lateral_acceleration);
  see(full.roll, back.roll);
  see(full.pitch, back.pitch);
  see(full.heave, back.heave);
  for (std::size_t i = 0; i < kWheels; ++i) {
    see(full.Fz[i], back.Fz[i]);
    see(full.Fy[i], back.Fy[i]);
    see(full.suspension_travel[i], back.suspension_travel[i]);
  }
  return worst;
}

FourWheelModel<double, SimpleMagicFormulaTyre<double>> load_dependent_car() {
  const SimpleMagicFormulaTyre<double> tyre{
      .stiffness = 70000.0, .nominal_load = 2700.0, .stiffness_saturation = 0.5, .mu_load = 0.1};
  return {road_car(), {tyre, tyre, tyre, tyre}, {.relaxation_length = 0.4}};
}

// Lift-off, load transfer and friction included: all of it scales where gravity does.
TEST(ScaledModel, ATwinUnderScaledGravityMovesSimilarly) {
  const VehicleParameters<double> p = road_car();
  const LinearTyre<double> front{.stiffness = p.C_f, .mu = 0.9}, rear{.stiffness = p.C_r, .mu = 0.9};
  const FourWheelModel<double, LinearTyre<double>> car(p, {front, front, rear, rear});
  const ScaledVehicle twin = scale({.parameters = p}, {.length_ratio = 0.2});
  const auto model = scaled(car, twin.factors);
  EXPECT_NEAR(model.options().gravity, twin.similar_gravity, 1e-14);
  EXPECT_LT(largest_difference(car, model, twin.factors), 1e-9);
}

TEST(ScaledModel, AFroudeTwinWithLoadScaledTyresMovesSimilarlyUnderOurGravity) {
  const ScaledVehicle twin = scale({.parameters = road_car()}, {.length_ratio = 0.2, .froude = true});
  const auto car = load_dependent_car();
  const auto model = scaled(car, twin.factors);
  EXPECT_NEAR(model.options().gravity, 9.80665, 1e-13);
  EXPECT_LT(largest_difference(car, model, twin.factors), 1e-9);
}

// The same twin at equal times under real gravity: not similar, by the gravity group.
TEST(ScaledModel, UnderRealGravityATwinAtEqualTimesIsAnotherCar) {
  const ScaledVehicle twin = scale({.parameters = road_car()}, {.length_ratio = 0.2});
  const auto car = load_dependent_car();
  FourWheelOptions options = scaled(car.options(), twin.factors);
  options.gravity = 9.80665;
  const auto similar = scaled(car, twin.factors);
  const FourWheelModel<double, SimpleMagicFormulaTyre<double>> real(similar.parameters(), similar.tyres(), options);
  EXPECT_LT(largest_difference(car, similar, twin.factors), 1e-9);
  EXPECT_GT(largest_difference(car, real, twin.factors), 0.1);
}

// Forces of a scaled tyre at scaled loads are the forces of the tyre, scaled.
TEST(ScaledModel, TyreFilesScaleWithTheirNominalLoad) {
  MagicFormulaTyre<double> tyre;
  tyre.coefficients.PDY2 = -0.15;
  tyre.coefficients.PKX3 = 0.2;
  tyre.range.load_min = 200.0;
  tyre.range.load_max = 9000.0;
  const ScaleFactors factors{.length = 0.2, .mass = 0.01, .speed = 0.3};
  const MagicFormulaTyre<double> small = scaled(tyre, factors);
  for (const double load : {100.0, 3000.0, 12000.0}) {
    const TyreForces<double> full = tyre.forces(load, 0.03, 0.05, 0.01);
    const TyreForces<double> model = small.forces(load * factors.force(), 0.03, 0.05, 0.01);
    EXPECT_NEAR(model.Fy, full.Fy * factors.force(), 1e-11);
    EXPECT_NEAR(model.Fx, full.Fx * factors.force(), 1e-11);
    EXPECT_NEAR(small.cornering_stiffness(load * factors.force()), tyre.cornering_stiffness(load) * factors.force(),
                1e-9);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
