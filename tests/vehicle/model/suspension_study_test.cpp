#include "veridyn/vehicle/model/suspension_study.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/described_car.hpp"

namespace veridyn::vehicle {
namespace {

using testing::read_drive_study;

constexpr const char* kSuspension = R"(aligning_moment = true
[subject.tyres]
pneumatic_trail = "30 mm"
[subject.suspension]
roll_centre_f = "60 mm"
roll_centre_r = 0.11
roll_steer_r = "0.05 rad/rad"
bump_steer_f = "-3 deg/m"
compliance_steer_f = "-0.2 deg/kN"
travel_r = [-0.08, 0.0, "80 mm"]
force_r = [-1600.0, 0.0, "2.4 kN"]
[subject.aerodynamics]
lift_area_f = 0.08
lift_area_r = -0.1
drag_area = 0.7
air_density = 1.1
)";

TEST(SuspensionStudy, ReadsWhatItSaysIntoTheModelsOptions) {
  const SimulationStudy s = read_drive_study(std::string(kSuspension) + "[drive]\nspeed = 20\n");
  const FourWheelOptions& o = s.four_wheel;
  EXPECT_TRUE(o.aligning_moment);
  EXPECT_EQ(o.suspension_f.roll_centre, 0.06);
  EXPECT_EQ(o.suspension_r.roll_centre, 0.11);
  EXPECT_EQ(o.suspension_r.roll_steer, 0.05);
  EXPECT_NEAR(o.suspension_f.bump_steer, -3.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_NEAR(o.suspension_f.compliance_steer, -0.2e-3 * std::numbers::pi / 180.0, 1e-18);
  EXPECT_TRUE(o.suspension_f.spring.empty());
  EXPECT_NEAR(o.suspension_r.spring.force(0.08), 2400.0, 1e-9);
  EXPECT_NEAR(s.vehicle.parameters.K_sr, o.suspension_r.spring.rate(0.0), 1e-9);
  EXPECT_EQ(s.vehicle.parameters.K_sf, 19000.0);
  EXPECT_EQ(o.lift.area_f, 0.08);
  EXPECT_EQ(o.lift.area_r, -0.1);
  EXPECT_EQ(o.lift.air_density, 1.1);
  EXPECT_EQ(s.vehicle.longitudinal.drag_area, 0.7);
  EXPECT_EQ(s.vehicle.longitudinal.air_density, 1.1);
}

TEST(SuspensionStudy, IsOffWhereNothingIsSaid) {
  const SimulationStudy s = read_drive_study("[drive]\nspeed = 20\n");
  EXPECT_FALSE(s.four_wheel.suspension_f.steers() || s.four_wheel.suspension_r.steers() || s.four_wheel.lift.acts());
  EXPECT_EQ(s.four_wheel.suspension_f.roll_centre, 0.0);
  EXPECT_FALSE(s.four_wheel.aligning_moment);
  EXPECT_EQ(write_suspension_toml({}, {}, {}), "");
}

TEST(SuspensionStudy, WrittenVehicleReadsBackToTheSameSuspension) {
  const SimulationStudy one = read_drive_study(std::string(kSuspension) + "[drive]\nspeed = 20\n");
  const std::string written = write_vehicle_toml(one.vehicle);
  const SimulationStudy two = read_drive_study("[drive]\nspeed = 20\n", written);
  EXPECT_EQ(write_vehicle_toml(two.vehicle), written);
  EXPECT_EQ(two.four_wheel.suspension_f.compliance_steer, one.four_wheel.suspension_f.compliance_steer);
  EXPECT_EQ(two.four_wheel.suspension_r.spring.force(0.05), one.four_wheel.suspension_r.spring.force(0.05));
  EXPECT_EQ(two.four_wheel.lift.area_r, -0.1);
  EXPECT_TRUE(two.four_wheel.aligning_moment);
}

TEST(SuspensionStudy, RefusesInOneLine) {
  const auto refused = [](const std::string& more) {
    return why([&] { (void)read_drive_study(more + "\n[drive]\nspeed = 20\n"); });
  };
  EXPECT_NE(refused("[subject.suspension]\nroll_centre_f = 60").find("roll_centre_f is 60 m; must be between -5 and 5"),
            std::string::npos);
  EXPECT_NE(refused("[subject.suspension]\nroll_center_f = 0.1").find("did you mean 'roll_centre_f'"),
            std::string::npos);
  EXPECT_NE(refused("[subject.suspension]\ntravel_f = [0, 0.1]\nforce_f = [0, 0]").find("row 2 (0.1 m, 0 N)"),
            std::string::npos);
  EXPECT_NE(refused("[subject.suspension]\ntravel_f = [0, 0.1]").find("force_f"), std::string::npos);
  EXPECT_NE(refused("K_sf = 2e4\n[subject.suspension]\ntravel_f = [0, 0.1]\nforce_f = [0, 2000]")
                .find("takes the place of K_sf"),
            std::string::npos);
  EXPECT_NE(refused("[subject.aerodynamics]\nlift_area_r = 1000").find("lift_area_r is 1000 m^2; must be between"),
            std::string::npos);
  EXPECT_NE(refused("[subject.longitudinal]\ndrag_area = 0.6\n[subject.aerodynamics]\ndrag_area = 0.7")
                .find("is also in [subject.longitudinal]"),
            std::string::npos);
  EXPECT_NE(refused("aligning_moment = true").find("needs the tyres' pneumatic_trail"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
