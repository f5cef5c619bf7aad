#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/live/driver/wheel_event.hpp"

namespace veridyn::live {

/// What the driver does.
struct DriverInput {
  double steering = 0.0;  ///< angle of the steering wheel [rad], to the left positive
  double throttle = 0.0;  ///< 0 released to 1 down
  double brake = 0.0;     ///< 0 released to 1 down
  double clutch = 0.0;    ///< 0 released to 1 down
  bool reverse = false;

  bool operator==(const DriverInput&) const = default;
};

/// Steering: straight lines from the centre to either lock.
struct SteeringCalibration {
  std::uint16_t axis = kAxisX;
  std::int32_t left = 0, centre = 32768, right = 65535;  ///< numbers of the axis; left may be the largest
  double lock = 7.854;                                   ///< from the centre to either lock [rad]; 450 deg
  double deadband = 0.005;  ///< around the centre, share of the way to the lock; beyond it the angle begins at zero
};

/// A pedal: a straight line, with a deadband at either end.
struct PedalCalibration {
  std::uint16_t axis = 0;
  std::int32_t released = 0, pressed = 255;  ///< numbers of the axis; pressed may be the smaller
  double deadband = 0.02;                    ///< at each end, share of the way
};

/// A gear selector that is an axis: the nearer of two numbers.
struct GearCalibration {
  std::uint16_t axis = 0;
  std::int32_t forward = 0, reverse = 128;
};

/// From the numbers of a wheel's axes to what the driver does: a file of `keys`, or `[live.driver.calibration]`.
struct WheelCalibration {
  SteeringCalibration steering;
  PedalCalibration throttle, brake;
  std::optional<PedalCalibration> clutch;
  std::optional<GearCalibration> gear;

  /// Nothing before every axis of the calibration was heard of. Values beyond the calibrated ones count as their ends.
  /// Does not allocate or throw.
  [[nodiscard]] std::optional<DriverInput> input(const WheelAxes& axes) const;
  /// Centred, released, forward: where a recording that holds only changes may begin.
  [[nodiscard]] std::vector<WheelAxis> at_rest() const;

  /// @throws InputError with file, line and key: an unknown axis, a centre that is not between the locks, a pedal that
  /// does not move, pedals whose ranges overlap
  [[nodiscard]] static WheelCalibration load(const std::filesystem::path& file);
  /// Throws as `load` where it is read.
  [[nodiscard]] static const KeyTable<WheelCalibration>& keys();
  [[nodiscard]] std::string to_toml() const;

  /// What cannot be, and at which key ("steering.centre").
  struct Problem {
    std::string table, key, text;
  };
  [[nodiscard]] std::optional<Problem> problem() const;
};

/// The rig of the reproduced experiments: steering 0 to 65535, pedals 0 to 150, gear 0 or 128, on the axes ABS_X,
/// ABS_GAS, ABS_BRAKE and ABS_MISC. Its source says neither which end is left nor which gear is reverse: left is 0 and
/// reverse 128 here, pedals are 0 when released.
[[nodiscard]] WheelCalibration source_calibration();

}  // namespace veridyn::live
