#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

#include "veridyn/live/teleoperation/car_command.hpp"

namespace veridyn::live {

/// What the car's sensors say at one moment, frame flu. What is sent lies on the steps given; the range of each
/// quantity is what its sixteen bits hold. A number that is not finite or does not fit is sent as "none" and received
/// as NaN: a broken sensor shall neither end the link nor look like a measurement.
struct CarSensors {
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< accelerometers, gravity in [m/s^2]: 0.005, +-163
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();          ///< gyros [rad/s]: 0.001, +-32.7
  double steering = 0.0;                                   ///< measured road-wheel angle [rad]: 1e-4, +-3.27
  std::array<double, 4> wheel_speeds = {};  ///< front left, front right, rear left, rear right [rad/s]: 0.02, +-655
  double battery = 0.0;                     ///< [V]: 0.001, 0 to 65.534
};

/// The first quantity that is not finite or does not fit: "acceleration", "rate", "steering", "wheel_speeds",
/// "battery"; empty where all are well.
[[nodiscard]] std::string_view what_is_wrong(const CarSensors& sensors);

/// What the car does with the commands.
enum class CarState : std::uint8_t {
  kHolding,  ///< stands, brakes on: at the start and after braking; drives after a neutral command
  kDriving,  ///< executes commands
  kBraking,  ///< has lost the link and brakes by itself
};
inline constexpr std::size_t kCarStates = 3;

/// Payload of a report, 37 bytes: time u32 [us] | acceleration 3 i16 | rate 3 i16 | steering i16 | wheel speeds 4 i16 |
/// battery u16 [mV] | commands received u16 | state u8 | echo: run u16, sequence u16, age u16.
inline constexpr std::size_t kReportPayload = 37;
struct ReportPayload {
  CarSensors sensors;
  std::uint32_t time_us = 0;   ///< of the car's clock when the report was made [us], modulo 2^32
  std::uint16_t received = 0;  ///< different commands received since this run of the operator was adopted, modulo 2^16
  CarState state = CarState::kHolding;
  std::optional<Echo> echo;  ///< of the newest command received
};

/// @param out of `kReportPayload` bytes
void encode_report(const ReportPayload& payload, std::span<std::uint8_t> out);
/// Nothing where the size is not that of a report, or the state is none.
[[nodiscard]] std::optional<ReportPayload> decode_report(Bytes payload);

}  // namespace veridyn::live
