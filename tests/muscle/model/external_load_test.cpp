#include "veridyn/muscle/model/external_load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A plate's columns, 100 samples a second: force, point, torque by OpenSim's usual names.
SignalTable plate() {
  SignalTable table{.source = "grf.mot", .names = {}, .time = {}, .values = {}};
  for (const char* name :
       {"ground_force_vx", "ground_force_vy", "ground_force_vz", "ground_force_px", "ground_force_py",
        "ground_force_pz", "ground_torque_x", "ground_torque_y", "ground_torque_z"})
    table.names.emplace_back(name);
  table.values.resize(9);
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.01 * i;
    table.time.push_back(t);
    const double row[] = {10.0 * t, 700.0 + 20.0 * std::sin(3.0 * t), -5.0, 0.1 + 0.2 * t, 0.0, 0.05, 0.0, 1.0, 0.0};
    for (std::size_t c = 0; c < 9; ++c) table.values[c].push_back(row[c]);
  }
  return table;
}

ExternalLoadSource right_foot() {
  return {.name = "right",
          .place = "grf.xml:5",
          .body = "foot_r",
          .force = "ground_force_v",
          .point = "ground_force_p",
          .moment = "ground_torque_"};
}

ExternalLoads loads_of(const ExternalLoadSource& source, const SignalTable& table, double low_pass_Hz = 0.0) {
  ExternalLoads loads;
  add_external_loads({&source, 1}, &table, load_model("legs").model(), low_pass_Hz, loads);
  return loads;
}

std::string load_error(const ExternalLoadSource& source, const SignalTable& table, double low_pass_Hz = 0.0) {
  try {
    static_cast<void>(loads_of(source, table, low_pass_Hz));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

double value_at(const numerics::PiecewisePolynomial& f, double time) { return f.evaluate(time).value; }

TEST(ExternalLoad, ForceAndPointOfOneFrameBecomeTheMomentAboutItsOrigin) {
  const ExternalLoads loads = loads_of(right_foot(), plate());
  ASSERT_EQ(loads.loads.size(), 1u);
  EXPECT_DOUBLE_EQ(loads.begin, 0.0);
  EXPECT_DOUBLE_EQ(loads.end, 1.0);
  const ExternalLoad& load = loads.loads[0];
  const double t = 0.4;
  const Eigen::Vector3d f(10.0 * t, 700.0 + 20.0 * std::sin(3.0 * t), -5.0), p(0.1 + 0.2 * t, 0.0, 0.05);
  const Eigen::Vector3d m = p.cross(f) + Eigen::Vector3d(0.0, 1.0, 0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(value_at(load.force[i], t), f(i), 1e-9);
    EXPECT_NEAR(value_at(load.moment[i], t), m(i), 1e-9);
    EXPECT_EQ(value_at(load.point[i], t), 0.0);
  }
  // Between samples a cubic spline: its error is a four hundredth of h^4 f''''.
  EXPECT_NEAR(value_at(load.force[1], 0.505), 700.0 + 20.0 * std::sin(3.0 * 0.505), 1e-7);
}

TEST(ExternalLoad, APointOfAnotherFrameStaysAPoint) {
  ExternalLoadSource source = right_foot();
  source.point_frame = "/bodyset/tibia_r";
  const ExternalLoads loads = loads_of(source, plate());
  EXPECT_EQ(loads.loads[0].point_frame, load_model("legs").model().body("tibia_r"));
  EXPECT_NEAR(value_at(loads.loads[0].point[0], 0.4), 0.18, 1e-9);
  EXPECT_NEAR(value_at(loads.loads[0].moment[1], 0.4), 1.0, 1e-12);
}

TEST(ExternalLoad, WithoutAPointTheForceActsAtTheBodysOrigin) {
  ExternalLoadSource source = right_foot();
  source.point.clear();
  const ExternalLoads loads = loads_of(source, plate());
  EXPECT_EQ(loads.loads[0].point_frame, loads.loads[0].body);
  EXPECT_EQ(value_at(loads.loads[0].point[0], 0.4), 0.0);
}

TEST(ExternalLoad, ColumnsAreFoundByLettersNumbersOrBeingTheOnlyThree) {
  SignalTable table = plate();
  table.names[0] = "ground_force_v1", table.names[1] = "ground_force_v2", table.names[2] = "ground_force_v3";
  EXPECT_NEAR(value_at(loads_of(right_foot(), table).loads[0].force[2], 0.2), -5.0, 1e-12);
  table.names[0] = "ground_force_v_ap", table.names[1] = "ground_force_v_up", table.names[2] = "ground_force_v_ml";
  EXPECT_NEAR(value_at(loads_of(right_foot(), table).loads[0].force[2], 0.2), -5.0, 1e-12);
}

TEST(ExternalLoad, ALowPassTakesNoiseOffForcesAndMoments) {
  SignalTable table = plate();
  for (std::size_t i = 0; i < table.time.size(); ++i)
    table.values[1][i] += 50.0 * std::sin(2.0 * kPi * 30.0 * table.time[i]);
  const ExternalLoads loads = loads_of(right_foot(), table, 6.0);
  // 60 dB at 9 Hz and above: of 50 N stay 0.05 N.
  for (const double t : {0.3, 0.5, 0.7})
    EXPECT_NEAR(value_at(loads.loads[0].force[1], t), 700.0 + 20.0 * std::sin(3.0 * t), 0.1) << t;
}

TEST(ExternalLoad, WhatIsWrongIsSaidInALine) {
  ExternalLoadSource source = right_foot();
  source.body = "foot";
  EXPECT_THAT(load_error(source, plate()),
              AllOf(HasSubstr("grf.xml:5: body 'foot' is no body of model 'legs'"), HasSubstr("did you mean 'foot_")));
  source = right_foot();
  source.body = "ground";
  EXPECT_THAT(load_error(source, plate()), HasSubstr("acts on the ground"));
  source = right_foot();
  source.force_frame = "calcn_r";
  EXPECT_THAT(load_error(source, plate()), HasSubstr("force frame 'calcn_r' is no body"));
  source = right_foot();
  source.force = "1_ground_force_v";
  EXPECT_THAT(load_error(source, plate()), AllOf(HasSubstr("force '1_ground_force_v': grf.mot has no columns"),
                                                 HasSubstr("did you mean 'ground_force_vx'")));
  source.force = "ground_force_";
  EXPECT_THAT(load_error(source, plate()), HasSubstr("6 columns of grf.mot begin so, three are needed"));
  SignalTable table = plate();
  table.values[4][33] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(load_error(right_foot(), table), HasSubstr("column 'ground_force_py' has no value at 0.33 s"));
  EXPECT_THAT(load_error(right_foot(), plate(), 60.0), HasSubstr("a low-pass of 60 Hz needs more than 180 samples"));
}

TEST(ExternalLoad, ConstantsNeedNoTable) {
  ExternalLoadSource source{.name = "push", .place = "s.toml:9", .body = "pelvis"};
  source.constant_force = {50.0, 0.0, 0.0};
  ExternalLoads loads;
  add_external_loads({&source, 1}, nullptr, load_model("legs").model(), 0.0, loads);
  EXPECT_EQ(value_at(loads.loads[0].force[0], 12.0), 50.0);
  EXPECT_TRUE(std::isinf(loads.end));
  source.force = "f";
  EXPECT_THROW(add_external_loads({&source, 1}, nullptr, load_model("legs").model(), 0.0, loads), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
