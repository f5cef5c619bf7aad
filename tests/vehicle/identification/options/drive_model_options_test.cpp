#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/identification/options/drive_budget.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using ::testing::HasSubstr;
using ::testing::StartsWith;

DriveModelOptions read_options(const std::string& keys) {
  const Study study = Study::parse("[identify]\n" + keys, "study.toml");
  DriveModelOptions options;
  DriveModelOptions::keys().read(study.root().table("identify"), options);
  return options;
}

/// The unknowns of roll and relaxation.
constexpr std::array kOfStructures{DriveUnknown::kRollGradient, DriveUnknown::kRollFrequency,
                                   DriveUnknown::kRollDamping, DriveUnknown::kRollArm, DriveUnknown::kRelaxationLength};

TEST(DriveModelOptions, TakeFromTheVehicleWhatIsNotGiven) {
  const VehicleParameters<double> car = family_car();
  const DriveModelOptions o = with_geometry({}, car, 0.0);
  EXPECT_EQ(o.start[DriveUnknown::kCf], car.C_f);
  EXPECT_EQ(o.start[DriveUnknown::kCr], car.C_r);
  EXPECT_EQ(o.start[DriveUnknown::kIz], car.I_z);
  EXPECT_EQ(o.start[DriveUnknown::kA], car.a);
  for (const DriveUnknown u : {DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA})
    EXPECT_TRUE(std::isinf(o.prior[u])) << kDriveUnknownNames[u];
  // 5 deg/g, half of it either way.
  EXPECT_NEAR(o.start[DriveUnknown::kRollGradient], 5.0 * kDegree / kGravity, 1e-5);
  EXPECT_NEAR(o.prior[DriveUnknown::kRollGradient], 0.5 * o.start[DriveUnknown::kRollGradient], 1e-15);
  EXPECT_NEAR(o.start[DriveUnknown::kRollArm], 0.85 * car.cg_height, 1e-15);
  EXPECT_NEAR(o.prior[DriveUnknown::kRollArm], 0.4 * car.cg_height, 1e-15);
  EXPECT_NEAR(o.start[DriveUnknown::kRelaxationLength], 0.12 * 2.7, 1e-15);
  EXPECT_NEAR(o.prior[DriveUnknown::kRelaxationLength], 0.06 * 2.7, 1e-15);
  for (const DriveUnknown u : kAllDriveUnknowns) {
    EXPECT_TRUE(std::isfinite(o.start[u])) << kDriveUnknownNames[u];
    EXPECT_GT(o.prior[u], 0.0) << kDriveUnknownNames[u];
  }
}

