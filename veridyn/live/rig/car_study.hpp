#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/live/driver/driver_command.hpp"
#include "veridyn/live/link/datagram.hpp"
#include "veridyn/live/virtual/virtual_car.hpp"

namespace veridyn::live {

/// A scaled car at the end of a serial line, from `[live.car]`.
struct CarStudy {
  std::filesystem::path line = "/tmp/car";
  int baud = 250'000;
  CommandRange range;
  double brake = 3.0;    ///< [N m]
  double radius = 0.06;  ///< [m]
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();
  double report_rate = 100.0;  ///< [Hz]
  double flips = 0.0;
  std::optional<Sender> truth;  ///< where the virtual car's motion is sent

  [[nodiscard]] static const KeyTable<CarStudy>& keys();
};

/// Who drives it, from `[live.driver]`.
struct DriverStudy {
  enum class Kind { kWheel, kEvents, kTable };
  Kind kind = Kind::kTable;
  std::filesystem::path file;
  WheelCalibration calibration;
  DriverCommandOptions command;  ///< its range is the car's
  bool calibration_by_file = false;

  [[nodiscard]] static const KeyTable<DriverStudy>& keys();
};

/// @param range of the car @throws InputError with file, line and key
[[nodiscard]] DriverStudy read_driver(const StudyTable& live, const CommandRange& range);

/// What the virtual car takes of it.
[[nodiscard]] VirtualCarOptions virtual_car_options(const CarStudy& car, std::uint64_t seed);

/// The same study with the calibration's numbers in place of the name of its file, so that a recording holds all that
/// its replay needs.
[[nodiscard]] Study with_calibration(const Study& study, const DriverStudy& driver);

}  // namespace veridyn::live
