#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/vehicle/manoeuvre/steer_at.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"

namespace veridyn::vehicle {
namespace {

using testing::steer;

Manoeuvre read(const std::string& text, const ManoeuvreContext& context = {},
               const std::filesystem::path& folder = {}) {
  const Study study = Study::parse("[drive]\n" + text, "study.toml", folder);
  const StudyTable drive = study.root().table("drive");
  Manoeuvre m = read_manoeuvre(drive, context, Progress());
  drive.finish();
  return m;
}

TEST(Manoeuvre, StudiesNameEveryOne) {
  EXPECT_EQ(read("").kind, ManoeuvreKind::kReference);
  EXPECT_NEAR(steer(read("manoeuvre = \"step steer\"\namplitude = \"3 deg\"\nstart = 2\nrise_time = 0.2"), 2.1),
              1.5 * kDegree, 1e-12);
  EXPECT_EQ(read("manoeuvre = \"sine\"\nfrequency = \"0.5 Hz\"").frequency, 0.5);
  EXPECT_NEAR(read("manoeuvre = \"continuous sine\"\nperiods = 4").default_duration, 1.0 + 8.0 + 4.0, 1e-12);
  EXPECT_EQ(read("manoeuvre = \"sine with dwell\"").frequency, 0.7);
  EXPECT_EQ(read("manoeuvre = \"sweep\"\nlow = 0.2\nhigh = 3\nlength = 30").end_frequency, 3.0);
  EXPECT_EQ(read("manoeuvre = \"random steer\"\nseed = 4").kind, ManoeuvreKind::kRandomSteer);
  EXPECT_EQ(read("manoeuvre = \"fishhook\"").kind, ManoeuvreKind::kFishhook);
  EXPECT_EQ(read("manoeuvre = \"steady-state circle\"\nrate = \"1 deg/s\"").rise_time, 2.0);
  const Manoeuvre circle =
      read("manoeuvre = \"steady-state circle\"\nmethod = \"constant radius\"\nradius = 40\nend_speed = \"60 kph\"");
  EXPECT_NEAR(circle.speed(120.0), 60.0 / 3.6, 1e-12);
  EXPECT_NEAR(circle.path->at(1.0).curvature, 1.0 / 40.0, 1e-15);
  const Manoeuvre lanes = read("manoeuvre = \"double lane change\"\nfront_overhang = 0.8");
  EXPECT_NEAR(lanes.body.ahead, 2.05, 1e-12);
  EXPECT_NEAR(lanes.course->vehicle_width, 1.75, 1e-12);
  const Manoeuvre avoiding = read("manoeuvre = \"obstacle avoidance\"\nrear_overhang = 0.9\nvehicle_width = 1.8");
  EXPECT_EQ(avoiding.course->standard, "ISO 3888-2");
  EXPECT_NEAR(avoiding.body.behind, 1.9, 1e-12);
  const Manoeuvre cones = read("manoeuvre = \"slalom\"\ncones = 5\nspacing = 22\nclearance = \"40 cm\"");
  EXPECT_EQ(cones.slalom->cones, 5);
  EXPECT_NEAR(cones.slalom->cone(4), 40.0 + 4.0 * 22.0, 1e-12);
  EXPECT_NEAR(cones.slalom->vehicle_width, 1.75, 1e-12);
  EXPECT_NEAR(steer(read("manoeuvre = \"ramp steer\"\nrate = \"2 deg/s\"\nhold = 1"), 2.0), 2.0 * kDegree, 1e-12);
  const Manoeuvre braking =
      read("manoeuvre = \"braking in a turn\"\nlongitudinal = true\nradius = -80\nbrake_time = 9");
  EXPECT_EQ(braking.brake_time, 9.0);
  EXPECT_NEAR(braking.driver->controls(10.0).brake_torque, 1100.0 * 4.0 * 0.3, 1e-9);
  EXPECT_NEAR(braking.path->at(1.0).curvature, -1.0 / 80.0, 1e-15);
  EXPECT_EQ(read("manoeuvre = \"follow path\"\nradius = 30\ndirection = \"right\"").path->at(0.0).curvature,
            -1.0 / 30.0);
  EXPECT_NEAR(steer(read("manoeuvre = \"signal\"\ntime = [0, 2]\nsteer = [0, \"4 deg\"]"), 1.0), 2.0 * kDegree, 1e-12);
}

TEST(Manoeuvre, AddsTorquesAndHoldsASpeedWhereTheModelHasThem) {
  const Manoeuvre braking =
      read("longitudinal = true\nmanoeuvre = \"step steer\"\nbrake_torque = [0, 800]\ntorque_time = [3, 4]");
  EXPECT_NEAR(braking.driver->controls(3.5).brake_torque, 400.0, 1e-9);
  EXPECT_GT(steer(braking, 3.5), 0.0);
  ManoeuvreContext context;
  context.wheel_radius = 0.3;
  const Manoeuvre held = read("longitudinal = true\ntarget_speed = \"108 kph\"", context);
  held.driver->look(0.0, {.u = 29.0});
  EXPECT_NEAR(held.driver->controls(0.0).drive_torque, 1100.0 * 0.3 * 1.0, 1e-9);  // 1 m/s too slow: 1 m/s^2
  EXPECT_NE(why([] { (void)read("target_speed = 30"); }).find("needs longitudinal = true"), std::string::npos);
  EXPECT_NE(
      why([] { (void)read("longitudinal = true\nbrake_torque = -5"); }).find("brake_torque is -5 N m; must be >= 0"),
      std::string::npos);
}

TEST(Manoeuvre, ReadsARecordedSignal) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "steer.csv";
  const std::string signal = "manoeuvre = \"signal\"\nfile = \"steer.csv\"";
  std::ofstream(file) << "time[s],steer[deg],brake_torque[N m]\n0,0,0\n1,2,100\n2,2,0\n";
  const Manoeuvre m = read(signal, {}, folder.path());
  EXPECT_NEAR(steer(m, 0.5), 1.0 * kDegree, 1e-12);
  EXPECT_NEAR(m.driver->controls(1.5).brake_torque, 50.0, 1e-12);
  EXPECT_EQ(m.default_duration, 2.0);
  std::ofstream(file) << "time[s],steer[m]\n0,0\n1,2\n";
  EXPECT_NE(why([&] { (void)read(signal, {}, folder.path()); }).find("column steer is in m"), std::string::npos);
}

TEST(Manoeuvre, RefusesWhatNobodyCanDriveWithThePlace) {
  EXPECT_EQ(why([] { (void)read("manoeuvre = \"step ster\""); }),
            "study.toml:2: drive.manoeuvre: no manoeuvre is called 'step ster' (did you mean 'step steer'?)");
  EXPECT_EQ(why([] { (void)read("manoeuvre = \"sine\"\namplitude = \"95 deg\""); }),
            "study.toml:3: drive.amplitude: = 95 deg must be between -90 and 90 deg");
  EXPECT_EQ(why([] { (void)read("manoeuvre = \"sweep\"\nlow = 2\nhigh = 1"); }),
            "study.toml:4: drive.high: high is 1 Hz; must be > low");
  ManoeuvreContext standing;
  standing.speed = 0.0;
  EXPECT_NE(why([&] { (void)read("manoeuvre = \"double lane change\"", standing); }).find("must be > 0"),
            std::string::npos);
  EXPECT_NE(why([] {
              (void)read("manoeuvre = \"signal\"\ntime = [0, 2, 1]\nsteer = [0, 0, 0]");
            }).find("sample 3 at 1 s is not after the one before"),
            std::string::npos);
  EXPECT_NE(
      why([] { (void)read("manoeuvre = \"braking in a turn\""); }).find("brakes, which needs longitudinal = true"),
      std::string::npos);
  EXPECT_EQ(why([] { (void)read("manoeuvre = \"slalom\"\ncones = 0"); }),
            "study.toml:3: drive.cones: = 0 must be from 1 to 1000");
  EXPECT_EQ(why([] { (void)read("manoeuvre = \"ramp steer\"\nhold = -1"); }),
            "study.toml:3: drive.hold: hold is -1 s; must be >= 0");
  EXPECT_NE(why([] { (void)read("manoeuvre = \"follow path\""); }).find("needs a file or the radius"),
            std::string::npos);
  EXPECT_NE(why([] {
              (void)read("manoeuvre = \"follow path\"\nradius = 30\npreview_time = 0.001");
            }).find("decision_interval"),
            std::string::npos);
  EXPECT_NE(why([] { (void)read("manoeuvre = \"sine\"\nfrequncy = 2"); }).find("did you mean 'frequency'"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