// A car of one fifth of the size: lengths are a fifth, and times the root of it.
TEST(DriveModelOptions, ScaleWithTheVehicle) {
  const VehicleParameters<double> car = family_car();
  VehicleParameters<double> small = car;
  for (double* length : {&small.a, &small.b, &small.cg_height}) *length /= 5.0;
  const DriveModelOptions large = with_geometry({}, car, 0.0), scaled = with_geometry({}, small, 0.0);
  for (const DriveUnknown u : {DriveUnknown::kRollArm, DriveUnknown::kRelaxationLength}) {
    EXPECT_NEAR(large.start[u] / scaled.start[u], 5.0, 1e-12) << kDriveUnknownNames[u];
    EXPECT_NEAR(large.prior[u] / scaled.prior[u], 5.0, 1e-12) << kDriveUnknownNames[u];
  }
  const auto frequency = DriveUnknown::kRollFrequency;
  EXPECT_NEAR(scaled.start[frequency] / large.start[frequency], std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(scaled.prior[frequency] / scaled.start[frequency], 0.4, 1e-12);
  for (const DriveUnknown u : {DriveUnknown::kRollGradient, DriveUnknown::kRollDamping})  // the same at any size
    EXPECT_EQ(scaled.start[u], large.start[u]) << kDriveUnknownNames[u];
}

TEST(DriveModelOptions, KeepWhatIsGiven) {
  DriveModelOptions given;
  double value = 0.01;
  for (const DriveUnknown u : kAllDriveUnknowns) {
    given.start[u] = value += 0.01;
    given.prior[u] = value += 0.01;
  }
  given.prior[DriveUnknown::kRollArm] = kInfinity;  // "none"
  const DriveModelOptions o = with_geometry(given, family_car(), 0.005);
  for (const DriveUnknown u : kAllDriveUnknowns) {
    EXPECT_EQ(o.start[u], given.start[u]) << kDriveUnknownNames[u];
    EXPECT_EQ(o.prior[u], given.prior[u]) << kDriveUnknownNames[u];
  }
  // A start alone leaves the prior's width to the geometry, and the other way round.
  const DriveModelOptions half = with_geometry(
      read_options("start = { roll_arm = 0.3 }\nprior = { relaxation_length = 0.01 }"), family_car(), 0.0);
  const DriveModelOptions none = with_geometry({}, family_car(), 0.0);
  EXPECT_EQ(half.start[DriveUnknown::kRollArm], 0.3);
  EXPECT_EQ(half.prior[DriveUnknown::kRollArm], none.prior[DriveUnknown::kRollArm]);
  EXPECT_EQ(half.start[DriveUnknown::kRelaxationLength], none.start[DriveUnknown::kRelaxationLength]);
  EXPECT_EQ(half.prior[DriveUnknown::kRelaxationLength], 0.01);
}

TEST(DriveModelOptions, NarrowThePriorOfARollGradientThatIsGiven) {
  const DriveModelOptions o = with_geometry({}, family_car(), 0.006);
  EXPECT_EQ(o.start[DriveUnknown::kRollGradient], 0.006);
  EXPECT_NEAR(o.prior[DriveUnknown::kRollGradient], 0.0012, 1e-15);
  EXPECT_EQ(o.start[DriveUnknown::kRollArm], with_geometry({}, family_car(), 0.0).start[DriveUnknown::kRollArm]);
}

TEST(DriveModelOptions, FreeTheUnknownsOfTheStructureAndNoOthers) {
  const DriveModelOptions plain = with_structure({}, DriveStructure::kBicycle);
  EXPECT_EQ(plain.free, DriveModelOptions().free);
  EXPECT_EQ(plain.structure, DriveStructure::kBicycle);
  const auto freed = [&](DriveStructure structure) {
    const DriveModelOptions o = with_structure({}, structure);
    EXPECT_EQ(o.structure, structure);
    std::string names;
    for (const DriveUnknown u : kAllDriveUnknowns) {
      EXPECT_GE(o.free[u], plain.free[u]) << kDriveUnknownNames[u];
      if (o.free[u] && !plain.free[u]) names += fmt::format("{} ", kDriveUnknownNames[u]);
    }
    return names;
  };
  EXPECT_EQ(freed(DriveStructure::kScaledAccel), "accel_y_scale ");
  EXPECT_EQ(freed(DriveStructure::kRoll),
            "roll_gradient roll_arm roll_frequency roll_damping roll_steer_f roll_steer_r accel_height ");
  EXPECT_EQ(
      freed(DriveStructure::kRelaxation),
      "roll_gradient roll_arm relaxation_length roll_frequency roll_damping roll_steer_f roll_steer_r accel_height ");
  EXPECT_EQ(
      freed(DriveStructure::kSaturation),
      "mu roll_gradient roll_arm relaxation_length load_transfer load_transfer_balance roll_frequency roll_damping "
      "roll_steer_f roll_steer_r accel_height ");
  EXPECT_EQ(with_structure({}, DriveStructure::kSaturation).tyre, kDriveTyre<FialaTyre>);
  EXPECT_EQ(freed(DriveStructure::kMagicFormula),
            "mu C E roll_gradient roll_arm relaxation_length load_transfer_loss load_transfer_balance "
            "roll_frequency roll_damping roll_steer_f roll_steer_r accel_height ");
  EXPECT_EQ(with_structure({}, DriveStructure::kMagicFormula).tyre, kDriveTyre<SimpleMagicFormulaTyre>);
}

// Down the ladder again nothing of the richer structure stays free.
TEST(DriveModelOptions, HoldTheUnknownsThatASimplerStructureDoesNotHave) {
  const DriveModelOptions rich = with_structure({}, DriveStructure::kRelaxation);
  EXPECT_EQ(with_structure(rich, DriveStructure::kBicycle).free, DriveModelOptions().free);
  const DriveModelOptions roll = with_structure(rich, DriveStructure::kRoll);
  EXPECT_FALSE(roll.free[DriveUnknown::kRelaxationLength]);
  EXPECT_TRUE(roll.free[DriveUnknown::kRollGradient]);
  // What the study frees stays so: it is no structure's.
  DriveModelOptions with_scale;
  with_scale.free[DriveUnknown::kSteerScale] = true;
  EXPECT_TRUE(with_structure(with_scale, DriveStructure::kRoll).free[DriveUnknown::kSteerScale]);
}

/// Of the budget: what no structure decides on.
bool is_free_by_default(DriveUnknown u) {
  return is_in_budget(u) && u != DriveUnknown::kRollSteerF && u != DriveUnknown::kRollSteerR &&
         u != DriveUnknown::kAccelHeight;
}

// Errors of sensors are unknowns whatever the study estimates, unless it knows them exactly.
TEST(DriveModelOptions, HaveTheBudgetFreeUnlessItIsKnown) {
  for (const DrivePrior& budget : kDriveBudget) {
    const DriveModelOptions plain = with_structure({}, DriveStructure::kRoll);
    EXPECT_TRUE(plain.free[budget.unknown]) << kDriveUnknownNames[budget.unknown];
    EXPECT_EQ(plain.start[budget.unknown], 0.0);
    EXPECT_EQ(plain.prior[budget.unknown], budget.sigma);
    const DriveModelOptions known = with_structure(
        read_options(fmt::format("estimate = [\"C_f\"]\nprior = {{ {} = 0 }}", kDriveUnknownNames[budget.unknown])),
        DriveStructure::kRoll);
    EXPECT_FALSE(known.free[budget.unknown]) << kDriveUnknownNames[budget.unknown];
    EXPECT_TRUE(known.free[DriveUnknown::kCf]);
  }
  // What is known has no prior: a search refuses one of no width.
  const DriveModelOptions known = read_options("prior = { steer_delay = 0, roll_steer_f = 0 }");
  for (const DriveUnknown u : {DriveUnknown::kSteerDelay, DriveUnknown::kRollSteerF}) {
    const estimation::ModelParameter p = model_parameter(u, with_structure(known, DriveStructure::kRoll), 2.7);
    EXPECT_TRUE(p.fixed);
    EXPECT_TRUE(std::isinf(p.prior_sigma));
  }
  EXPECT_THROW(read_options("prior = { trail = -1 }"), InputError);
  EXPECT_THROW(read_options("prior = { steer_bias = 0 }"), InputError);
}

TEST(DriveModelOptions, ReadWhatIsFreeAndWhereItBegins) {
  const DriveModelOptions o = read_options(
      "estimate = [\"C_f\", \"yaw_rate_delay\"]\nsmoothing = 3\n"
      "start = { C_f = 5e4, roll_frequency = 8 }\nprior = { steer_bias = \"2 deg\", accel_y_bias = \"none\" }");
  for (const DriveUnknown u : kAllDriveUnknowns)
    EXPECT_EQ(o.free[u], u == DriveUnknown::kCf || u == DriveUnknown::kYawRateDelay || is_free_by_default(u))
        << kDriveUnknownNames[u];
  EXPECT_EQ(o.smoothing_Hz, 3.0);
  EXPECT_EQ(o.start[DriveUnknown::kCf], 5e4);
  EXPECT_EQ(o.start[DriveUnknown::kRollFrequency], 8.0);
  EXPECT_NEAR(o.prior[DriveUnknown::kSteerBias], 2.0 * kDegree, 1e-15);
  EXPECT_EQ(o.prior[DriveUnknown::kAccelYBias], kInfinity);
  const DriveModelOptions magic = read_options("tyre = \"magic formula\"");
  EXPECT_EQ(magic.tyre, kDriveTyre<SimpleMagicFormulaTyre>);
  EXPECT_TRUE(magic.free[DriveUnknown::kMu] && magic.free[DriveUnknown::kShape]);
  EXPECT_FALSE(magic.free[DriveUnknown::kCurvature]);
  const DriveModelOptions brush = read_options("tyre = \"fiala\"");
  EXPECT_EQ(brush.tyre, kDriveTyre<FialaTyre>);
  EXPECT_TRUE(brush.free[DriveUnknown::kMu]);
  EXPECT_FALSE(brush.free[DriveUnknown::kShape] || brush.free[DriveUnknown::kCurvature]);
}

TEST(DriveModelOptions, RefuseByNameWhatTheStructureFrees) {
  for (const DriveUnknown u : kOfStructures) {
    const std::string name(kDriveUnknownNames[u]);
    const std::string message =
        why([&] { static_cast<void>(read_options("estimate = [\"C_f\", \"" + name + "\"]\n")); });
    EXPECT_THAT(message, StartsWith("study.toml:2:")) << name;
    EXPECT_THAT(message, HasSubstr("names " + name + ", which identify.structure frees or not"));
  }
  const auto refusal = [](const std::string& keys) { return why([&] { static_cast<void>(read_options(keys)); }); };
  EXPECT_THAT(refusal("estimate = [\"rol_arm\"]"), HasSubstr("'rol_arm' is not an unknown of the drive model"));
  EXPECT_THAT(refusal("estimate = [\"rol_arm\"]"), HasSubstr("'roll_arm'"));
  EXPECT_THAT(refusal("estimate = [\"E\"]"), HasSubstr("names E, which linear tyres do not have"));
  EXPECT_THAT(refusal("tyre = \"fiala\"\nestimate = [\"C\"]"), HasSubstr("names C, which fiala tyres do not have"));
  EXPECT_THAT(refusal("smoothing = -1"), HasSubstr("must be >= 0"));
  EXPECT_THAT(refusal("prior = { roll_damping = 0 }"), HasSubstr("roll_damping"));
  EXPECT_THAT(refusal("tyre = \"brush\""), HasSubstr("magic formula"));
}

}  // namespace
}  // namespace veridyn::vehicle
