#include "veridyn/vehicle/identification/fit/estimated_drive_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace veridyn::vehicle {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// An estimate of these values, with variances 1, 2, 3 ... and covariances of a tenth.
estimation::Estimate estimate_of(const std::vector<std::pair<const char*, double>>& values) {
  estimation::Estimate e;
  for (const auto& [name, value] : values) {
    estimation::Parameter p;
    p.name = name;
    p.value = value;
    e.parameters.push_back(p);
  }
  const auto n = static_cast<Eigen::Index>(values.size());
  e.covariance = Eigen::MatrixXd::Constant(n, n, 0.1);
  e.covariance.diagonal() = Eigen::VectorXd::LinSpaced(n, 1.0, static_cast<double>(n));
  return e;
}

VehicleParameters<double> car_of_2700_mm() {
  VehicleParameters<double> p;
  p.a = 1.2;
  p.b = 1.5;
  return p;
}

TEST(EstimatedDriveModel, HasTheEstimatesValuesAndTheWheelbase) {
  const EstimatedDriveModel model = estimated_drive_model(
      estimate_of({{"C_f", 50e3}, {"C_r", 60e3}, {"I_z", 2400.0}, {"a", 1.3}, {"steer_delay", 0.05}}), car_of_2700_mm(),
      {});
  EXPECT_EQ(model.vehicle.C_f, 50e3);
  EXPECT_EQ(model.vehicle.C_r, 60e3);
  EXPECT_EQ(model.vehicle.I_z, 2400.0);
  EXPECT_EQ(model.vehicle.a, 1.3);
  EXPECT_DOUBLE_EQ(model.vehicle.wheelbase(), 2.7);
  EXPECT_EQ(model.options.start[DriveUnknown::kSteerDelay], 0.05);
  EXPECT_THAT(model.missing, IsEmpty());
}

TEST(EstimatedDriveModel, NamesWhatItDoesNotHave) {
  const EstimatedDriveModel model = estimated_drive_model(
      estimate_of({{"C_f", 50e3}, {"I_z", std::numeric_limits<double>::quiet_NaN()}}), car_of_2700_mm(), {});
  EXPECT_THAT(model.missing, ElementsAre("C_r", "I_z"));
  EXPECT_EQ(model.vehicle.I_z, car_of_2700_mm().I_z) << "what is unknown stays as it was given";
}

TEST(EstimatedDriveModel, CovarianceLiesAtTheUnknownsPlaces) {
  const EstimatedDriveModel model = estimated_drive_model(
      estimate_of({{"I_z", 2400.0}, {"understeer_gradient", 0.002}, {"C_f", 50e3}}), car_of_2700_mm(), {});
  const auto at = [](DriveUnknown u) { return static_cast<Eigen::Index>(u); };
  EXPECT_EQ(model.covariance(at(DriveUnknown::kIz), at(DriveUnknown::kIz)), 1.0);
  EXPECT_EQ(model.covariance(at(DriveUnknown::kCf), at(DriveUnknown::kCf)), 3.0);
  EXPECT_EQ(model.covariance(at(DriveUnknown::kCf), at(DriveUnknown::kIz)), 0.1);
  EXPECT_DOUBLE_EQ(model.covariance.sum(), 1.0 + 3.0 + 2.0 * 0.1) << "of what is no unknown there is nothing";
}

// Offsets of sensors are of the drive that was identified, scales and delays of the instruments.
TEST(EstimatedDriveModel, LeavesBiasesToTheDrive) {
  std::vector<std::pair<const char*, double>> all;
  for (const DriveUnknown u : kAllDriveUnknowns) all.emplace_back(kDriveUnknownNames[u].data(), 0.25);
  DriveModelOptions options;
  for (double& start : options.start) start = -1.0;
  const EstimatedDriveModel model = estimated_drive_model(estimate_of(all), car_of_2700_mm(), options);
  for (const DriveUnknown u : kAllDriveUnknowns) {
    const bool of_vehicle = u <= DriveUnknown::kA;
    EXPECT_EQ(model.options.start[u], of_vehicle || is_bias(u) ? -1.0 : 0.25) << kDriveUnknownNames[u];
  }
}

TEST(EstimatedDriveModel, KnowsTheStructureByItsUnknowns) {
  const auto with = [](std::vector<std::pair<const char*, double>> more) {
    more.insert(more.end(), {{"C_f", 50e3}, {"C_r", 60e3}, {"I_z", 2400.0}});
    return estimated_drive_model(estimate_of(more), car_of_2700_mm(), {}).options;
  };
  EXPECT_EQ(with({}).structure, DriveStructure::kBicycle);
  EXPECT_EQ(with({}).tyre, kDriveTyre<LinearTyre>);
  EXPECT_EQ(with({{"roll_gradient", 0.009}}).structure, DriveStructure::kRoll);
  EXPECT_EQ(with({{"roll_gradient", 0.009}, {"relaxation_length", 0.4}}).structure, DriveStructure::kRelaxation);
  const DriveModelOptions fiala = with({{"roll_gradient", 0.009}, {"relaxation_length", 0.4}, {"mu", 0.9}});
  EXPECT_EQ(fiala.structure, DriveStructure::kSaturation);
  EXPECT_EQ(fiala.tyre, kDriveTyre<FialaTyre>);
  const DriveModelOptions formula = with({{"roll_gradient", 0.009}, {"mu", 0.9}, {"C", 1.4}});
  EXPECT_EQ(formula.structure, DriveStructure::kMagicFormula);
  EXPECT_EQ(formula.tyre, kDriveTyre<SimpleMagicFormulaTyre>);
  EXPECT_EQ(formula.start[DriveUnknown::kRelaxationLength], 0.0) << "slips of tyres that were found not to lag";
  EXPECT_EQ(with({{"mu", 0.9}}).structure, DriveStructure::kBicycle);
  EXPECT_TRUE(with({{"downforce_f", 3e-4}}).effects[DriveEffect::kDownforce]);
  EXPECT_TRUE(with({{"load_sensitivity", 0.8}}).effects[DriveEffect::kPedals]);
  EXPECT_FALSE(with({}).effects[DriveEffect::kDownforce]);
}

TEST(EstimatedDriveModel, KnowsABankByTheStructuresName) {
  estimation::Estimate e = estimate_of({{"C_f", 50e3}});
  EXPECT_FALSE(estimated_drive_model(e, car_of_2700_mm(), {}).options.effects[DriveEffect::kBank]);
  e.structure = "rolling bicycle, " + std::string(kDriveEffectNames[DriveEffect::kBank]);
  EXPECT_TRUE(estimated_drive_model(e, car_of_2700_mm(), {}).options.effects[DriveEffect::kBank]);
}

}  // namespace
}  // namespace veridyn::vehicle
