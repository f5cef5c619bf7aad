#include "veridyn/vehicle/identification/evidence/vehicle_plausibility.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "veridyn/vehicle/model/builtin_vehicles.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Outcome;
using estimation::Parameter;

Parameter determined(std::string name, double value, double sigma) {
  return {.name = std::move(name),
          .value = value,
          .sigma = sigma,
          .unit = "1",
          .status = estimation::ParameterStatus::kIdentified};
}

Outcome worst(const std::vector<Parameter>& parameters, const VehicleParameters<double>& known) {
  Outcome outcome = Outcome::kPassed;
  for (const auto& row : plausibility(parameters, known)) outcome = std::max(outcome, row.outcome);
  return outcome;
}

TEST(VehiclePlausibility, PassesTheBuiltInVehicles) {
  for (const BuiltinVehicle& builtin : builtin_vehicles()) {
    const VehicleParameters<double>& p = builtin.parameters;
    const std::vector<Parameter> parameters{determined("C_f", p.C_f, 0.01 * p.C_f),
                                            determined("C_r", p.C_r, 0.01 * p.C_r),
                                            determined("I_z", p.I_z, 0.01 * p.I_z)};
    EXPECT_EQ(plausibility(parameters, p).size(), 3U);
    EXPECT_EQ(worst(parameters, p), Outcome::kPassed) << builtin.name;
  }
}

TEST(VehiclePlausibility, RefusesWhatNoVehicleHas) {
  VehicleParameters<double> known;
  known.mass = 1200.0;
  known.a = 1.2;
  known.b = 1.4;  // m a b: 2016 kg m^2
  EXPECT_EQ(worst({determined("I_z", 61e3, 600.0)}, known), Outcome::kFailed);
  EXPECT_EQ(worst({determined("I_z", 5e3, 50.0)}, known), Outcome::kCare);
  EXPECT_EQ(worst({determined("I_z", 5e3, 800.0)}, known), Outcome::kPassed) << "not beyond its error";
  EXPECT_EQ(worst({determined("mu", 5.0, 0.1)}, known), Outcome::kFailed);
  EXPECT_EQ(bound_rows(std::vector{determined("mu", 0.9, 1e-113)}).size(), 1U) << "a search that ended at a bound";
  for (const char* stiffness : {"C_f", "C_r"})
    EXPECT_EQ(worst({determined(stiffness, 2e3, 10.0)}, known), Outcome::kFailed) << "a stiffness in N/deg";
}

TEST(VehiclePlausibility, SaysWhatEndedAtItsBound) {
  Parameter p = determined("mu", 3.0, 0.1);
  EXPECT_TRUE(bound_rows(std::vector{p}).empty());
  p.status = estimation::ParameterStatus::kAtBound;
  const auto rows = bound_rows(std::vector{p});
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows.front().about, "mu");
  EXPECT_EQ(rows.front().outcome, Outcome::kFailed);
}

TEST(VehiclePlausibility, ComparesUndersteerAsAnAnglePerG) {
  VehicleParameters<double> known;
  known.mass = 1200.0;
  known.a = known.b = 1.3;
  EXPECT_EQ(worst({determined("understeer_gradient", 0.005, 1e-4)}, known), Outcome::kPassed);
  EXPECT_EQ(worst({determined("understeer_gradient", 0.03, 1e-3)}, known), Outcome::kCare);
  EXPECT_EQ(worst({determined("understeer_gradient", -0.05, 1e-3)}, known), Outcome::kFailed);
}

TEST(VehiclePlausibility, SaysNothingOfWhatWasNotDetermined) {
  Parameter p = determined("I_z", 61e3, 0.0);
  p.status = estimation::ParameterStatus::kNotExcited;
  VehicleParameters<double> known;
  known.mass = 1200.0;
  known.a = known.b = 1.3;
  EXPECT_TRUE(plausibility(std::vector{p}, known).empty());
}

}  // namespace
}  // namespace veridyn::vehicle
