#include "veridyn/vehicle/identification/fit/estimated_vehicle.hpp"

#include <gtest/gtest.h>

#include <variant>
#include <vector>

#include "veridyn/core/study.hpp"

namespace veridyn::vehicle {
namespace {

estimation::Parameter identified(const char* name, double value) {
  estimation::Parameter p;
  p.name = name;
  p.value = value;
  p.status = estimation::ParameterStatus::kIdentified;
  return p;
}

Vehicle car() {
  Vehicle vehicle;
  vehicle.name = "car";
  vehicle.parameters.mass = 1400.0;
  vehicle.parameters.a = 1.2;
  vehicle.parameters.b = 1.5;
  return vehicle;
}

TEST(EstimatedParameters, AreWhatIsDeterminedOnTheSameWheelbase) {
  using estimation::ParameterStatus;
  const VehicleParameters<double> start = car().parameters;
  const std::vector<estimation::Parameter> parameters = {
      {.name = "C_f", .value = 5e4, .status = ParameterStatus::kIdentified},
      {.name = "C_r", .value = 7e4, .status = ParameterStatus::kNotExcited},
      {.name = "a", .value = 1.3, .status = ParameterStatus::kIdentified},
      {.name = "mu", .value = 0.8, .status = ParameterStatus::kNotExcited}};
  const VehicleParameters<double> p = estimated_parameters(start, parameters);
  EXPECT_EQ(p.C_f, 5e4);
  EXPECT_EQ(p.C_r, start.C_r);
  EXPECT_EQ(p.I_z, start.I_z);
  EXPECT_EQ(p.a, 1.3);
  EXPECT_DOUBLE_EQ(p.wheelbase(), start.wheelbase());
  EXPECT_EQ(p.mu, 0.8) << "fitted together with C_f";
}

TEST(EstimatedVehicle, HasTheTyresOfTheStructureThatWasIdentified) {
  const std::vector<estimation::Parameter> linear{identified("C_f", 61000.0), identified("C_r", 72000.0),
                                                  identified("I_z", 2100.0)};
  Vehicle vehicle = estimated_vehicle(car(), linear, {});
  EXPECT_EQ(vehicle.parameters.I_z, 2100.0);
  EXPECT_EQ(std::get<AxleTyres<LinearTyre<double>>>(vehicle.tyres).rear.stiffness, 72000.0);
  std::vector<estimation::Parameter> saturating = linear;
  saturating.push_back(identified("mu", 0.9));
  saturating.push_back(identified("relaxation_length", 0.35));
  vehicle = estimated_vehicle(car(), saturating, {});
  EXPECT_EQ(std::get<AxleTyres<FialaTyre<double>>>(vehicle.tyres).front.mu, 0.9);
  EXPECT_EQ(vehicle.relaxation_length, 0.35);
  DriveModelOptions held;
  held.tyre = kDriveTyre<SimpleMagicFormulaTyre>;
  held.start[DriveUnknown::kShape] = 1.35;
  vehicle = estimated_vehicle(car(), saturating, held);
  EXPECT_EQ(std::get<AxleTyres<SimpleMagicFormulaTyre<double>>>(vehicle.tyres).front.C, 1.35);
  saturating.push_back(identified("C", 1.4));
  saturating.push_back(identified("E", -0.3));
  saturating.back().status = estimation::ParameterStatus::kNotExcited;  // as its prior has it, and a part of the curve
  vehicle = estimated_vehicle(car(), saturating, {});
  const auto& tyres = std::get<AxleTyres<SimpleMagicFormulaTyre<double>>>(vehicle.tyres);
  EXPECT_EQ(tyres.rear.stiffness, 72000.0);
  EXPECT_EQ(tyres.front.C, 1.4);
  EXPECT_EQ(tyres.rear.E, -0.3);
  // The static loads of one wheel: what the model was identified with.
  EXPECT_NEAR(tyres.front.nominal_load, 0.5 * 1400.0 * kGravity * 1.5 / 2.7, 1e-9);
}

TEST(EstimatedVehicle, KeepsWhatWasNotExcited) {
  std::vector<estimation::Parameter> parameters{identified("C_f", 61000.0), identified("a", 1.3)};
  parameters[0].status = estimation::ParameterStatus::kNotExcited;
  const Vehicle vehicle = estimated_vehicle(car(), parameters, {});
  EXPECT_EQ(vehicle.parameters.C_f, car().parameters.C_f);
  EXPECT_EQ(vehicle.parameters.a, 1.3);
  EXPECT_NEAR(vehicle.parameters.b, 1.4, 1e-12);
  EXPECT_EQ(vehicle.tyre_text, "linear");
}

// What identification writes is what simulation reads: shape, curvature, friction and relaxation with it.
TEST(EstimatedVehicle, IsReadFromItsTomlAsItIs) {
  const std::vector<estimation::Parameter> parameters{identified("C_f", 61000.0),
                                                      identified("C_r", 72000.0),
                                                      identified("I_z", 2100.0),
                                                      identified("mu", 0.9),
                                                      identified("C", 1.4),
                                                      identified("E", -0.3),
                                                      identified("relaxation_length", 0.35)};
  const Vehicle vehicle = estimated_vehicle(car(), parameters, {});
  const Study study = Study::parse(write_vehicle_toml(vehicle), "subject.toml");
  const Vehicle read = read_vehicle(study.root().table("subject"), VehicleNeeds::kBicycle);
  EXPECT_EQ(read.relaxation_length, 0.35);
  const auto& there = std::get<AxleTyres<SimpleMagicFormulaTyre<double>>>(read.tyres).front;
  const auto& here = std::get<AxleTyres<SimpleMagicFormulaTyre<double>>>(vehicle.tyres).front;
  for (const double slip : {0.01, 0.05, 0.2})
    EXPECT_NEAR(there.forces(3000.0, 0.0, slip, 0.0).Fy, here.forces(3000.0, 0.0, slip, 0.0).Fy, 1e-6);
}

}  // namespace
}  // namespace veridyn::vehicle
