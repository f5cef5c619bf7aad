#include "veridyn/vehicle/vehicle_study.hpp"

#include <gtest/gtest.h>

#include "tests/vehicle/simulated_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;

TEST(VehicleStudy, IdentifiesARecordingThatItIsGiven) {
  const Study study = Study::parse(
      "seed = 3\n[subject]\nkind = \"vehicle\"\nname = \"car\"\nmass = 1500\na = 1.2\nb = 1.5\n[identify]\nmethod = "
      "\"output error\"\n[identify.uncertainty]\nmass = \"15 kg\"\n",
      "study.toml");
  Progress silent;
  VehicleStudy read =
      read_study(study, record_drive(lively_drive(family_car(), 1), reference_drive_sensors(), 1), silent);
  study.root().finish();
  EXPECT_EQ(read.identify.mass_sigma, 15.0);
  EXPECT_EQ(read.vehicle.I_z, 1500.0 * 1.2 * 1.5);
  VehicleAnalysis analysis = identify(read, silent);
  const estimation::Parameter* C_f = analysis.estimate.find("C_f");
  ASSERT_NE(C_f, nullptr);
  EXPECT_LE(C_f->low95, 55000.0);
  EXPECT_GE(C_f->high95, 55000.0);
  EXPECT_GT(analysis.estimate.validation.at("yaw_rate").r2, 0.99);
  // On another drive: held-out data.
  VehicleStudy other =
      read_study(study, record_drive(lively_drive(family_car(), 9), reference_drive_sensors(), 9), silent);
  const VehicleAnalysis validated = validate(other, analysis.estimate, silent);
  EXPECT_EQ(validated.identification.verdict, estimation::GroupVerdict::kIdentified) << validated.identification.reason;
  EXPECT_GT(validated.estimate.validation.at("yaw_rate").r2, 0.99);
}

}  // namespace
}  // namespace veridyn::vehicle
