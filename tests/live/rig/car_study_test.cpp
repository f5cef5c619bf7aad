#include "veridyn/live/rig/car_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/live/rig/car_links_in_memory.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

const std::string kHead =
    "[cue]\nalgorithms = ['classical']\n[platform]\nsubject = 'three_axis'\n"
    "[live]\ntelemetry = 'car'\nplatform = '127.0.0.1:47124'\n";

std::string car_refusal(const std::string& lines) {
  return why([&] { static_cast<void>(test::car_study(kHead + lines)); });
}

TEST(CarStudy, ReadsCarAndDriver) {
  const LiveStudy s = test::car_study(
      kHead +
      "stop = '127.0.0.1:47125'\n[live.car]\nline = '/dev/ttyUSB0'\nbaud = 115200\nsteering = '25 deg'\n"
      "force = '40 N'\nbrake = '2 N m'\nradius = '5 cm'\nsensor = ['1 cm', 0, '3 cm']\nflips = 0.01\n"
      "truth = '127.0.0.1:47126'\n[live.driver]\ntable = '/tmp/drive.csv'\nratio = 12\nreverse_share = 0.3\n");
  ASSERT_TRUE(s.car && s.driver);
  EXPECT_EQ(s.car->line, "/dev/ttyUSB0");
  EXPECT_EQ(s.car->baud, 115200);
  EXPECT_NEAR(s.car->range.steering, 25.0 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_EQ(s.car->brake, 2.0);
  EXPECT_EQ(s.car->radius, 0.05);
  EXPECT_EQ(s.options.sensor, Eigen::Vector3d(0.01, 0.0, 0.03));
  EXPECT_EQ(to_string(s.telemetry), "127.0.0.1:47125");
  EXPECT_EQ(s.driver->kind, DriverStudy::Kind::kTable);
  EXPECT_EQ(s.driver->command.range.drive_force, 40.0);
  EXPECT_EQ(s.driver->command.reverse_share, 0.3);
}

TEST(CarStudy, RefusesInOneLineWithItsPlace) {
  EXPECT_THAT(car_refusal(""), HasSubstr("live.driver: is missing: [live.driver] says who drives the car"));
  EXPECT_THAT(car_refusal("[live.driver]\n"), HasSubstr("names 0 of wheel, events and table; takes one"));
  EXPECT_THAT(car_refusal("[live.driver]\nwheel = '/dev/null'\n"), HasSubstr("live.driver.calibration: is missing"));
  EXPECT_THAT(car_refusal("[live.driver]\ntable = 'a.csv'\n[live.car]\nforce = '2000 N'\n"),
              HasSubstr("live.car.force: = 2000 N must be from 0.1 to 1600 N"));
  EXPECT_THAT(car_refusal("[live.driver]\ntable = 'a.csv'\n[live.car]\nbaud = 12\n"),
              HasSubstr("live.car.baud: = 12 must be from 1200"));
  EXPECT_THAT(car_refusal("[live.driver]\ntable = 'a.csv'\n[live.car]\nsensor = [1, 2]\n"),
              HasSubstr("has 2 numbers, needs 3"));
  EXPECT_THAT(car_refusal("[live.driver]\ntable = 'a.csv'\n[live.car]\nlien = '/tmp/x'\n"),
              HasSubstr("did you mean 'line'"));
}

TEST(CarStudy, RecordingHoldsTheCalibrationItself) {
  const veridyn::test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "wheel.toml";
  write_file(file, source_calibration().to_toml());
  const Study study =
      Study::parse(kHead + "[live.driver]\nwheel = '/dev/null'\ncalibration = '" + file.string() + "'\n", "rig.toml");
  const LiveStudy by_file = read_live_study(study);
  EXPECT_TRUE(by_file.driver->calibration_by_file);
  const LiveStudy again = test::car_study(with_calibration(study, *by_file.driver).to_toml());
  EXPECT_FALSE(again.driver->calibration_by_file);
  EXPECT_EQ(again.driver->calibration.to_toml(), by_file.driver->calibration.to_toml());
}

}  // namespace
}  // namespace veridyn::live
