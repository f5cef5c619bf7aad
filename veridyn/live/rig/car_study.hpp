#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/live/driver/driver_command.hpp"
#include "veridyn/live/link/datagram.hpp"
#include "veridyn/live/virtual/virtual_car.hpp"

namespace veridyn::live {

/// A scaled car at the end of a serial line, from `[live.car]`:
///
///     line = "/tmp/car"         # the serial device; for `veridyn rig car`, what its pseudo-terminal is called
///     baud = 250000
///     steering = "0.6 rad"      # largest angle of the road wheels
///     force = "100 N"           # largest drive force, of all wheels together
///     brake = "3 N m"           # torque of the brake fully on, of all wheels together
///     radius = "6 cm"           # of the wheels: from their speed to the car's
///     sensor = [0, 0, 0]        # of the inertial sensors from the centre of gravity, forward, left, up [m]
///     report_rate = "100 Hz"    # 20 to 400 Hz
///     flips = 0.01              # of the virtual car: share of the line's bytes that arrive as other ones
///     truth = "127.0.0.1:4130"  # of the virtual car: where its true motion is sent, packets `veridyn`
struct CarStudy {
  std::filesystem::path line = "/tmp/car";
  int baud = 250'000;
  CommandRange range;
  double brake = 3.0;    ///< [N m]
  double radius = 0.06;  ///< [m]
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();
  double report_rate = 100.0;  ///< [Hz]
  double flips = 0.0;
  std::optional<Sender> truth;
};

/// Who drives it, from `[live.driver]`:
///
///     wheel = "/dev/input/by-id/...-event-joystick"   # one of these three
///     events = "drive.events"         # recorded of such a device
///     table = "drive.csv"             # see read_driver_table
///     calibration = "wheel.toml"      # of `veridyn rig wheel`; or its tables, [live.driver.calibration.steering] ...
///     ratio = 13.1                    # angle of the steering wheel by that of the road wheels
///     reverse_share = 0.5             # of the drive force, backward
struct DriverStudy {
  enum class Kind { kWheel, kEvents, kTable };
  Kind kind = Kind::kTable;
  std::filesystem::path file;
  WheelCalibration calibration;
  DriverCommandOptions command;  ///< its range is the car's
  bool calibration_by_file = false;
};

/// @param live the table that holds `[live.car]` @throws InputError with file, line and key
[[nodiscard]] CarStudy read_car(const StudyTable& live);
/// @param range of the car @throws InputError with file, line and key
[[nodiscard]] DriverStudy read_driver(const StudyTable& live, const CommandRange& range);

/// What the virtual car takes of it.
[[nodiscard]] VirtualCarOptions virtual_car_options(const CarStudy& car, std::uint64_t seed);

/// The same study with the calibration's numbers in place of the name of its file, so that a recording holds all that
/// its replay needs.
[[nodiscard]] Study with_calibration(const Study& study, const DriverStudy& driver);

}  // namespace veridyn::live
